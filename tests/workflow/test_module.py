"""The workflow as a module of another one, as in docs/elsewhere.md, and from another folder."""

import re
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[2]
STUDIES = str(ROOT / "workflow/studies/Snakefile")
PAGE = (ROOT / "docs/elsewhere.md").read_text(encoding="utf-8")
SMOKE = yaml.safe_load((ROOT / "config/smoke.yaml").read_text(encoding="utf-8"))

pytestmark = pytest.mark.slow


def block(language):
    """The first block of the page in a language."""
    return re.search(rf"```{language}\n(.*?)```", PAGE, flags=re.DOTALL)[1]


@pytest.fixture(scope="module")
def importer(in_folder, tmp_path_factory):
    """Project that imports the workflow twice, with the sizes of the smoke run."""
    project = in_folder(tmp_path_factory.mktemp("importer"))
    small = {key: value for key, value in SMOKE.items() if key != "folders"}
    given = yaml.safe_load(block("yaml"))
    given["viscous"]["evaluation"] |= small["evaluation"]
    (project.folder / "fprc").symlink_to(ROOT)
    (project.folder / "Snakefile").write_text(block("python"), encoding="utf-8")
    settings = {name: small | own for name, own in given.items()}
    (project.folder / "rigs.yaml").write_text(yaml.safe_dump(settings), encoding="utf-8")
    return project


@pytest.fixture(scope="module")
def imported(importer):
    """The same with both tables and a figure."""
    done = importer.snakemake("both", "paper_fig1")
    assert done.returncode == 0, done.stdout
    return importer.folder


def test_each_module_writes_below_its_prefix(imported):
    names = {path.name for path in imported.iterdir()} - {".snakemake", "printed.txt"}
    assert names == {"Snakefile", "rigs.yaml", "fprc", "paper", "viscous"}
    for module in ("paper", "viscous"):
        assert {path.name for path in (imported / module).iterdir()} == {"data", "results"}
        logs = (imported / module / "data/raw").iterdir()
        assert {path.name for path in logs} == {"sweep.h5", "complex.h5"}


def test_module_makes_the_bytes_of_the_clone(imported, smoked):
    clone = smoked.folder / "results/smoke/tables/table2"
    table = imported / "paper/results/tables/table2"
    for suffix in (".csv", ".md"):
        assert table.with_suffix(suffix).read_bytes() == clone.with_suffix(suffix).read_bytes()
    other = imported / "viscous/results/tables/table2.csv"
    assert other.read_bytes() != table.with_suffix(".csv").read_bytes()


def test_nothing_reruns_and_all_of_a_module_can_be_planned(imported, importer):
    assert "Nothing to be done" in importer.snakemake("both", "paper_fig1").stdout
    planned = importer.snakemake("--dry-run", "paper_all")
    assert planned.returncode == 0, planned.stdout
    outside = re.findall(r"^    output: (?!paper/)", planned.stdout, re.MULTILINE)
    assert outside == []


def test_mistake_in_the_settings_of_a_module_is_told_by_its_key(importer):
    done = importer.snakemake("--dry-run", "--config", "paper={sed: 3}")
    assert done.returncode == 1
    assert "sed: unknown key; did you mean seed?" in done.stdout


def test_report_is_made_from_another_folder(smoked_copy, in_folder, tmp_path):
    for name in ("config", "profiles", "Snakefile", "workflow"):
        (smoked_copy.folder / name).rename(tmp_path / name)
    asked = ["--snakefile", "Snakefile", "--directory", smoked_copy.folder.name]
    done = in_folder(tmp_path).snakemake(*asked, "--workflow-profile", "smoke", "report")
    assert done.returncode == 0, done.stdout
    # the template and the captions are in another place
    jobs = re.findall(r"^Finished jobid: \d+ \(Rule: (\w+)\)", done.stdout, re.MULTILINE)
    assert jobs == ["report_page", "report"]
    page = "results/smoke/report.html"
    assert "Fig. 17" in (smoked_copy.folder / page).read_text(encoding="utf-8")
    assert not (tmp_path / "results").exists()


def test_folder_without_a_configuration_takes_the_defaults(in_folder, tmp_path):
    (tmp_path / "mine/docs/images").mkdir(parents=True)  # which makes it no checkout
    asked = ["--snakefile", STUDIES, "--directory", "mine", "check", "families"]
    jobs = in_folder(tmp_path).planned(*asked)
    assert (jobs["replicate"], jobs["judge_family"]) == (10, 1)
    assert "tabulate_times" not in jobs  # of README.md, which only a checkout has
