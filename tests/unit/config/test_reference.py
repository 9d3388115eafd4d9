import json
from functools import cache
from pathlib import Path

import pytest
import yaml

from fprc.config import Settings, reference

ROOT = Path(__file__).parents[3]


#: Settings whose keys are the user's.
MAPPINGS = ("calibration.ranges", "models.others")


def leaves(values, prefix=""):
    for name, value in values.items():
        if isinstance(value, dict) and prefix + name not in MAPPINGS:
            yield from leaves(value, f"{prefix}{name}.")
        else:
            yield prefix + name, value


def as_json(values):
    return json.loads(json.dumps(values))


ACTUAL = dict(leaves(as_json(Settings().model_dump())))


@cache
def lines():
    """Return the lines of the reference page."""
    return reference.reference().splitlines()


def documented():
    """Yield key and cells of every row of the reference page."""
    group = ""
    for line in lines():
        if line.startswith("## "):
            group = "" if line == "## Top level" else line.removeprefix("## ") + "."
        if line.startswith("| `"):
            name, unit, default, limits, meaning, source = (
                cell.strip() for cell in line.strip("|").split(" | ")
            )
            yield group + name.strip("`"), (unit, default.strip("`"), limits, meaning, source)


@pytest.mark.parametrize(
    ("page", "file"),
    [
        (reference.defaults, "config/config.yaml"),
        (reference.schema, "config/schema.json"),
        (reference.reference, "docs/configuration.md"),
    ],
)
def test_generated_file_is_up_to_date(page, file):
    committed = (ROOT / file).read_text(encoding="utf-8")
    assert committed == page(), f"{file} is stale: run `fprc config {page.__name__} > {file}`"


def test_generated_yaml_reads_back_as_the_same_numbers():
    written = dict(leaves(yaml.safe_load(reference.defaults())))
    assert written.pop("rig") == reference.RIG
    left_out = ("rig.", "fitted.", "armed")
    expected = {key: value for key, value in ACTUAL.items() if not key.startswith(left_out)}
    assert written == expected
    for key, value in expected.items():
        assert type(written[key]) is type(value), key


def test_page_documents_every_setting_once():
    keys = [key for key, _ in documented()]
    assert sorted(keys) == sorted(ACTUAL)


def test_page_states_the_actual_default_of_every_setting():
    stated = {key: json.loads(cells[1]) for key, cells in documented()}
    assert stated == ACTUAL


def test_page_gives_unit_range_meaning_and_source_of_every_parameter_of_the_rig():
    for key, (unit, default, limits, meaning, source) in documented():
        if key.startswith("rig."):
            assert unit, key
            assert source, key
            assert meaning, key
            low, _, high = limits.partition(" to ")
            given = json.loads(default)
            for value in given if isinstance(given, list) else [given]:
                assert value in limits.split(" or ") or float(low) <= value <= float(high), key


def test_schema_describes_the_configuration_to_editors():
    schema = json.loads(reference.schema())
    assert set(schema["properties"]) == set(Settings.model_fields)
    assert schema["additionalProperties"] is False
    n_c = schema["$defs"]["Fprc"]["properties"]["n_c"]
    assert (n_c["minimum"], n_c["maximum"], n_c["default"]) == (1, 64, 8)
