"""The search for rigs near print as a stage: seeds, checkpoint and result file."""

import numpy as np
import pytest
from scipy.special import ndtr

from fprc.artifacts import read_json
from fprc.config import Settings
from fprc.config.load import PUBLISHED
from fprc.config.rig import Rig
from fprc.plan.arguments import on_rig
from fprc.studies.calibration.objective import printed_errors
from fprc.studies.calibration.space import free_parameters
from fprc.studies.stages import near_print as stage
from fprc.yaml_file import read_yaml

FREE = {"paths": ["bending.preload_kpa", "drift.sigma_kpa", "bending.friction_kpa"], "ranges": {}}
PRELOAD = free_parameters(**FREE)[0][1:3]
ERRORS = printed_errors(read_yaml(PUBLISHED))
SLOPES = np.random.default_rng(0).normal(0.0, 0.3, (len(ERRORS), 3))


def logs_of(point, seed):
    """A rig that is linear in its parameters, with noise of its own."""
    noise = 0.05 * np.random.default_rng(seed).standard_normal(len(ERRORS))
    return np.log(list(ERRORS.values())) + SLOPES @ (np.asarray(point) - 0.5) + noise


@pytest.fixture
def draw(monkeypatch, tmp_path):
    """Find rigs like one that costs nothing; counts what is judged."""
    judged = []

    def judge(cell, *, drawn, free, on_rig, models, surrogate, ratios):
        assert set(ratios.values()) == {1.25}
        if len(judged) == draw.dies_after:
            raise KeyboardInterrupt
        judged.append(cell["seed"])
        if cell["point"][0] > 2.0:
            return {"impossible": "too stiff"}
        return {"logs": logs_of(cell["point"], cell["seed"]).tolist()}

    monkeypatch.setattr(stage, "judge_member", judge)
    monkeypatch.setattr(
        stage,
        "draw_member",
        lambda cell, **rest: {
            "point": np.random.default_rng(cell["draw"]).standard_normal(3).tolist()
        },
    )
    monkeypatch.setattr(
        stage, "judge_fully", lambda *rest, **more: [{"errors": dict.fromkeys(ERRORS, 1.25)}] * 2
    )
    monkeypatch.setattr(
        stage, "judge_by_surrogate", lambda *rest: {"errors": dict.fromkeys(ERRORS, 1.0)}
    )
    settings = Settings().model_dump(mode="json")

    def draw(name="rigs", dies_after=None):
        draw.dies_after = dies_after
        judged.clear()
        stage.find_near_print(
            str(PUBLISHED), str(tmp_path / f"{name}.json"),
            near_print={
                "rigs": 12, "keep": 4, "seed": 70, "tolerance": 0.1, "assimilations": 2, "sweeps": 3
            },
            drawn={}, free=FREE,
            on_rig=on_rig(settings),
            judgement={"models": settings["models"]}, surrogate={}, workers=1,
            checkpoint=str(tmp_path / f"{name}.partial.jsonl"), version="1",
        )  # fmt: skip
        return tmp_path / f"{name}.json"

    draw.judged = judged
    return draw


def test_rigs_that_are_kept_are_possible_and_as_many_as_asked(draw):
    report = read_json(draw())
    assert len(set(draw.judged)) == len(draw.judged)
    assert len(report["rigs"]) == 4
    for rig in report["rigs"]:
        (point,) = [Rig.model_validate(rig).bending.preload_kpa]
        low, high = PRELOAD
        assert low <= point <= low + (high - low) * ndtr(2.0) + 0.01


@pytest.mark.slow
@pytest.mark.parametrize("dies_after", [5, 20, 33])
def test_drawing_that_was_stopped_goes_on_to_the_same_rigs(draw, dies_after):
    whole = draw("whole").read_bytes()
    everything = len(draw.judged)
    with pytest.raises(KeyboardInterrupt):
        draw("again", dies_after)
    assert draw("again").read_bytes() == whole
    assert len(draw.judged) == everything - dies_after
