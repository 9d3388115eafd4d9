import h5py
import pytest

from fprc.artifacts import read_json
from fprc.errors import LogError
from fprc.stages.track import read_gains

PRINTED = {"kp_kpa_per_deg": 0.5, "kd_kpa_s_per_deg": 0.005}
FOUND = {"kp_kpa_per_deg": 4.0, "kd_kpa_s_per_deg": 0.04}


@pytest.fixture
def gains_of(write_run, tmp_path):
    def read(*runs, **more):
        paths = []
        for number, (gain, rig) in enumerate(runs):
            source = more.get("sources", ["rig"] * len(runs))[number]
            path = write_run(f"run_{number}.h5", rig=rig, source=source, gain=gain)
            paths.append(str(path))
        read_gains(paths, str(tmp_path / "gains.json"))
        return read_json(tmp_path / "gains.json")

    return read


def test_gains_are_those_that_the_logs_name(gains_of):
    runs = [("none", {"gains": None}), ("printed", {"gains": PRINTED})]
    found = gains_of(*runs, ("identified", {"gains": FOUND}), ("identified", {"gains": FOUND}))
    assert found["printed"] == PRINTED
    assert found["identified"] == FOUND
    assert "none" not in found
    assert found["source"] == "rig"


@pytest.mark.parametrize("other", [{"gains": FOUND}, {}, {"gains": {"kp_kpa_per_deg": 1}}])
def test_gain_that_is_not_clear_is_left_out_and_said(gains_of, caplog, other):
    found = gains_of(("printed", {"gains": PRINTED}), ("printed", other))
    assert "printed" not in found
    assert "do not agree on the printed gains" in caplog.text


def test_logs_of_two_kinds_make_no_table(gains_of):
    with pytest.raises(LogError, match=r"different sources: rig \(.*run_0.h5\), sim \("):
        gains_of(("none", {}), ("none", {}), sources=["rig", "sim"])


@pytest.mark.parametrize("told", [[], 5, {"kp_kpa_per_deg": "nan", "kd_kpa_s_per_deg": 0.1}])
def test_gains_that_are_none_are_left_out(gains_of, told):
    assert "printed" not in gains_of(("printed", {"gains": told}))


def test_attribute_of_a_run_that_is_missing_is_named(write_run, tmp_path):
    path = write_run("run.h5")
    with h5py.File(path, "r+") as file:
        del file.attrs["gain"]
    with pytest.raises(LogError, match=r"run.h5: attribute gain: missing; .*README"):
        read_gains([str(path)], str(tmp_path / "gains.json"))
