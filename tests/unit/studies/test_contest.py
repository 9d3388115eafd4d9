import math

import numpy as np
import pytest

from fprc.config import Settings
from fprc.config.settings import Tracking
from fprc.evaluation import rmse
from fprc.experiments.data import RigSettings, simulate
from fprc.experiments.tracking import Track, tracking_errors
from fprc.models import FPRC
from fprc.registry import COMPETITORS
from fprc.studies import contest as contests
from fprc.studies.contest import BRIEF, SLOW, judge_models
from fprc.studies.family import Unit

SETTINGS = Settings().model_dump(mode="json")
SEED = 3

pytestmark = pytest.mark.slow  # whole fits


@pytest.fixture(scope="module")
def on_rig(signals):
    return RigSettings(
        rig=SETTINGS["rig"], control=SETTINGS["control"], signals=signals, target="command"
    )


@pytest.fixture(scope="module")
def tracking():
    references = {
        name: reference | {"duration_s": 8.0}
        for name, reference in SETTINGS["tracking"]["references"].items()
    }
    return SETTINGS["tracking"] | {"references": references}


@pytest.fixture(scope="module")
def judge(on_rig, tracking):
    """Return what judges a unit, of a family with every model or not."""
    how = {"models": SETTINGS["models"], "tracking": tracking}

    def call(every=False, number=0):
        unit = Unit(number, on_rig, SEED, every)
        return judge_models(unit, **how, slow=2)["models"]

    return call


@pytest.fixture(scope="module")
def logs(on_rig):
    return simulate(on_rig, SEED)


@pytest.fixture(scope="module")
def judged(judge):
    with pytest.MonkeyPatch.context() as few:
        few.setattr(contests, "BRIEF", ("fprc", "fuzzy_linear", "plays_p_o"))
        return judge()


@pytest.fixture(scope="module")
def fprc(logs):
    X, y, _ = logs["sweep"].samples("fprc")
    return FPRC(random_state=SEED).fit(X, y)


def test_errors_are_those_of_the_model_by_itself(judged, fprc, logs):
    X, y, _ = logs["complex"].samples("fprc")
    assert judged["fprc"]["forward"] == pytest.approx(rmse(y, fprc.predict(X)))
    assert judged["fprc"]["forward/-2"] == pytest.approx(rmse(y, fprc.predict(X - [0.0, 2.0])))
    backward = FPRC(random_state=SEED).fit(X, y)
    X, y, _ = logs["sweep"].samples("fprc")
    assert judged["fprc"]["reversed"] == pytest.approx(rmse(y, backward.predict(X)))
    assert judged["fprc"]["train"] == pytest.approx(rmse(y, fprc.predict(X)))


def test_offset_of_p_o_reaches_the_tracking_of_fprc(judged, fprc, on_rig, tracking):
    own = judged["fprc"]
    shifted = on_rig.control.feedforward.changed(p_o_shift_kpa=-2.0)
    control = on_rig.control.changed(feedforward=shifted)
    bench = Track(Tracking(**tracking), control, on_rig.rig, SEED)
    expected = tracking_errors(bench, fprc, {"open_loop": False, "closed_loop": True})
    for loop, errors in expected.items():
        assert own[f"{loop}/-2"] == pytest.approx(math.sqrt(np.mean(np.square([*errors.values()]))))
        assert own[f"{loop}/-2"] > 1.02 * own[loop]
    assert set(judged["fuzzy_linear"]) == {"train", "forward", "reversed", *expected}


def test_unseen_blocks_and_memory_are_measured_too(judged):
    assert 0.5 < judged["plays_p_o"]["blocks"] / judged["plays_p_o"]["train"] < 4.0
    assert judged["fprc"]["blocks"] > 0.0
    assert judged["threshold"] == {"nonlinear": 0.1}
    for name in ("p_o", "theta"):
        assert 0.0 < judged[name]["memory_s"] < 5.0
        assert 0.0 < judged[name]["nonlinear"] < 4.0


@pytest.mark.parametrize(("every", "number"), [(False, 0), (True, 0), (True, 2)])
def test_slow_models_are_judged_on_the_first_units_only(monkeypatch, judge, every, number):
    def refuse(name, *_):
        raise ValueError("not\nnow")

    monkeypatch.setattr(contests, "_trained", refuse)
    names = [*COMPETITORS] if every else [*BRIEF]
    if number == 2:
        names = [name for name in names if name not in SLOW]
    found = judge(every, number)
    assert [name for name, report in found.items() if "failed" in report] == names
    assert found["fprc"] == {"failed": "not now"}
