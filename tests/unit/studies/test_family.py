import json

import pytest

from fprc.config import Settings
from fprc.errors import FprcError
from fprc.experiments.data import RigSettings, simulate
from fprc.studies import family as families
from fprc.studies.family import count_members, judge_family, judge_tables, unit_of

SETTINGS = Settings().model_dump(mode="json")


def test_each_unit_of_one_rig_is_a_seed(family):
    units = [unit_of(number, family, 601) for number in (0, 1)]
    assert [unit.seed for unit in units] == [601, 602]
    assert units[0].on_rig.rig == SETTINGS["rig"]


def test_each_unit_of_the_ensemble_is_a_rig_with_its_own_values(family):
    paths = ["bending.friction_kpa", "bending.slip_weight.0", "bending.relaxation_time_s.1"]
    family["members"] = {"parameters": paths, "rigs": [[7.5, 0.4, 5.0], [2.5, 0.2, 6.0]]}
    family["on_rig"]["rig"] = {"of": "the configuration, which plays no part"}
    first, second = (unit_of(number, family, 601) for number in (0, 1))
    bending = first.on_rig.rig["bending"]
    assert (bending["friction_kpa"], bending["relaxation_time_s"]) == (7.5, [0.25, 5.0])
    assert bending["slip_weight"] == pytest.approx([0.4, 0.3, 0.25, 0.05])  # they sum to 1
    assert first.on_rig.rig["valve"] == SETTINGS["rig"]["valve"]
    assert second.on_rig.rig["bending"]["friction_kpa"] == 2.5
    assert (first.seed, second.seed) == (601, 602)
    with pytest.raises(FprcError, match="2 rigs"):
        unit_of(2, family, 601)


def test_all_parts_of_a_judgement_are_of_one_rig_and_one_seed(family, monkeypatch):
    def compare(data, how):
        return {"theta": float(data["sweep"].channels["theta_deg"].sum())}, {"fprc": how.seed}

    def measure(sweep, bench, models, controllers):
        return {"theta": float(sweep.channels["theta_deg"].sum()), "seed": bench.seed, **models}

    monkeypatch.setattr(families, "compare_models", compare)
    monkeypatch.setattr(families, "measure_control", measure)
    validation = {"models": SETTINGS["models"], "folds": 2, "split": "shuffled"}
    unit = unit_of(4, family, 601)
    judged = judge_tables(unit, tracking=SETTINGS["tracking"], validation=validation)
    theta = float(
        simulate(RigSettings(**family["on_rig"]), 605)["sweep"].channels["theta_deg"].sum()
    )
    assert judged["compared"] == {"theta": theta}
    assert judged["measured"] == {"theta": theta, "seed": 605, "fprc": 605}


def test_every_unit_is_judged_and_one_that_fails_is_the_only_one_lost(
    family, tmp_path, monkeypatch
):
    def judge(unit, factor):
        if unit.number == 1:
            raise FprcError("it\ndiverged")
        return {"found": factor * unit.number}

    monkeypatch.setattr("fprc.studies.learning.judge_online", judge)
    out = tmp_path / "judged.json"
    study = {"judge": "learning.judge_online", "how": {"factor": 3}, "first_seed": 601, "units": 3}
    judge_family(str(out), family=family, study=study, workers=1)
    report = json.loads(out.read_text())
    assert (report["name"], report["fitted"]) == ("dry", ["tables"])
    assert report["cells"] == [
        {"unit": 0, "seed": 601, "found": 0},
        {"unit": 1, "seed": 602, "failed": "it diverged"},
        {"unit": 2, "seed": 603, "found": 6},
    ]


def test_claims_are_counted_on_the_rigs_that_could_be_judged(tmp_path, monkeypatch):
    def members(claims, rigs):
        errors = [rig.replicates[0]["error"] for rig in rigs]
        assert [rig.controls for rig in rigs] == [[{"loops": error}] for error in errors]
        return {"errors": errors, "claims": [claim.id for claim in claims]}

    monkeypatch.setattr(families, "members_of", members)
    cells = [{"compared": {"error": error}, "measured": {"loops": error}} for error in (1, 2)]
    cells.append({"failed": "it diverged"})
    judged, out = (tmp_path / name for name in ("judged.json", "out.json"))
    judged.write_text(json.dumps({"cells": cells}))
    count_members(str(judged), str(out))
    found = json.loads(out.read_text())
    assert found["errors"] == [1, 2]
    assert {"C1a", "C13a"} <= set(found["claims"])
    assert not {"C9a"} & set(found["claims"])  # needs a grid
