"""The measurements of `make scaling`."""

from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]


@pytest.fixture
def scaling(tool, monkeypatch):
    monkeypatch.chdir(ROOT)
    return tool("benchmark.scaling")


@pytest.mark.slow
@pytest.mark.parametrize("alone", [False, True])
def test_plan_is_of_the_whole_ensemble_or_of_one_job(scaling, alone):
    spent = scaling.planned(7, alone=alone)
    assert spent.cpu_s > 0.1
    assert 20 < spent.peak_mb < 2000


@pytest.mark.slow
def test_plan_that_failed_is_no_measurement(scaling):
    with pytest.raises(SystemExit, match=r"(?s)snakemake failed.*ensemble\.rigs"):
        scaling.planned(0)


def test_cost_of_a_rig_is_without_the_start_of_its_job(scaling, monkeypatch):
    monkeypatch.setattr(scaling, "judged", lambda rigs: (10.0 + 4.0 * rigs, 500 + 2000 * rigs))
    monkeypatch.setattr(
        scaling, "planned", lambda jobs, alone=False: scaling.Spent(1.5 + jobs, 90.0, "")
    )
    assert scaling.markdown(scaling.costs(2)).splitlines()[2:] == [
        "| one rig: draws, both logs, Tables II to IV | 4.00 | 2.0 |",
        "| start of a job | 10.00 |  |",
        "| start of a job under Slurm, which plans twice | 12.50 |  |",
    ]
    _, first, *_, last = scaling.plans()
    assert first == ["1", "2.50", "90", "2.50"]
    assert last == ["1,000,000", "not measured", "not measured", "1000001.5"]
