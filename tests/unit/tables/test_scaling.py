import pytest

from fprc.tables.scaling import costs, dag, plan, start_of_job


@pytest.fixture
def scale():
    def planned(jobs, cpu_s, peak_mb):
        return {"jobs": jobs, "cpu_s": cpu_s, "wall_s": 9.0, "peak_mb": peak_mb}

    return {
        "cpu": "a processor",
        "rig": {"cpu_s": 36.0, "bytes": 10_000.0, "measured": 2},
        "cell": {"cpu_s": 0.5, "measured": 4},
        "loop": {"cpu_s": 0.005, "measured": 45.0},
        "start": {"cpu_s": 1.0},
        "dag": [planned(1, 2.0, 100), planned(101, 4.0, 200), planned(1001, 22.0, 1100)],
        "alone": [planned(1, 2.0, 100), planned(101, 3.0, 100), planned(100_101, 103.0, 500)],
        "chunk": 5,
    }


def row(scale, rigs, chunk):
    found = plan(scale).set_index(["Rigs", "Chunk"])
    return found.loc[(rigs, chunk)]


def test_start_is_two_plans_and_one_import(scale):
    assert start_of_job(scale, 1) == 5.0
    assert start_of_job(scale, 101) == 7.0
    assert start_of_job(scale, 51) == 6.0


def test_start_grows_with_the_jobs_beyond_what_was_measured(scale):
    assert start_of_job(scale, 200_101) == pytest.approx(1 + 2 * 203)


def test_plan_adds_rigs_and_starts(scale):
    thousand = row(scale, "1,000", "100")
    assert thousand["Jobs"] == "10"
    assert thousand["Core-hours"] == "10"
    assert float(thousand["Minutes per job"]) == pytest.approx((3600 + 5.18) / 60, rel=0.01)
    assert thousand["Files"] == "30"
    assert thousand["Results [GB]"] == "0.0100"


def test_a_million_single_jobs_cost_their_starts_too(scale):
    assert row(scale, "1,000,000", "1,000")["Core-hours"] == "10,002"
    single = row(scale, "1,000,000", "1")
    starts_h = 1e6 * start_of_job(scale, 1_000_000) / 3600
    assert single["Core-hours"] == f"{10_000 + starts_h:,.0f}"
    assert single["Files"] == "3,000,000"
    assert float(single["Planning [min]"]) == pytest.approx((22 + 0.02 * 998_999) / 60, rel=0.01)
    assert float(single["Memory of it [GB]"]) == pytest.approx(1000, rel=0.01)


def test_sizes_that_were_not_planned_in_full_say_so(scale):
    shown = dag(scale).set_index("Jobs")
    assert shown.loc["101", "All of them [core-seconds]"] == "4.00"
    assert shown.loc["100,101", "All of them [core-seconds]"] == "not measured"
    assert shown.loc["100,101", "One of them [core-seconds]"] == "103"


def test_costs_name_what_was_measured(scale):
    shown = costs(scale)
    assert list(shown["Core-seconds"]) == ["36.0", "0.500", "0.00500", "5.00"]
    assert list(shown["Mean of"]) == ["2 rigs", "4 cells", "45 s", "1 start"]
