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
    assert len(every - paper) > 20


def test_profile_of_the_smoke_run_is_the_default_one_with_a_configuration(project):
    profiles = project.folder / "profiles"
    smoke = read_yaml(profiles / "smoke/config.yaml")
    configuration = profiles / "smoke" / smoke.pop("configfile")
    assert configuration.samefile(project.folder / "config/smoke.yaml")
    assert smoke == read_yaml(profiles / "default/config.yaml")


#: Targets that spare the same jobs are planned together.
PLANNED = [
    (
        ["table1", "fig1", "fig2", "fig3", "fig6", "fig7"],
        {"configuration_table", *(f"draw_fig{number}" for number in (1, 2, 3, 6, 7))},
        {"record"},
    ),
    (["table2", "table3"], {"comparison_table", "judge"}, {"measure_times", "replicate"}),
    (["seeds"], {"seeds_table", "replicate"}, {"judge", "record"}),
    (
        ["timing", "fig4", "fig5", "fig9", "fig11"],
        {"timing_table", "draw_fig4", "draw_fig5", "draw_fig9", "draw_fig11"} | {"weigh"},
        {"judge", "track"},
    ),
    (["fig10"], {"draw_fig10", "replicate", "measure_times"}, {"grid", "track"}),
    (
        ["table4", *(f"fig{number}" for number in range(12, 18))],
        {"track", "tracking_table", *(f"draw_fig{number}" for number in range(12, 18))},
        {"grid", "replicate"},
    ),
    (["report"], {"report_page", "ledger", "draw_fig11"}, {"judge_family"}),
    (
        [*STUDIES, "families"],
        {"judge_family", "families_tables", "replicate"},
        {"judge"},
    ),
    ([*STUDIES, "readme"], {"readme", "timing_table", "ledger"}, {"judge_family"}),
]


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
    assert re.search(r"^Job 1: Table tables/table1$", done.stdout, re.MULTILINE)
    assert re.search(r"^1 of 2 steps \(50%\) done$", done.stdout, re.MULTILINE)
    assert re.search(r"^Job 0: Target table1$", done.stdout, re.MULTILINE)
    assert "Reason:" not in done.stdout
    # what a job says of its progress is in its log
    assert "[configuration_table]" not in done.stdout
