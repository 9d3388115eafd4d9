import re
import sys

import pytest

from fprc.yaml_file import read_yaml

STUDIES = ("--snakefile", "workflow/studies/Snakefile")


def test_profile_of_slurm_names_rules_that_there_are_and_groups_every_drawing(project):
    rules = set(project.snakemake("--list-rules", *STUDIES).stdout.split())
    profile = read_yaml(project.folder / "profiles/slurm/config.yaml")
    groups = dict(group.split("=") for group in profile["groups"])
    assert profile["set-resources"].keys() | groups.keys() <= rules
    assert {rule for rule in rules if rule.startswith("draw_")} <= groups.keys()
    # which the rules obey, also in a job on a node with more cores
    assert profile["max-threads"] == profile["cores"] == 8


def test_studies_are_no_rules_of_the_paper(project):
    paper, every = (
        set(project.snakemake("--list-rules", *which).stdout.split()) for which in ((), STUDIES)
    )
    assert paper < every
    assert {"studies", "families", "check", "drift_page"} <= every - paper
    assert len(every - paper) > 10


def test_profile_of_the_smoke_run_is_the_default_one_with_a_configuration(project):
    profiles = project.folder / "profiles"
    smoke = read_yaml(profiles / "smoke/config.yaml")
    configuration = profiles / "smoke" / smoke.pop("configfile")
    assert configuration.samefile(project.folder / "config/smoke.yaml")
    assert smoke == read_yaml(profiles / "default/config.yaml")


FIG8 = {"record": 2, "preprocess": 2, "judge": 1, "draw_training": 1}

#: Targets, the jobs that they need, and jobs that they must do without.
PLANNED = [
    (["table1", "fig1"], {"draw_without_data"}, {"record"}),
    (["table2", "table3"], {"tabulate_models", "judge"}, {"measure_times", "replicate"}),
    (["seeds"], {"tabulate_seeds", "replicate"}, {"judge", "record"}),
    (["timing", "fig4", "fig9", "fig11"], {"tabulate_times", "draw_hysteresis", "draw_weights",
     "draw_grids"}, {"judge", "track"}),
    (["fig10"], {"draw_grids", "replicate", "measure_times"}, {"grid", "track"}),
    (["table4", "fig12", "fig17"], {"track", "draw_loops"}, {"grid", "replicate"}),
    (["report"], {"report_page", "ledger", "draw_grids"}, {"judge_family"}),
    ([*STUDIES, "families"], {"judge_family", "tabulate_families", "replicate"}, {"judge"}),
    ([*STUDIES, "readme"], {"readme", "tabulate_times", "ledger"}, {"judge_family"}),
]  # fmt: skip


def test_fig_8_trains_fprc_alone(project):
    assert project.planned("fig8") == FIG8 | {"fig8": 1}


@pytest.mark.parametrize(("targets", "needs", "spares"), PLANNED)
def test_targets_plan_what_they_need_and_no_more(project, targets, needs, spares):
    jobs = project.planned(*targets)
    assert needs <= jobs.keys()
    assert not spares & jobs.keys()


@pytest.mark.slow
def test_run_says_what_it_does_and_how_much_is_done(project):
    snakemake = [sys.executable, "-m", "snakemake", "--cores", "1"]
    done = project.run(*snakemake, "table1")
    assert done.returncode == 0, done.stdout
    assert re.search(r"^Job 1: Table I, and ", done.stdout, re.MULTILINE)
    assert re.search(r"^1 of 2 steps \(50%\) done$", done.stdout, re.MULTILINE)
    assert re.search(r"^Job 0: Target table1$", done.stdout, re.MULTILINE)
    assert "Reason:" not in done.stdout
    # what a job says of its progress is in its log
    assert "[draw_without_data]" not in done.stdout
