import os
import subprocess
import sys

import h5py
import numpy as np
import pytest

from fprc.errors import LogError
from fprc.logs import RAW_CHANNELS, read_columns
from fprc.logs import isolated as module
from fprc.logs.columns import unit_of
from fprc.logs.salvage import salvage

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("share", [0.9, 0.75, 0.5, 0.3])
def test_numbers_of_a_cut_log_are_those_that_were_written(write_log, share):
    path = write_log()
    whole = read_columns(path, RAW_CHANNELS).channels
    os.truncate(path, int(share * path.stat().st_size))
    try:
        found = salvage(path)
    except LogError:
        assert share < 0.5
        return
    lengths = {len(values) for values in found.channels.values()}
    assert len(lengths) == 1
    for name, values in found.channels.items():
        np.testing.assert_array_equal(values, whole[name][: len(values)])
    told = "\n".join(found.messages)
    assert "cut short: " in told
    for name in whole.keys() - found.channels.keys():
        assert name in told


def test_huge_sparse_file_is_refused_before_it_is_copied(write_log):
    path = write_log()
    os.truncate(path, 1 << 40)
    with pytest.raises(LogError, match=r"1,099,511,627,776 bytes"):
        salvage(path)


@pytest.mark.parametrize(("there", "kept"), [(300, True), (200, True), (199, False), (0, False)])
def test_channel_that_lost_more_than_half_is_left_out(write_log, there, kept):
    path = write_log()
    with h5py.File(path) as file:
        begin = file["valve_reservoir_v"].id.get_offset()
    os.truncate(path, begin + 8 * there + 7)
    found = salvage(path)
    assert ("valve_reservoir_v" in found.channels) is kept
    assert {len(values) for values in found.channels.values()} == {there if kept else 400}
    assert found.lost == (400 - there if kept else 0)
    said = f"valve_reservoir_v: {400 - there} of 400 samples lost"
    assert said + ("" if kept else "; left out of the copy") in found.messages


@pytest.mark.parametrize("name", ["theta_deg", "time_s"])
@pytest.mark.parametrize(("length", "kept"), [(399, True), (200, True), (199, False), (0, False)])
def test_channel_that_was_written_shorter_than_the_others_is_named(write_log, name, length, kept):
    path = write_log()
    with h5py.File(path, "r+") as file:
        values, unit = file[name][:length], file[name].attrs["units"]
        del file[name]
        file.create_dataset(name, data=values).attrs["units"] = unit
    found = salvage(path)
    assert (name in found.channels) is kept
    assert {len(values) for values in found.channels.values()} == {length if kept else 400}
    assert found.lost == (400 - length if kept else 0)
    fate = "" if kept else "; left out of the copy"
    assert f"{name}: {length} samples, but others have up to 400{fate}" in found.messages


def test_channels_that_are_left_out_for_one_that_is_longer_are_named(write_log):
    path = write_log()
    with h5py.File(path, "r+") as file:
        names = set(file) - {"p_o_kpa"}
        del file["p_o_kpa"]
        file.create_dataset("p_o_kpa", data=np.arange(801.0)).attrs["units"] = "kPa"
    found = salvage(path)
    assert found.channels.keys() == {"p_o_kpa"}
    for name in names:
        assert (
            f"{name}: 400 samples, but others have up to 801; left out of the copy"
            in found.messages
        )


def test_chunked_channel_is_read_up_to_its_first_lost_chunk(write_log):
    path = write_log()
    values = np.arange(400.0)
    with h5py.File(path, "r+") as file:
        del file["valve_reservoir_v"]
        made = file.create_dataset("valve_reservoir_v", data=values, chunks=(50,), fletcher32=True)
        made.attrs["units"] = "V"
        fifth = made.id.get_chunk_info_by_coord((200,)).byte_offset
    data = bytearray(path.read_bytes())
    data[fifth + 8] ^= 1
    path.write_bytes(data)
    found = salvage(path)
    assert found.channels["valve_reservoir_v"].tolist() == values[:200].tolist()
    assert "valve_reservoir_v: 200 of 400 samples lost" in found.messages


