"""The workflow as a module of another one, as in docs/elsewhere.md, and from another folder."""

import re
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/elsewhere.md").read_text(encoding="utf-8")
SMOKE = yaml.safe_load((ROOT / "config/smoke.yaml").read_text(encoding="utf-8"))

pytestmark = pytest.mark.slow


def block(language):
    """The first block of the page in a language."""
    return re.search(rf"```{language}\n(.*?)```", PAGE, flags=re.DOTALL)[1]


@pytest.fixture
def importer(in_folder, tmp_path):
    """Project that imports the workflow twice, with the sizes of the smoke run."""
    small = {key: value for key, value in SMOKE.items() if key != "folders"}
    given = yaml.safe_load(block("yaml"))
    given["viscous"]["evaluation"] |= small["evaluation"]
    (tmp_path / "fprc").symlink_to(ROOT)
    (tmp_path / "Snakefile").write_text(block("python"), encoding="utf-8")
    settings = {name: small | own for name, own in given.items()}
    (tmp_path / "rigs.yaml").write_text(yaml.safe_dump(settings), encoding="utf-8")
    return in_folder(tmp_path)


def test_each_module_makes_the_bytes_of_the_clone_below_its_prefix(importer, smoked):
    done = importer.snakemake("paper_fig4", "viscous_logs", "paper_fig1")
    assert done.returncode == 0, done.stdout
    made = importer.files("paper", "viscous")
    assert {name.split("/")[0] for name in made} == {"paper", "viscous"}
    assert not importer.files("results", "data")
    sweep = (smoked.folder / "results/smoke/raw/sweep.h5").read_bytes()
    assert made["paper/data/raw/sweep.h5"] == sweep
    assert made["viscous/data/raw/sweep.h5"] != sweep
    assert "Nothing to be done" in importer.snakemake("paper_fig4", "viscous_logs").stdout
    for asked in ("both", "paper_all"):
        planned = importer.snakemake("--dry-run", asked)
        assert planned.returncode == 0, planned.stdout
        assert re.findall(r"^    output: (?!paper/|viscous/)", planned.stdout, re.MULTILINE) == []
    wrong = importer.snakemake("--dry-run", "--config", "paper={sed: 3}")
    assert wrong.returncode == 1
    assert "sed: unknown key; did you mean seed?" in wrong.stdout


def test_moving_the_workflow_reruns_nothing(smoked_copy, in_folder, tmp_path):
    for name in ("config", "profiles", "Snakefile", "workflow"):
        (smoked_copy.folder / name).rename(tmp_path / name)
    asked = ["--snakefile", "Snakefile", "--directory", smoked_copy.folder.name]
    done = in_folder(tmp_path).snakemake(*asked, "--workflow-profile", "smoke", "report")
    assert done.returncode == 0, done.stdout
    assert re.findall(r"^Finished jobid: \d+ \(Rule: (\w+)\)", done.stdout, re.MULTILINE) == []
    assert not (tmp_path / "results").exists()


def test_folder_without_a_configuration_takes_the_defaults(in_folder, tmp_path):
    (tmp_path / "mine/docs/images").mkdir(parents=True)  # which makes it no checkout
    studies = str(ROOT / "workflow/studies/Snakefile")
    asked = ["--snakefile", studies, "--directory", "mine", "check", "families"]
    jobs = in_folder(tmp_path).planned(*asked)
    assert jobs["replicate"] == 10
    assert "tabulate_times" not in jobs  # of README.md, which only a checkout has
