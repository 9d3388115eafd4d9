"""After an edit only the rules that run the edited code, and those after them, run again."""

import shutil
from inspect import signature
from pathlib import Path

import pytest

import fprc
from fprc.stages.run import _NOT_ARGUMENTS, stage_of

pytestmark = pytest.mark.slow


def jobs(*rules, **counts):
    """Return the number of jobs by rule, one where none is given."""
    return dict.fromkeys(rules, 1) | counts


REPORT = jobs("report_page")
#: What shows further seeds, which are one job each.
SEEDS = REPORT | jobs("tabulate_seeds", "draw_grids", "ledger", replicate=2)
#: What one model changes.
ESN = SEEDS | jobs("judge", "measure_times", "tabulate_models", "tabulate_times")
#: Closed loops and what is made of them.
LOOPS = jobs("track", "draw_loops")
#: What every model changes: all but the experiments and what is made of their logs alone.
MODELS = ESN | LOOPS | jobs("draw_training", "draw_weights", judge=3)
RIG = MODELS | jobs("draw_hysteresis", record=2, preprocess=2)
SHOWN = {rule for rule in RIG if rule.startswith(("tabulate", "draw"))} | {
    "ledger", "report_page", "draw_without_data",
}  # fmt: skip

#: Edits that rerun the same jobs are made together: file, old text, new text.
NOTHING = [
    ("models/features.py", "\n\n\ndef ", "\n\n\n# a comment\ndef "),
    ("models/esn.py", '"""Echo state network feedforward model."""', '"""The net."""'),
    ("cli.py", "import sys", "import sys\n\nUNUSED = 1"),
]
EDITS = {
    "comment, docstring, code that no rule runs": (NOTHING, {}),
    "ESN": ([("models/esn.py", "_part(RidgeReadout)", "_part(RidgeReadout, **{})")], ESN),
    "FPRC": (
        [("models/fprc.py", "\n\n\n@", "\n\nEDITED = 1\n\n\n@")],
        MODELS | jobs(judge=2),
    ),
    "what computes": ([("rig/friction.py", "return force", "return 1.0 * force")], RIG),
    "what shows": ([("figures/hysteresis.py", "style.COLUMN_IN, 2.4", "style.COLUMN_IN, 2.5")],
                   jobs(*SHOWN)),
}  # fmt: skip


def rerun(project, *arguments, **environment):
    """Jobs of the smoke run that would run again, by rule."""
    planned = project.planned("all", "--configfile", "config/smoke.yaml", *arguments, **environment)
    return {rule: count for rule, count in planned.items() if rule != "all"}


@pytest.mark.parametrize("what", EDITS)
def test_edit_reruns_what_runs_that_code_and_nothing_else(smoked, tmp_path, what):
    edits, expected = EDITS[what]
    shutil.copytree(Path(fprc.__file__).parent, tmp_path / "fprc")
    for name, old, new in edits:
        path = tmp_path / "fprc" / name
        text = path.read_text(encoding="utf-8")
        assert old in text
        path.write_text(text.replace(old, new, 1), encoding="utf-8")
    # the copy's published.yaml lies elsewhere, which counts as another input
    triggers = ("--rerun-triggers", "code", "mtime", "params", "software-env")
    assert rerun(smoked[0], *triggers, PYTHONPATH=str(tmp_path)) == expected


def test_every_rule_gives_its_stage_what_it_takes_and_carries_the_digest_of_its_code(project):
    stages = project.stages()
    assert len(stages) > 30
    for stage, named in stages.values():
        assert not named.isdisjoint({"code", "version"}), stage
        signature(stage_of(stage)).bind(**dict.fromkeys(named.difference(_NOT_ARGUMENTS)))


#: Settings on the command line, and the jobs that must run again; the report shows all settings.
CHANGES = {
    "nothing": ("seed=1", {}),
    "values of n_c": ("grids={n_c: [2, 4, 8]}", SEEDS | jobs("measure_times", "tabulate_times")),
    "gains of the feedback": ("control={pd: {kp_kpa_per_deg: 0.6}}", SEEDS | LOOPS),
    "one reference": ("tracking={references: {sine_0p2: {duration_s: 9}}}", SEEDS | LOOPS),
}


@pytest.mark.parametrize("what", CHANGES)
def test_setting_reruns_what_reads_it_and_nothing_else(smoked, what):
    change, expected = CHANGES[what]
    assert rerun(smoked[0], "--config", change) == expected


def test_source_tree_that_is_reached_through_a_link_reruns_nothing(smoked, tmp_path):
    link = tmp_path / "link"
    link.symlink_to(smoked[0].folder)
    assert rerun(smoked[0], "--snakefile", str(link / "Snakefile")) == {}
