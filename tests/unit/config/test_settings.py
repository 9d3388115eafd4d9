import re
from functools import reduce

import pytest

from fprc.config import Settings, check
from fprc.config.section import fields, limits_of, section_of
from fprc.errors import ConfigError


def sections(model=Settings):
    """Yield every section, found by its annotations."""
    yield model
    for inner in map(section_of, model.model_fields.values()):
        if inner:
            yield from sections(inner)


#: Chamber loops and the like occur twice; one of each is enough.
SECTIONS = list(dict.fromkeys(sections()))
#: Range and default of every setting that has a range.
RANGES = {key: (limits_of(field), default) for key, default, field, _ in fields(Settings)
          if limits_of(field)}  # fmt: skip


def set_to(key, value):
    config = value
    for name in reversed(key.split(".")):
        config = {name: config}
    return config


def refused(key, value):
    with pytest.raises(ConfigError) as caught:
        check(set_to(key, value))
    return str(caught.value)


def value_at(settings, key):
    for name in key.split("."):
        settings = getattr(settings, name)
    return settings


@pytest.mark.parametrize("written", ["out/", "./out", "out//", "out"])
def test_folder_has_one_name_however_it_is_written(written):
    assert Settings(folders={"results": written}).folders.results == "out"


@pytest.mark.parametrize("section", SECTIONS, ids=lambda section: section.__name__)
def test_every_number_has_range_and_meaning(section):
    for name, schema in section.model_json_schema()["properties"].items():
        if schema.get("type") in ("number", "integer"):
            low, high = limits_of(section.model_fields[name])[:2]
            assert low <= schema["default"] <= high, name
            assert schema["description"], name


@pytest.fixture(scope="module")
def refusals():
    """Lines of the refusal of numbers that are all below their ranges, and all above them."""
    found = []
    for side, step in enumerate((-1, 1)):
        config = {}
        for key, (limits, default) in RANGES.items():
            *sections, last = key.split(".")
            end = limits[side]
            number = 2.0 * end if abs(end) > 2**53 else end + step
            section = reduce(lambda inner, name: inner.setdefault(name, {}), sections, config)
            section[last] = [number, number] if isinstance(default, tuple) else number
        with pytest.raises(ConfigError) as caught:
            check(config)
        found.append(str(caught.value).splitlines())
    return found


@pytest.mark.parametrize("key", RANGES)
def test_number_beyond_either_end_of_its_range_is_refused(refusals, key):
    for lines, limit in zip(refusals, RANGES[key][0][:2], strict=True):
        own = [line for line in lines if re.match(rf"  {re.escape(key)}(\.\d+)? = ", line)]
        ends = re.findall(r"(?:equal to|greater than|less than) ([-+.\w]*\d)", " ".join(own))
        assert set(map(float, ends)) == {limit}


NAN, INFINITY = float("nan"), float("inf")


@pytest.mark.parametrize(
    ("key", "value", "place"),
    [("seed", True, ""), ("models.alpha", False, ""), ("models.alpha", NAN, ""),
     ("models.fprc.n_c", 1.5, ""), ("control.main_loop.kp_v_per_kpa", 0.0, ""),
     ("control.reservoir_loop.kp_v_per_kpa", -0.03, ""), ("models.fprc.n_c", "many", ""),
     ("models.fprc.n_c", None, ""), ("models.fprc.n_c", [1], ""),
     ("experiments.complex.f_hz", [], ""), ("experiments.complex.f_hz", [0.2, NAN], ".1"),
     ("experiments.complex.f_hz", [True], ""), ("experiments.sweep.duration_s", INFINITY, ""),
     ("experiments.sweep.form", "sine", ""), ("rig.valve.leak", -INFINITY, ""),
     ("rig.reservoir.slip_weight", [0.2, NAN], ".1"),
     ("quality.pressure_range_kpa", [0.2, NAN], ".1"),
     ("quality.pressure_range_kpa", [100.0, -20.0], ""), ("evaluation.split", "random", ""),
     ("evaluation.split", True, ""), ("evaluation.replicate_seeds", [True, False], ""),
     ("evaluation.replicate_seeds", [101, 101], ""), ("evaluation.replicate_seeds", [101], ""),
     ("evaluation.replicate_seeds", [101, 442], ""), ("calibration.free", ["valve.leak"], ""),
     ("calibration.fit", [], ""), ("folders.results", True, ""), ("source", "real", ""),
     ("models", 3, ""), ("models", "all", ""), ("models", [1, 2], ""), ("models", None, ""),
     ("rig", 3, ""), ("rig", True, ""), ("rig", ["dry"], ""), ("fitted.name", "my rig", ""),
     ("calibration.seeds", 0, ""), ("calibration.members", 5, ""),
     ("calibration.rounds", [50], ""), ("evaluation.replicate_seeds", [101, 1_000_000], ""),
     ("quality.pressure_range_kpa", [], ""), ("tracking.angle_range_deg", [1], ""),
     ("models.others.mine", {"estimator": 5, "inputs": ["theta_deg"]}, ".estimator"),
     ("models.others.mine", {"estimator": "a.B", "inputs": ["p_o_kpa"]}, ".inputs"),
     ("models.others.mine", {"estimator": "a.B", "inputs": "theta_deg"}, ".inputs"),
     ("models.others.mine", {"inputs": ["theta_deg"]}, ".estimator"),
     ("models.others.mine", {"estimator": "a.B", "settings": {"a": [1]}}, ".settings.a"),
     ("models.others.mine", {"estimator": "a.B", "settings": {"a": None}}, ".settings.a"),
     ("models.others.mine", {"estimator": "a.B", "settings": {"a": NAN}}, ".settings.a")],
)  # fmt: skip
def test_value_that_makes_no_sense_is_one_error_at_its_key(key, value, place):
    _, line = refused(key, value).splitlines()
    assert line.startswith((f"  {key}{place} = ", f"  {key}{place}: "))


@pytest.mark.parametrize(
    ("key", "value"),
    [("experiments.sweep.offset_kpa", 174.0), ("experiments.sweep.offset_kpa", 276.0),
     ("experiments.complex.amplitude_kpa", 35.1), ("tracking.pressure_limit_kpa", 349.0)],
)  # fmt: skip
def test_command_below_zero_or_beyond_the_limit_is_refused(key, value):
    message = refused(key, value)
    assert "experiments." in message
    assert "tracking.pressure_limit_kpa" in message


@pytest.mark.parametrize("signal", ["experiments.sweep", "tracking.references.sweep"])
def test_chirp_has_a_first_and_a_last_frequency(signal):
    assert f"  {signal}: " in refused(f"{signal}.f_hz", [0.1])


@pytest.mark.parametrize(
    ("key", "pair"),
    [("rig.bending.slip_weight", "slip_distance_deg"),
     ("rig.bending.relaxation_time_s", "relaxation_stiffness_kpa_per_deg"),
     ("rig.reservoir.slip_weight", "slip_distance_ml")],
)  # fmt: skip
def test_lists_that_belong_together_have_the_same_length(key, pair):
    message = refused(key, [1.0])
    assert key.rpartition(".")[0] in message
    assert pair in message


@pytest.mark.parametrize("key", ["rig.bending.slip_weight", "rig.reservoir.slip_weight"])
def test_weights_sum_to_one(key):
    elements = len(value_at(Settings(), key))
    assert "slip_weight" in refused(key, [0.5] * elements)
    weights = [0.0] * (elements - 1) + [1.0]
    assert value_at(check(set_to(key, weights)), key) == tuple(weights)