def test_chunk_that_was_cut_off_is_not_taken_for_zeros(write_log):
    path = write_log()
    with h5py.File(path, "r+") as file:
        del file["valve_reservoir_v"]
        made = file.create_dataset("valve_reservoir_v", data=np.arange(1.0, 401.0), chunks=(50,))
        made.attrs["units"] = "V"
        chunks = [made.id.get_chunk_info_by_coord((k,)).byte_offset for k in range(0, 400, 50)]
    assert chunks == sorted(chunks)
    os.truncate(path, chunks[6] + 8)
    found = salvage(path)
    assert found.channels["valve_reservoir_v"].tolist() == np.arange(1.0, 301.0).tolist()
    assert "valve_reservoir_v: 100 of 400 samples lost" in found.messages


def test_channel_in_another_unit_is_left_out_and_named(write_log):
    path = write_log()
    with h5py.File(path, "r+") as file:
        file["p_o_kpa"].attrs["units"] = "bar"
    found = salvage(path)
    assert "p_o_kpa" not in found.channels
    assert "p_o_kpa: cannot be read (units are bar, must be kPa)" in found.messages


def test_channel_without_a_unit_is_kept_and_reported(write_log):
    path = write_log()
    with h5py.File(path, "r+") as file:
        del file["p_o_kpa"].attrs["units"]
    found = salvage(path)
    assert len(found.channels["p_o_kpa"]) == 400
    assert found.messages == ["p_o_kpa: attribute units: not found; assumed to be kPa"]


def test_lost_attribute_is_named(write_log):
    path = write_log()
    with h5py.File(path, "r+") as file:
        del file.attrs["seed"]
    assert salvage(path).messages == ["attributes seed: not found"]


def old_log(path, **attributes):
    """Write a log as other programs do: variable-length text, no checksum."""
    with h5py.File(path, "w") as file:
        file.attrs.update(attributes)
        for name in RAW_CHANNELS:
            file[name] = np.arange(400.0)
            file[name].attrs["units"] = unit_of(name)
    return path


def test_text_that_is_not_utf_8_is_replaced_and_reported(tmp_path):
    broken = np.bytes_(b"LabVIEW \xb5")
    found = salvage(old_log(tmp_path / "log.h5", software=broken, operator=broken, seed=3))
    assert found.attributes == {"software": "LabVIEW �", "operator": "LabVIEW �", "seed": 3}
    assert "attribute software: bytes that were not UTF-8 are replaced" in found.messages
    assert "attribute operator: bytes that were not UTF-8 are replaced" in found.messages


@pytest.mark.parametrize(
    ("name", "value"),
    [("statistics", 5), ("notes", "{"), ("sample_rate_hz", np.inf), ("seed", "one"), ("rig", "[]")],
)
def test_attribute_that_is_not_of_its_kind_is_left_out_and_reported(tmp_path, name, value):
    found = salvage(old_log(tmp_path / "log.h5", **{"software": "x", name: value}))
    assert found.attributes == {"software": "x"}
    assert any(word.startswith(f"attribute {name}: left out (= ") for word in found.messages)


def test_name_that_is_not_utf_8_is_left_out_and_reported(tmp_path):
    path = old_log(tmp_path / "log.h5")
    with h5py.File(path, "r+") as file:
        h5py.h5d.create(file.id, b"p\xe9_kpa", h5py.h5t.IEEE_F64LE, h5py.h5s.create_simple((400,)))
    found = salvage(path)
    assert set(found.channels) == set(RAW_CHANNELS)
    assert r"p\udce9_kpa: cannot be read (its name is not UTF-8)" in found.messages


def test_channel_whose_checksum_is_wrong_is_kept_and_reported(write_log):
    path = write_log()
    with h5py.File(path) as file:
        at = file["p_o_kpa"].id.get_offset()
    data = bytearray(path.read_bytes())
    data[at + 3] ^= 1
    path.write_bytes(data)
    found = salvage(path)
    assert found.messages == ["p_o_kpa: its checksum is wrong; some of its numbers may be wrong"]
    assert set(found.channels) == set(RAW_CHANNELS)
    assert found.lost == 0


