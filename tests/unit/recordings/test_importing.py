import pytest
import yaml

from fprc.channels import CHANNELS
from fprc.errors import ConfigError
from fprc.recordings.importing import Channels, Draft, read_map

SMALL = {
    "experiment": "sweep",
    "time": {"column": "t"},
    "channels": {
        "theta_deg": {"column": "angle", "unit": "deg"},
        "p_exp_kpa": {"column": "P", "unit": "bar"},
    },
}


@pytest.fixture
def read(tmp_path):
    def read(content, *kind):
        path = tmp_path / "map.yaml"
        path.write_text(content if isinstance(content, str) else yaml.safe_dump(content))
        return read_map(path, *kind)

    return read


def with_channel(name, **column):
    return SMALL | {"channels": SMALL["channels"] | {name: column}}


def test_map_has_every_channel_of_a_raw_log():
    kinds = ("command", "sensor", "valve")
    assert list(Channels.model_fields) == [c.name for c in CHANNELS if c.kind in kinds]


def test_small_map_has_defaults_and_numbers_of_yaml_serve_as_names(read):
    given_map = read(with_channel("p_o_kpa", column=3, unit=1, note="force [N]"))
    assert (given_map.sample_rate_hz, given_map.start_s, given_map.end_s) == (None, 0.0, None)
    assert (given_map.time.unit, given_map.channels.theta_deg.scale) == ("s", 1.0)
    assert given_map.columns["p_o_kpa"]["column"] == "3"
    assert given_map.notes == {"p_o_kpa": "not in kPa: force [N]"}
    assert given_map.target("command") == "measured"


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (SMALL | {"sample_rate": 100}, "sample_rate: unknown key; did you mean sample_rate_hz?"),
        (
            with_channel("p_o_kpa", column="P", unit="kPa", ofset=1),
            "channels.p_o_kpa.ofset: unknown key; did you mean channels.p_o_kpa.offset?",
        ),
        (with_channel("p_o_kpa", column="P", unit="deg"), "channels.p_o_kpa: unit deg is none"),
        (with_channel("p_o_kpa", column="P", unit="1"), "channels.p_o_kpa: unit 1 stands for"),
        (with_channel("p_o_kpa", column="P"), "channels.p_o_kpa.unit: missing"),
        (SMALL | {"time": {"rate_hz": "?"}}, "time.rate_hz = ?: the draft did not find it"),
        (with_channel("p_o_kpa", column="?", unit="kPa"), "p_o_kpa.column = ?: the draft did"),
        (SMALL | {"experiment": "swep"}, "experiment = swep: must be 'sweep' or 'complex'"),
        (SMALL | {"time": {}}, "time: give either column (with its unit) or rate_hz"),
        (
            SMALL | {"channels": {"theta_deg": SMALL["channels"]["theta_deg"]}},
            "channels: p_exp_kpa or p_exp_command_kpa is missing",
        ),
        ("", "channels: missing"),
    ],
)
def test_error_names_place_value_and_remedy(read, content, message):
    with pytest.raises(ConfigError) as caught:
        read(content)
    assert message in str(caught.value)


def test_all_errors_are_told_at_once(read):
    channels = {"theta_deg": {"column": "x", "unit": "kPa"}, "p_exp": {}}
    with pytest.raises(ConfigError) as caught:
        read({"experiment": "swep", "rate": 1, "channels": channels})
    first, *lines = str(caught.value).splitlines()
    assert first.endswith("5 errors in the map:")
    for part in ("experiment", "rate", "time", "channels.theta_deg", "channels.p_exp"):
        assert sum(line.startswith(f"  {part}") for line in lines) == 1


def test_format_of_the_text_is_read_from_a_map_that_is_not_complete(read):
    assert read({"time": 5, "csv": {"decimal": ","}}, Draft).csv.decimal == ","
    with pytest.raises(ConfigError, match=r"map\.yaml: 1 error in the map:\n  csv\.decimal = ;"):
        read({"csv": {"decimal": ";"}}, Draft)
