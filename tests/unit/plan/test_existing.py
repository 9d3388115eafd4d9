"""The raw logs that exist when the workflow begins."""

import h5py
import pytest

from fprc.config import check
from fprc.errors import LogError
from fprc.logs.quality import substitute
from fprc.plan.plan import read_plan

NAMES = ["sweep", "complex", "track_sweep_fprc"]


def there(folder, source="sim"):
    settings = check({"source": source}).model_dump(mode="json")
    return read_plan(settings, str(folder)).existing


def test_channels_and_notes_of_the_logs_that_are_there(write_log, tmp_path):
    path = write_log("sweep.h5", notes={"theta_deg": "not in deg: x [mm]", "p_o_kpa": "muscle 1"})
    with h5py.File(path, "a") as log:
        del log["phi_deg"]
    found = there(tmp_path)
    assert list(found) == ["sweep"]
    assert {"phi_deg", "p_o_kpa"} - found["sweep"].names == {"phi_deg"}
    substitutes = [
        substitute(name, found["sweep"].attributes) for name in ("theta_deg", "p_o_kpa", "p_i_kpa")
    ]
    assert substitutes == ["x [mm]", None, None]


def test_every_file_that_cannot_be_read_is_named(write_log, tmp_path):
    (tmp_path / "sweep.h5").write_bytes(b"no log at all")
    write_log("complex.h5", notes="{")
    write_log("track_sweep_fprc.h5")
    with pytest.raises(LogError) as caught:
        there(tmp_path)
    first, second = str(caught.value).splitlines()
    assert first.startswith(f"{tmp_path / 'sweep.h5'}: not an HDF5 file")
    assert second.startswith(f"{tmp_path / 'complex.h5'}: attribute notes = '{{': must be a JSON")


def test_logs_are_listed_in_the_order_of_the_plan(write_log, tmp_path):
    assert there(tmp_path) == {}
    for name in reversed(NAMES):
        write_log(f"{name}.h5")
    assert list(there(tmp_path)) == NAMES


# --- what may be overwritten ------------------------------------------------------------------


def test_simulated_logs_and_absent_ones_may_be_overwritten(write_log, tmp_path):
    write_log("sweep.h5")
    there(tmp_path)
    with pytest.raises(LogError, match=r"sweep\.h5: is a log of the simulated rig, not of"):
        there(tmp_path, source="rig")


@pytest.mark.parametrize("source", ["rig", "import"])
def test_every_log_of_a_real_rig_is_named_and_not_overwritten(write_log, tmp_path, source):
    paths = [write_log("sweep.h5", source=source), write_log("complex.h5", source=source)]
    write_log("track_sweep_fprc.h5")
    with pytest.raises(LogError, match="will not be overwritten") as caught:
        there(tmp_path)
    lines = str(caught.value).splitlines()
    assert [line.split(": ")[0] for line in lines] == [str(path) for path in paths]


def test_log_that_does_not_say_where_it_comes_from_is_not_overwritten(write_log, tmp_path):
    with h5py.File(write_log("sweep.h5"), "r+") as file:
        del file.attrs["source"]
    with pytest.raises(LogError, match="will not be overwritten"):
        there(tmp_path)
    there(tmp_path, source="rig")