def test_attributes_with_a_wrong_byte_are_named(write_log):
    path = write_log(controller="pd")
    data = path.read_bytes()
    path.write_bytes(data.replace(b"fprc test", b"fprc tesu"))
    with pytest.raises(LogError, match="cannot be read as HDF5"):
        read_columns(path, ())
    found = salvage(path)
    assert found.attributes["software"] == "fprc tesu"
    (doubtful,) = [word for word in found.messages if word.endswith(": may be wrong")]
    assert {"software", "controller", "rig"} <= set(doubtful[11:-14].split(", "))
    (lost,) = [word for word in found.messages if word.endswith(": lost if the file had them")]
    assert {"gain", "notes", "started"} <= set(lost[11:-25].split(", "))
    assert "controller" not in lost


def test_dataset_without_the_name_of_a_channel_is_left_out_and_reported(write_log):
    path = write_log()
    with h5py.File(path, "r+") as file:
        file["picture"] = np.zeros(400)
    found = salvage(path)
    assert "picture" not in found.channels
    assert any(
        "picture: cannot be read (channel picture: its name" in one for one in found.messages
    )


def test_more_datasets_than_a_log_has_are_left_out_and_counted(write_log):
    path = write_log()
    with h5py.File(path, "r+") as file:
        for number in range(130):
            file[f"a{number}_kpa"] = np.zeros(1)
    found = salvage(path)
    assert set(found.channels) == set(RAW_CHANNELS)
    assert "30 channels left out: too many channels" in found.messages


def test_pipe_is_refused_at_once(tmp_path):
    os.mkfifo(tmp_path / "log.h5")
    with pytest.raises(LogError, match=r"log\.h5: cannot be opened \(not a regular file\)"):
        salvage(tmp_path / "log.h5")


#: Child process that hangs when it reads the ninth channel of a log.
STUCK = """
import sys, time
from pathlib import Path
import fprc.logs.salvage as module
values = module._values
def stuck(file, name, *rest):
    if name == "valve_main_v":
        print("stuck", flush=True)
        time.sleep(600.0)
    return values(file, name, *rest)
module._values = stuck
module._export(Path(sys.argv[1]), Path(sys.argv[2]))
"""


def test_reading_that_hangs_is_stopped_and_the_channels_read_are_kept(write_log, monkeypatch):
    path = write_log()

    def run(command, *, timeout, **options):
        assert timeout > 5.0
        child = subprocess.Popen(
            [sys.executable, "-c", STUCK, *command[-2:]], stdout=subprocess.PIPE, text=True
        )
        with child:
            assert child.stdout.readline() == "stuck\n"
            child.kill()
        raise subprocess.TimeoutExpired(command, timeout)

    monkeypatch.setattr(module.subprocess, "run", run)
    found = salvage(path, limit_s=5.0)
    assert "reading ended early: not read within 5 s" in found.messages
    assert set(found.channels) == set(RAW_CHANNELS) - {"valve_main_v", "valve_reservoir_v"}


def test_reading_that_ends_the_process_is_reported(write_log, monkeypatch):
    path = write_log()
    run = module.subprocess.run
    crash = "import os, signal; os.kill(os.getpid(), signal.SIGKILL)"
    monkeypatch.setattr(
        module.subprocess,
        "run",
        lambda command, **options: run([sys.executable, "-c", crash], **options),
    )
    with pytest.raises(LogError) as caught:
        salvage(path)
    assert "reading ended early: cannot be read (the library crashed)" in str(caught.value)


def test_any_damage_ends_in_a_copy_or_an_error(write_log):
    """Bytes changed at random in the metadata of the channels."""
    path = write_log()
    whole = path.read_bytes()
    rng = np.random.default_rng(0)
    for _ in range(4):
        data = bytearray(whole)
        for at in rng.integers(8, 2000, size=20):
            data[at] ^= int(rng.integers(1, 256))
        path.write_bytes(data)
        try:
            found = salvage(path, limit_s=10.0)
        except LogError as error:
            outcome = str(error)
        else:
            outcome = "\n".join(found.messages)
            assert len({len(values) for values in found.channels.values()}) == 1
        assert "no sample can be read" in outcome or "lost" in outcome or "not found" in outcome
