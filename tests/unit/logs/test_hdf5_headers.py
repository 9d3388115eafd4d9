import io

import h5py
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fprc.logs.columns import read_columns
from fprc.logs.hdf5_headers import correct_checksums, lookup3
from fprc.logs.salvage import salvage


@pytest.mark.parametrize(
    ("data", "seed", "value"),
    [  # those of lookup3.c
        (b"", 0, 0xDEADBEEF),
        (b"", 0xDEADBEEF, 0xBD5B7DDE),
        (b"Four score and seven years ago", 0, 0x17770551),
        (b"Four score and seven years ago", 1, 0xCD628161),
    ],
)
def test_checksum_is_that_of_its_author(data, seed, value):
    assert lookup3(data, seed) == value


def test_every_checksum_of_a_whole_log_is_right(write_log):
    data = bytearray(write_log().read_bytes())
    before = bytes(data)
    assert correct_checksums(data) == 0
    assert bytes(data) == before


@given(at=st.integers(0, len(b"fprc test") - 1), flip=st.integers(1, 255))
def test_wrong_byte_of_an_attribute_costs_no_channel(whole, at, flip):
    damaged = bytearray(whole.read_bytes())
    damaged[damaged.index(b"fprc test") + at] ^= flip
    with pytest.raises((OSError, KeyError, RuntimeError), match="checksum"):
        names_in(damaged)
    assert correct_checksums(damaged) == 1
    assert "theta_deg" in names_in(damaged)


def names_in(content):
    with h5py.File(io.BytesIO(bytes(content)), "r") as file:
        return list(file)


@given(st.binary(max_size=400))
def test_any_bytes_are_looked_through(data):
    correct_checksums(bytearray(b"OHDR\x02" + data))


@pytest.fixture(scope="module")
def whole(channels, tmp_path_factory):
    from fprc.logs import write_raw

    path = tmp_path_factory.mktemp("whole") / "log.h5"
    described = {"experiment": "sweep", "source": "sim", "sample_rate_hz": 200.0, "seed": 1}
    write_raw(path, channels, **described, software="fprc test", rig={})
    return path


def test_log_with_a_wrong_byte_in_an_attribute_is_salvaged_with_every_channel(tmp_path, whole):
    damaged = bytearray(whole.read_bytes())
    damaged[damaged.index(b"fprc test") + 2] ^= 0x20
    (tmp_path / "log.h5").write_bytes(damaged)
    found = salvage(tmp_path / "log.h5")
    expected = read_columns(whole, tuple(found.channels))
    assert len(found.channels) == 10
    assert all((found.channels[name] == expected.channels[name]).all() for name in found.channels)
    assert any(words.startswith("headers damaged: 1") for words in found.messages)
