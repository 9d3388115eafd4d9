"""What the build of the paper, and the studies of a smoke run, have made."""

import json
import re
import shutil
from collections import Counter
from pathlib import Path

import pandas as pd
import pytest

from fprc.given import read_yaml

ROOT = Path(__file__).parents[2]
STUDIES = ("--snakefile", "workflow/studies/Snakefile")
#: Files below the results by folder and ending.
MADE = {
    **{("tables", kind): 7 for kind in (".csv", ".md", ".tex")},
    **{("figures", kind): 17 for kind in (".pdf", ".png")},
    ("timing", ".csv"): 1,
    ("results", ".html"): 1,
    ("results", ".csv"): 1,
}

pytestmark = pytest.mark.slow


def test_paper_makes_whole_files_of_every_promised_output_and_says_where_the_report_is(paper):
    project, printed = paper
    made = project.files("results", "data")
    small = {name for name, content in made.items() if len(content) <= 50}
    assert {name for name in small if "/logs/" not in name} == set()
    assert not [name for name in made if ".part" in name]
    counts = Counter((Path(name).parent.name, Path(name).suffix) for name in made)
    assert {kind: counts[kind] for kind in MADE} == MADE
    assert "Job 0: Target all: open results/report.html" in printed
    assert len(re.findall("Finished jobid", printed)) == 26


def test_verdicts_are_as_declared_and_the_numbers_of_the_readme_as_built(paper, tmp_path):
    copy = paper[0].copy(tmp_path / "copy")
    shutil.copy(ROOT / "README.md", copy.folder)
    done = copy.snakemake(*STUDIES, "check")
    assert done.returncode == 0, done.stdout
    assert len(re.findall("Finished jobid", done.stdout)) == 1


def test_smoke_writes_below_results_smoke_and_nowhere_else(smoked):
    files = smoked.files("results", "data")
    assert files
    assert all(name.startswith("results/smoke/") for name in files)


def test_every_rule_is_run(paper, studied):
    files = [*(ROOT / "workflow").rglob("*.smk"), ROOT / "workflow/studies/Snakefile"]
    texts = "".join(path.read_text(encoding="utf-8") for path in files)
    every = set(re.findall(r"^ *(?:use rule \w+ as|rule) (\w+)", texts, flags=re.MULTILINE))
    run = set(re.findall(r"Finished jobid: \d+ \(Rule: (\w+)\)", paper[1] + studied[1]))
    # these look at results, or are of recorded logs and of the real rig
    by_hand = {"check", "readme", "beyond_page", "drift_page", "grid", "record_on_rig", "studies"}
    assert every - run == by_hand


def test_profiles_name_rules_that_there_are_and_repeat_the_default(project):
    profile, default, smoke = (
        read_yaml(project.folder / f"profiles/{name}/config.yaml")
        for name in ("slurm", "default", "smoke")
    )
    rules = project.rules(*STUDIES)
    groups = dict(group.split("=") for group in profile["groups"])
    assert profile["set-resources"].keys() | groups.keys() <= rules
    assert {rule for rule in rules if rule.startswith("draw_")} <= groups.keys()
    # which the rules obey, also in a job on a node with more cores
    assert profile["max-threads"] == profile["cores"] == 8
    configuration = project.folder / "profiles/smoke" / smoke.pop("configfile")
    assert configuration.samefile(project.folder / "config/smoke.yaml")
    assert smoke == default


def test_claims_are_counted_on_the_ensemble(studied):
    folder = studied[0].folder / "results/smoke/families"
    members = json.loads((folder / "members.json").read_text(encoding="utf-8"))
    assert members["of"] == 2
    assert {"C1a", "C13a"} <= members["holds"].keys()


def test_families_beyond_the_paper_have_every_model_and_a_verdict_on_each_claim(studied):
    folder = studied[0].folder / "results/smoke/beyond"
    claims = pd.read_csv(folder / "claims.csv")
    families = ["paper", "bouc_wen", "dry", "viscous", "ensemble"]
    ids = claims.groupby("family", sort=False)["id"].unique().map(list).to_dict()
    every = ["W1", "W2", "W3", "W4", "B1", "B4", "B7", "B8"]
    assert ids == dict.fromkeys(families, every)
    # two seeds decide nothing
    assert set(claims["verdict"]) <= {"undecided", "not judged"}
    models = pd.read_csv(folder / "models.csv").dropna(axis="columns", how="all")
    forward = models[models["measure"] == "forward"]
    assert forward.groupby("family")["model"].nunique().to_dict() == {
        "paper": 19, "bouc_wen": 14, "dry": 14, "viscous": 14, "ensemble": 14,
    }  # fmt: skip
    assert (forward["units"] == 2).sum() == len(forward) - 3  # the slow models have one seed
