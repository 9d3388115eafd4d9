"""Valid attributes are read back, and invalid ones are refused."""

import json

import h5py
import numpy as np
import pytest

from fprc.errors import LogError
from fprc.logs import read_columns, write_columns
from fprc.logs.attributes import KINDS


@pytest.fixture
def attributes_of(tmp_path):
    """Write attributes as another program would, and read them."""

    def read(attributes):
        path = tmp_path / "log.h5"
        with h5py.File(path, "w") as file:
            for name, value in attributes.items():
                file.attrs[name] = value
        return read_columns(path, ()).attributes

    return read


def read_back(folder, attributes):
    write_columns(folder / "any.h5", {}, attributes)
    return read_columns(folder / "any.h5", ()).attributes


def test_name_of_a_file_that_is_not_utf8_is_written_with_escapes(tmp_path):
    """Else a run could not be converted to a log."""
    back = read_back(tmp_path, {"model_file": "mod\udce9le.h5"})
    assert back == {"model_file": r"mod\udce9le.h5"}


def test_attributes_come_back_as_they_were(tmp_path):
    attributes = {
        "experiment": "Zoë\t\n\U0001f321",
        "complete": False,
        "seed": -(2**63),
        "settle_s": 5e-324,
        "rig": {"": [1, None, {"θ": 'a"b'}], "b": True, "c": -0.5},
        "notes": {"theta_deg": "°"},
        "of_someone_else": 1e300,
    }
    back = read_back(tmp_path, attributes)
    assert back == attributes
    assert {name: type(value) for name, value in back.items()} == {
        name: type(value) for name, value in attributes.items()
    }


@pytest.mark.parametrize("length", [0, 1, 60_000, 200_000])
def test_text_of_any_length_comes_back(tmp_path, length):
    """More than 64 kB do not fit into the file's header."""
    assert read_back(tmp_path, {"software": "ö" * length}) == {"software": "ö" * length}


def test_number_that_is_none_is_null_in_json(tmp_path):
    attributes = {"statistics": {"jitter_s": float("nan"), "late_s": [float("inf"), 1.0]}}
    nulls = {"jitter_s": None, "late_s": [None, 1.0]}
    assert read_back(tmp_path, attributes) == {"statistics": nulls}


WRONG = {
    "experiment": [3, np.bytes_(b"swe\xff\xfep")],
    "source": [1, np.bytes_(b"\xff"), ["sim", "rig"]],
    "complete": ["no", 5, "false", [True, False]],
    "incomplete_reason": [5, np.bytes_(b"\xff\xfe")],
    "software": [np.bytes_(b"LabVIEW \xb5"), ["a", "b"], h5py.Empty("f8")],
    "sample_rate_hz": [np.inf, np.nan, "200", True],
    "settle_s": [-np.inf],
    "seed": [1.5, True],
    "lost_samples": ["3", 1.5, np.nan],
    "rig": ["{", "[1, 2]", "[" * 100_000, '{"a": NaN}', '{"a": 1e999}', '{"a": "\\udce9"}'],
    "statistics": [5, "5", "[1]", "{", "NaN", '"x"', '{"overruns": NaN}', np.arange(3)],
    "notes": ["{", "null", "[" * 3000, '{"theta_deg": 5}', '{"p_o_kpa": null}'],
    "map": ["null"],
}


@pytest.mark.parametrize("name", WRONG)
def test_attribute_that_is_not_of_its_kind_is_named(attributes_of, name):
    for value in WRONG[name]:
        with pytest.raises(LogError, match=rf"log\.h5: attribute {name}( =|: )") as caught:
            attributes_of({name: value})
        assert len(str(caught.value)) < 400


def test_every_kind_is_refused_at_once(attributes_of):
    values = {str: 1.0, bool: "x", float: "x", int: "x", dict: "x"}
    attributes = {name: values[kind] for name, kind in KINDS.items()}
    with pytest.raises(LogError) as caught:
        attributes_of(attributes)
    assert len(str(caught.value).splitlines()) == len(KINDS)


def test_attributes_of_other_programs_are_kept_where_they_are_plain_and_else_left_out(
    attributes_of,
):
    attributes = {"operator": "Zoë", "room_deg": 21.5, "temperature": np.nan, "matrix": np.eye(3)}
    assert attributes_of(attributes) == {"operator": "Zoë", "room_deg": 21.5}


def test_text_of_a_fixed_length_is_understood(attributes_of):
    attributes = {"source": np.bytes_("rig"), "notes": np.bytes_(json.dumps({"theta_deg": "°"}))}
    assert attributes_of(attributes) == {"source": "rig", "notes": {"theta_deg": "°"}}
