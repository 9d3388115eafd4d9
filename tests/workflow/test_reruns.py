"""After an edit only the rules that run the edited code, and those after them, run again."""

import shutil
from inspect import signature
from pathlib import Path

import pytest

import fprc
from fprc.stages.run import _NOT_ARGUMENTS, stage_of

pytestmark = pytest.mark.slow

#: Further seeds, which are one job each, and what is made of them.
SEEDS = {
    "replicate": 2,
    "seeds_table": 2,
    "tracking_seeds_table": 1,
    "draw_fig10": 1,
    "draw_fig11": 1,
}

ESN = SEEDS | {
    "judge": 1,
    "measure_times": 1,
    "comparison_table": 2,
    "timing_table": 1,
    "ledger": 1,
    "report_page": 1,
}


def figures(*numbers):
    """Return one job for each of these figures."""
    return {f"draw_fig{number}": 1 for number in numbers}


#: What every model shares: all but the experiments and what is made of their logs alone.
MODELS = ESN | figures(*range(8, 18)) | {
    "judge": 3,
    "weigh": 1,
    "track": 5,
    "tracking_table": 1,
}  # fmt: skip
RIG = MODELS | figures(4, 5) | {"record": 2, "preprocess": 2}
ALL = RIG | figures(1, 2, 3, 6, 7) | {"configuration_table": 1}
#: The closed loops, and what is made of them alone.
FEEDBACK = SEEDS | figures(*range(12, 18)) | {
    "track": 5, "tracking_table": 1, "ledger": 1, "report_page": 1,
}  # fmt: skip
#: Those whose stages are in one module.
TABLES = dict.fromkeys([rule for rule in ALL if rule.endswith("_table")], 1) | {
    "comparison_table": 2, "seeds_table": 2
}  # fmt: skip
REPORT = {"report_page": 1}

#: Edits that rerun the same jobs are made together: file, old text, new text.
NOTHING = [
    ("models/features.py", "\n\n\ndef ", "\n\n\n# a comment\ndef "),
    ("models/esn.py", '"""Return the unfitted network."""', '"""The net."""'),
    ("cli.py", "import sys", "import sys\n\nUNUSED = 1"),
]
OF_THE_ESN = [
    ("models/esn.py", "_part(RidgeReadout)", "_part(RidgeReadout, **{})"),
    ("models/echo_features.py", "self.w_in_ = ", "self.w_in_ = 1.0 * "),
    ("models/echo.py", "SHORTEST = ", "SHORTEST = 1 * "),
    ("models/ridge_readout.py", "return X @ self", "return 1.0 * X @ self"),
]

EDITS = {
    "comment, docstring, code that no rule runs": (NOTHING, {}),
    "ESN, its features, its states, its readout": (OF_THE_ESN, ESN),
    "rig": ([("rig/friction.py", "return force", "return 1.0 * force")], RIG),
    "what runs every stage": (
        [("stages/run.py", "threadpool_limits(1)", "threadpool_limits(limits=1)")], ALL,
    ),
    "stage of Fig. 5": (
        [("stages/draw.py", "style.COLUMN_IN, 2.4", "style.COLUMN_IN, 2.5")],
        figures(4, 5, *range(8, 12)) | REPORT,
    ),
    "page of Table IV": (
        [("tables/tracking.py", "return pd.DataFrame(page)", "return pd.DataFrame(list(page))")],
        TABLES | REPORT,
    ),
}  # fmt: skip


def rerun(project, *arguments, **environment):
    """Jobs of the smoke run that would run again, by rule."""
    jobs = project.planned("all", "--configfile", "config/smoke.yaml", *arguments, **environment)
    return {rule: count for rule, count in jobs.items() if rule != "all"}


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


def test_every_rule_gives_its_stage_what_it_takes_and_carries_its_fingerprint(project):
    stages = project.stages()
    assert len(stages) > 50
    for stage, named in stages.values():
        assert not named.isdisjoint({"code", "version"}), stage
        signature(stage_of(stage)).bind(**dict.fromkeys(named.difference(_NOT_ARGUMENTS)))


#: Settings on the command line, and the jobs that must run again; the report shows all settings.
CHANGES = {
    "nothing": ("seed=1", {}),
    "values of n_c": (
        "grids={n_c: [2, 4, 8]}",
        SEEDS | {"measure_times": 1, "timing_table": 1, "ledger": 1, "report_page": 1},
    ),
    "gains of the feedback": ("control={pd: {kp_kpa_per_deg: 0.6}}", FEEDBACK),
    "one reference": (
        "tracking={references: {sine_0p2: {duration_s: 9}}}",
        # the four figures share a range of errors
        SEEDS | {"track": 1, "tracking_table": 1, "ledger": 1, "report_page": 1}
        | figures(*range(12, 16)),
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", CHANGES)
def test_setting_reruns_what_reads_it_and_nothing_else(smoked, what):
    change, expected = CHANGES[what]
    assert rerun(smoked[0], "--config", change) == expected
