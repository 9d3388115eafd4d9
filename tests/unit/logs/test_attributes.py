"""Valid attributes are read back, and invalid ones are refused."""

import json

import h5py
import numpy as np
import pytest

from fprc.errors import LogError
from fprc.logs import read_columns, write_columns


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


#: What is written, and what is read where it differs.
WRITTEN = [
    ({"experiment": "Zoë\t\n\U0001f321", "complete": False, "seed": -(2**63), "settle_s": 5e-324,
      "rig": {"": [1, None, {"θ": 'a"b'}], "b": True, "c": -0.5}, "notes": {"theta_deg": "°"},
      "of_someone_else": 1e300}, None),
    # more than 64 kB do not fit into the file's header
    *(({"software": "ö" * length}, None) for length in (0, 1, 60_000, 200_000)),
    # a name of a file that is not UTF-8; else a run could not become a log
    ({"model_file": "mod\udce9le.h5"}, {"model_file": r"mod\udce9le.h5"}),
    ({"statistics": {"a_s": float("nan"), "b_s": [float("inf"), 1.0]}},
     {"statistics": {"a_s": None, "b_s": [None, 1.0]}}),
]  # fmt: skip


@pytest.mark.parametrize(("attributes", "expected"), WRITTEN)
def test_attributes_come_back_as_they_were(tmp_path, attributes, expected):
    write_columns(tmp_path / "any.h5", {}, attributes)
    back = read_columns(tmp_path / "any.h5", ()).attributes
    assert back == (expected or attributes)
    assert [type(back[name]) for name in attributes] == [*map(type, attributes.values())]


def test_attributes_of_other_programs_are_kept_where_they_are_plain_and_else_left_out(
    attributes_of,
):
    attributes = {"operator": "Zoë", "room_deg": 21.5, "temperature": np.nan, "matrix": np.eye(3)}
    assert attributes_of(attributes) == {"operator": "Zoë", "room_deg": 21.5}
    fixed = {"source": np.bytes_("rig"), "notes": np.bytes_(json.dumps({"theta_deg": "°"}))}
    assert attributes_of(fixed) == {"source": "rig", "notes": {"theta_deg": "°"}}


WRONG = {
    "experiment": [3, b"swe\xe9p", np.bytes_(b"swe\xff\xfep"), ["sim", "rig"], h5py.Empty("f8")],
    "complete": ["no", 5, [True, False]],
    "sample_rate_hz": [np.inf, np.nan, "200", True, 0.0],
    "seed": [1.5, True, "3"],
    "rig": ["{", "[1, 2]", "[" * 100_000, '{"a": NaN}', '{"a": 1e999}', 5, np.arange(3)],
    "notes": ["null", '{"theta_deg": 5}', '{"p_o_kpa": null}'],
}


@pytest.mark.parametrize("name", WRONG)
def test_attribute_that_is_not_of_its_kind_is_named(attributes_of, name):
    for value in WRONG[name]:
        with pytest.raises(LogError, match=rf"log\.h5: attribute {name}: ") as caught:
            attributes_of({name: value})
        assert len(str(caught.value)) < 400
