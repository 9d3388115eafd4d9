import h5py
import numpy as np
import pytest

from fprc.errors import LogError
from fprc.logs import hdf5_source
from fprc.logs.sources import read_arrays
from fprc.logs.variables import pick


@pytest.fixture
def written(tmp_path):
    """Let a function write an HDF5 file, and return the source read from it."""

    def written(write):
        with h5py.File(tmp_path / "log.h5", "w") as file:
            write(file)
        return read_arrays(tmp_path / "log.h5", matlab=False)

    return written


@pytest.mark.parametrize("shape", [(50,), (50, 1), (1, 50)])
def test_rows_and_columns_are_vectors_alike(written, shape):
    source = written(lambda file: file.create_dataset("x", data=np.arange(50.0).reshape(shape)))
    assert pick(source, "x").tolist() == list(range(50))


def test_pictures_texts_and_single_numbers_are_no_channels(written):
    def write(file):
        file["video"] = np.zeros((4, 3, 3))
        file["who"] = "me"
        file["rate"] = 100.0
        file["none"] = h5py.Empty("f8")
        file["no"] = np.zeros(0)
        file["on"] = np.arange(5) > 2
        file["x"] = np.arange(5)

    source = written(write)
    assert list(source.variables) == ["on", "x"]
    assert set(source.others) == {"video", "who", "rate", "none", "no"}


def test_links_are_named_and_not_followed(written, tmp_path):
    with h5py.File(tmp_path / "other.h5", "w") as other:
        other["y"] = np.arange(3.0)

    def write(file):
        file["x"] = np.arange(5.0)
        file["same"] = file["x"]
        file["outside"] = h5py.ExternalLink(str(tmp_path / "other.h5"), "/y")
        file["nowhere"] = h5py.SoftLink("/gone")
        layout = h5py.VirtualLayout((3,), "f8")
        layout[:] = h5py.VirtualSource(tmp_path / "other.h5", "y", (3,))
        file.create_virtual_dataset("virtual", layout)
        file.create_dataset("raw", (3,), "f8", external=[(tmp_path / "x.bin", 0, 24)])

    source = written(write)
    assert list(source.variables) == ["same", "x"]
    assert f"link to {tmp_path / 'other.h5'}, which is not followed" in source.others["outside"]
    assert "link to /gone" in source.others["nowhere"]
    assert "in another file" in source.others["virtual"]
    assert "in another file" in source.others["raw"]


def test_group_that_holds_itself_is_refused(written):
    def write(file):
        file["x"] = np.arange(5.0)
        file["group/again"] = file["/"]

    with pytest.raises(LogError, match="cannot be read as HDF5|more than"):
        written(write)


def test_dataset_that_cannot_be_read_leaves_the_others(written, tmp_path):
    def write(file):
        file["x"] = np.arange(5.0)
        file.create_dataset("bad", data=np.arange(5.0), chunks=(5,), fletcher32=True)

    written(write)
    path = tmp_path / "log.h5"
    with h5py.File(path) as file:
        at = file["bad"].id.get_chunk_info(0).byte_offset
    content = bytearray(path.read_bytes())
    content[at] ^= 1
    path.write_bytes(content)
    source = read_arrays(path, matlab=False)
    assert list(source.variables) == ["x"]
    assert "cannot be read" in source.others["bad"]


# --- sizes ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "declared",
    [
        {"shape": (10**9,), "chunks": (10**6,), "compression": "gzip"},
        {"shape": (10**5, 10**4), "chunks": (100, 100), "fillvalue": 1.0},
        {"shape": (10,), "maxshape": (None,), "chunks": (10**9 // 8,), "compression": "gzip"},
    ],
)
def test_dataset_that_declares_too_much_is_not_read(written, tmp_path, monkeypatch, declared):
    def write(file):
        file["t"] = np.arange(10.0)
        file.create_dataset("x", dtype="f8", **declared)

    monkeypatch.setattr(hdf5_source, "_read", lambda dataset, matlab: np.zeros(dataset.shape))
    source = written(write)
    assert (tmp_path / "log.h5").stat().st_size < 1 << 16
    assert list(source.variables) == ["t"]
    assert "numbers; a file may have 20,000,000" in source.others["x"]


def test_dataset_that_was_never_written_is_no_column(written):
    def write(file):
        file["t"] = np.arange(10.0)
        file.create_dataset("x", shape=(10**6,), dtype="f8")
        file.create_dataset("y", shape=(10, 6), dtype="f8", chunks=(5, 2))[:, :4] = 1.0

    source = written(write)
    assert list(source.variables) == ["t"]
    assert "declares 1,000,000 numbers, but none was written" in source.others["x"]
    assert "60 numbers, but its chunk that begins at [0, 4] was never written" in source.others["y"]


def test_datasets_that_declare_too_much_together_are_not_all_read(written, monkeypatch):
    monkeypatch.setattr(hdf5_source, "MOST_NUMBERS", 25)
    source = written(lambda file: [file.create_dataset(name, data=np.zeros(10)) for name in "abc"])
    assert list(source.variables) == ["a", "b"]
    assert "declares 10 numbers" in source.others["c"]


def test_file_of_too_many_datasets_is_refused_before_they_are_opened(written, monkeypatch):
    monkeypatch.setattr(hdf5_source, "MOST_OBJECTS", 9)
    monkeypatch.setattr(hdf5_source, "_read", None)
    with pytest.raises(LogError, match="more than 9 datasets; save the columns as one matrix"):
        written(lambda file: [file.create_dataset(f"c{k}", data=np.zeros(5)) for k in range(10)])
