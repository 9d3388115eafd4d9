"""The drawing of the posterior as a stage: seeds, checkpoint and result file."""

import numpy as np
import pytest

from fprc.artifacts import read_json
from fprc.config import Settings
from fprc.config.load import PUBLISHED
from fprc.studies.calibration.objective import printed_errors
from fprc.studies.stages import posterior as stage
from fprc.yaml_file import read_yaml

FREE = {"paths": ["bending.preload_kpa", "drift.sigma_kpa", "bending.friction_kpa"], "ranges": {}}
ERRORS = printed_errors(read_yaml(PUBLISHED))
SLOPES = np.random.default_rng(0).normal(0.0, 0.3, (len(ERRORS), 3))


def logs_of(point, seed):
    """A rig that is linear in its parameters, with noise of its own."""
    noise = 0.05 * np.random.default_rng(seed).standard_normal(len(ERRORS))
    return np.log(list(ERRORS.values())) + SLOPES @ (np.asarray(point) - 0.5) + noise


@pytest.fixture
def draw(monkeypatch, tmp_path):
    """Draw members of a rig that costs nothing; counts what is judged."""
    judged = []

    def judge(cell, *, ensemble, free, on_rig, models, surrogate, ratios):
        assert set(ratios.values()) == {1.25}
        if len(judged) == draw.dies_after:
            raise KeyboardInterrupt
        judged.append(cell["seed"])
        if cell["point"][0] > 2.0:
            return {"impossible": "too stiff"}
        return {"logs": logs_of(cell["point"], cell["seed"]).tolist()}

    monkeypatch.setattr(stage, "judge_member", judge)
    monkeypatch.setattr(
        stage, "prior_point", lambda seed, **rest: np.random.default_rng(seed).standard_normal(3)
    )
    monkeypatch.setattr(stage, "full_errors", lambda *rest: [dict.fromkeys(ERRORS, 1.25)] * 2)
    monkeypatch.setattr(
        stage, "judge_by_surrogate", lambda *rest: {"errors": dict.fromkeys(ERRORS, 1.0)}
    )
    settings = Settings().model_dump(mode="json")

    def draw(name="members", dies_after=None):
        draw.dies_after = dies_after
        judged.clear()
        stage.draw_members(
            str(PUBLISHED), str(tmp_path / f"{name}.json"),
            posterior={
                "rigs": 12, "seed": 70, "tolerance": 0.1, "assimilations": 2, "sweeps": 3
            },
            ensemble={}, free=FREE,
            on_rig={
                "rig": settings["rig"], "signals": settings["experiments"],
                "control": settings["control"], "target": "command",
            },
            judgement={"models": settings["models"]}, surrogate={}, workers=1,
            checkpoint=str(tmp_path / f"{name}.partial.jsonl"), version="1",
        )  # fmt: skip
        return tmp_path / f"{name}.json"

    draw.judged = judged
    return draw


def test_each_member_is_what_its_point_and_seed_give(draw):
    report = read_json(draw())
    assert len(set(draw.judged)) == len(draw.judged)
    seeds = [member["seed"] for member in report["members"]]
    assert len(set(seeds)) == len(seeds) >= 6
    for member in report["members"]:
        assert member["logs"] == pytest.approx(logs_of(member["point"], member["seed"]))
        assert member["point"][0] <= 2.0
    assert [row["step"] for row in report["history"]][-1] == "sweep 3"


@pytest.mark.slow
@pytest.mark.parametrize("dies_after", [5, 20, 33])
def test_drawing_that_was_stopped_goes_on_to_the_same_members(draw, dies_after):
    whole = draw("whole").read_bytes()
    everything = len(draw.judged)
    with pytest.raises(KeyboardInterrupt):
        draw("again", dies_after)
    assert draw("again").read_bytes() == whole
    assert len(draw.judged) == everything - dies_after
