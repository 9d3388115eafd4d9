"""Targets plan what they need, and an edit or a setting reruns what runs or reads it."""

import re
import shutil
from pathlib import Path

import pytest

import fprc

STUDIES = ("--snakefile", "workflow/studies/Snakefile")
FIG8 = {"record": 1, "preprocess": 1, "judge": 1, "draw_training": 1}

#: Targets, the jobs that they need, and jobs that they must do without.
PLANNED = [
    (["table1", "fig1"], {"draw_without_data"}, {"record"}),
    (["table2", "table3"], {"tabulate_models", "judge"}, {"measure_times", "replicate"}),
    (["timing", "fig4", "fig9"], {"tabulate_times", "draw_experiments"}, {"judge", "track"}),
    (["seeds", "fig10"], {"show_seeds", "replicate", "measure_times"}, {"grid", "judge", "track"}),
    (["table4", "fig12", "fig17"], {"track", "draw_loops"}, {"grid", "replicate"}),
    (["report"], {"report_page", "show_seeds"}, {"judge_family"}),
    ([*STUDIES, "families"], {"judge_family", "count_members"}, {"judge", "replicate"}),
    ([*STUDIES, "readme"], {"readme", "tabulate_times", "show_seeds"}, {"judge_family"}),
]  # fmt: skip


def test_fig_8_trains_fprc_alone(project):
    assert project.planned("fig8") == FIG8 | {"fig8": 1}


def test_target_that_is_mistyped_is_answered_by_the_nearest(project):
    done = project.snakemake("--dry-run", "fgi8", "all")
    assert done.returncode != 0
    assert re.findall("(\\w+): did you mean (\\w+)", done.stdout) == [("fgi8", "fig8")]


@pytest.mark.parametrize(("targets", "needs", "spares"), PLANNED)
def test_targets_plan_what_they_need_and_no_more(project, targets, needs, spares):
    jobs = project.planned(*targets)
    assert needs <= jobs.keys()
    assert not spares & jobs.keys()


def jobs(*rules, **counts):
    """Return the number of jobs by rule, one where none is given."""
    return dict.fromkeys(rules, 1) | counts


REPORT = jobs("report_page")
#: What shows further seeds, which are one job each.
SEEDS = REPORT | jobs("show_seeds", replicate=10)
#: What one model changes.
ESN = SEEDS | jobs("judge", "measure_times", "tabulate_models", "tabulate_times")
#: Closed loops and what is made of them.
LOOPS = jobs("track", "draw_loops")
#: What every model changes: all but the experiments and what is made of their logs alone.
MODELS = ESN | LOOPS | jobs("draw_training", "draw_experiments", judge=3)
RIG = MODELS | jobs("record", "preprocess")
SHOWN = {rule for rule in RIG if rule.startswith(("tabulate", "draw", "show"))} | {
    "report_page", "draw_without_data",
}  # fmt: skip

#: Edits that rerun the same jobs are made together: file, old text, new text.
EDITS = {
    "code that no rule runs": ([("cli.py", "import sys", "import sys\n\nUNUSED = 1")], {}),
    "ESN": ([("models/esn.py", "\n\n\n@", "\n\nEDITED = 1\n\n\n@")], ESN),
    "what computes": ([("rig/mechanics.py", "return force", "return 1.0 * force")], RIG),
    "what shows": ([("figures/hysteresis.py", "style.COLUMN_IN, 2.4", "style.COLUMN_IN, 2.5")],
                   jobs(*SHOWN)),
}  # fmt: skip


def rerun(paper, *arguments, **environment):
    """Jobs of the paper that would run again, by rule."""
    planned = paper[0].planned("--nolock", *arguments, "--", "all", **environment)
    return {rule: count for rule, count in planned.items() if rule != "all"}


@pytest.mark.slow
@pytest.mark.parametrize("what", EDITS)
def test_edit_reruns_what_runs_that_code_and_nothing_else(paper, tmp_path, what):
    edits, expected = EDITS[what]
    shutil.copytree(Path(fprc.__file__).parent, tmp_path / "fprc")
    for name, old, new in edits:
        path = tmp_path / "fprc" / name
        text = path.read_text(encoding="utf-8")
        assert old in text
        path.write_text(text.replace(old, new, 1), encoding="utf-8")
    assert rerun(paper, PYTHONPATH=str(tmp_path)) == expected


#: Settings on the command line, and the jobs that must run again; the report shows all settings.
CHANGES = {
    "nothing": ("seed=1", {}),
    "gains of the feedback": ("control={pd: {kp_kpa_per_deg: 0.6}}", SEEDS | LOOPS),
    "one reference": ("tracking={references: {sine_0p2: {duration_s: 9}}}", SEEDS | LOOPS),
}


@pytest.mark.slow
@pytest.mark.parametrize("what", CHANGES)
def test_setting_reruns_what_reads_it_and_nothing_else(paper, what):
    change, expected = CHANGES[what]
    assert rerun(paper, "--config", change) == expected
