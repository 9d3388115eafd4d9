import pytest

from fprc.artifacts import read_json
from fprc.studies.stages.judge import judge_family


@pytest.fixture
def run(tmp_path):
    """Judge with one process, which shares the module that a test has changed."""

    def run(**how):
        judge_family(
            str(tmp_path / "judged.json"), workers=1, version="1",
            checkpoint=str(tmp_path / "partial.jsonl"), **how,
        )  # fmt: skip
        return read_json(tmp_path / "judged.json")

    return run


def test_every_unit_of_a_family_is_judged_and_described(family, run, monkeypatch):
    def judge(unit, factor):
        return [{"seed": seed, "found": factor * unit.number} for _, seed in unit.rigs]

    monkeypatch.setattr("fprc.studies.online.judge.judge_online", judge)
    report = run(judge="online.judge.judge_online", family=family, units=[0, 2], how={"factor": 3})
    assert (report["name"], report["fitted"]) == ("dry", ["tables"])
    found = [tuple(cell[key] for key in ("unit", "seed", "found")) for cell in report["cells"]]
    assert found == [(0, 601, 0), (2, 603, 6)]
