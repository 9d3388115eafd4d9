import h5py
import pytest

from fprc.logs import COMPLETE, holdings

NAMES = ["sweep", "complex", "track_sweep_fprc"]


def test_channels_and_notes_of_the_logs_that_are_there(write_log, tmp_path):
    path = write_log("sweep.h5", notes='{"theta_deg": "not in deg: x [mm]", "p_o_kpa": "muscle 1"}')
    with h5py.File(path, "a") as log:
        del log["phi_deg"]
    found = holdings(tmp_path, NAMES)
    assert list(found) == ["sweep"]
    assert found["sweep"].lacks(["phi_deg", "p_o_kpa"]) == ["phi_deg"]
    assert found["sweep"].instead("theta_deg") == "x [mm]"
    assert found["sweep"].instead("p_o_kpa") is None
    assert found["sweep"].instead("p_i_kpa") is None


def test_logs_to_come_count_as_complete(tmp_path):
    found = holdings(tmp_path, NAMES, to_come=["complex"])
    assert found == {"complex": COMPLETE}
    assert COMPLETE.lacks(["phi_deg", "anything"]) == []


@pytest.mark.parametrize("content", [b"", b"\x89HDF\r\n\x1a\n", b"no log at all"])
def test_file_that_cannot_be_read_is_left_to_its_reader(tmp_path, content):
    (tmp_path / "sweep.h5").write_bytes(content)
    assert holdings(tmp_path, NAMES) == {"sweep": COMPLETE}


def test_notes_that_are_no_json_are_left_to_their_reader(write_log, tmp_path):
    write_log("sweep.h5", notes="{")
    assert holdings(tmp_path, NAMES) == {"sweep": COMPLETE}


def test_logs_to_come_lack_what_the_rig_does_not_measure(tmp_path):
    found = holdings(tmp_path, NAMES, to_come=NAMES, without=["phi_deg"])
    assert found["sweep"].lacks(["phi_deg", "p_o_kpa"]) == ["phi_deg"]
