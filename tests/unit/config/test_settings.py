import pytest
from pydantic import BaseModel, ValidationError

from fprc.config import Settings, check
from fprc.config.section import Section
from fprc.errors import ConfigError


def sections(model=Settings):
    """Yield every section, found by its annotations."""
    yield model
    for field in model.model_fields.values():
        if isinstance(field.annotation, type) and issubclass(field.annotation, BaseModel):
            yield from sections(field.annotation)


#: Chamber loops and the like occur twice; one of each is enough.
SECTIONS = list(dict.fromkeys(sections()))


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


def test_defaults_are_the_numbers_of_the_paper():
    settings = Settings()
    assert settings.control.sample_rate_hz == 200
    assert settings.control.k_in_kpa_per_deg == 7.0
    assert settings.control.reservoir_limit_kpa == 450
    assert settings.control.main_loop.kp_v_per_kpa == 0.03
    assert settings.control.reservoir_loop.kp_v_per_kpa == 0.05
    assert settings.control.main_loop.ki_v_per_kpa_s == 1e-6
    assert settings.control.reservoir_loop.ki_v_per_kpa_s == 1e-6
    assert settings.experiments.complex.f_hz == (0.12, 0.04, 0.31, 0.29, 0.25)
    assert (settings.models.n_y, settings.models.alpha) == (5, 1e-3)
    esn, fprc = settings.models.esn, settings.models.fprc
    assert (esn.r, esn.f_input, esn.gamma, esn.rho, esn.washout) == (800, 0.02, 0.8, 0.4, 100)
    assert (fprc.epsilon, fprc.n_c, fprc.n_u, fprc.sigma) == (0.01, 8, 3, 2.0)
    assert (settings.evaluation.folds, settings.evaluation.timing_repeats) == (5, 10)
    assert settings.rig.reservoir.precharge_kpa == 100


@pytest.mark.parametrize("section", SECTIONS, ids=lambda section: section.__name__)
def test_every_section_is_frozen_documented_and_closed(section):
    assert issubclass(section, Section)
    assert section.__doc__ != Section.__doc__
    assert section.model_config["extra"] == "forbid"
    with pytest.raises(ValidationError):
        setattr(section(), next(iter(section.model_fields)), 1)


@pytest.mark.parametrize("section", SECTIONS, ids=lambda section: section.__name__)
def test_every_number_has_unit_range_and_meaning(section):
    for name, schema in section.model_json_schema()["properties"].items():
        if schema.get("type") in ("number", "integer"):
            assert schema["unit"], name
            assert schema["minimum"] < schema["maximum"], name
            assert schema["minimum"] <= schema["default"] <= schema["maximum"], name
            assert schema["description"], name


NAN, INFINITY = float("nan"), float("inf")
NO_NUMBER = "must be a number or a text, not true/false"
REFUSED = [
    ("seed", -1, "greater than or equal to 0"),
    ("seed", True, NO_NUMBER),
    ("models.alpha", False, NO_NUMBER),
    ("models.alpha", NAN, ""),
    ("models.fprc.n_c", 0, "greater than or equal to 1"),
    ("models.fprc.n_c", 1.5, ""),
    ("models.fprc.n_c", "many", ""),
    ("models.fprc.n_c", None, ""),
    ("models.fprc.n_c", [1], ""),
    ("models.esn.gamma", 1.0, "less than or equal to 0.9999"),
    ("control.sample_rate_hz", 10, "greater than or equal to 50"),
    ("experiments.complex.f_hz", [0.1, 20.0], "less than or equal to 10"),
    ("experiments.complex.f_hz", [], "at least 1 item"),
    ("experiments.complex.f_hz", [0.2, NAN], ""),
    ("experiments.complex.f_hz", [True], ""),
    ("experiments.sweep.duration_s", INFINITY, ""),
    ("experiments.sweep.form", "sine", "'chirp'"),
    ("rig.valve.leak", -INFINITY, ""),
    ("rig.bending.slip_distance_deg", [1, 3, 7, 0], "greater than or equal to 0.1"),
    ("rig.bending.relaxation_time_s", [0.2, NAN], ""),
    ("rig.reservoir.slip_weight", [0.2, NAN], ""),
    ("quality.pressure_range_kpa", [0.0, 2000.0], "less than or equal to 1000"),
    ("quality.pressure_range_kpa", [0.2, NAN], ""),
    ("quality.pressure_range_kpa", [100.0, -20.0], ""),
    ("quality.angle_range_deg", [100.0, -20.0], ""),
    ("evaluation.split", "random", "'shuffled' or 'blocked'"),
    ("evaluation.split", True, NO_NUMBER),
    ("evaluation.replicate_seeds", [True, False], ""),
    ("evaluation.replicate_seeds", [-1, 2], ""),
    ("evaluation.replicate_seeds", [101, 101], ""),
    ("evaluation.replicate_seeds", [101], ""),
    ("calibration.taps", [3, 3], ""),  # over equal sizes no trend can be measured
    ("folders.results", True, NO_NUMBER),
    ("source", "real", "'sim'"),
]


@pytest.mark.parametrize(("key", "value", "limit"), REFUSED)
def test_value_that_makes_no_sense_is_refused_by_its_key_and_limit(key, value, limit):
    message = refused(key, value)
    assert key in message
    assert limit in message


@pytest.mark.parametrize(
    ("key", "pair"),
    [
        ("rig.bending.slip_weight", "slip_distance_deg"),
        ("rig.bending.relaxation_time_s", "relaxation_stiffness_kpa_per_deg"),
        ("rig.reservoir.slip_weight", "slip_distance_ml"),
    ],
)
def test_lists_that_belong_together_have_the_same_length(key, pair):
    message = refused(key, [1.0])
    assert key.rpartition(".")[0] in message
    assert pair in message
    assert "same length" in message


@pytest.mark.parametrize("key", ["rig.bending.slip_weight", "rig.reservoir.slip_weight"])
def test_weights_sum_to_one(key):
    elements = len(value_at(Settings(), key))
    assert "make it sum to 1" in refused(key, [0.5] * elements)
    weights = [0.0] * (elements - 1) + [1.0]
    assert value_at(check(set_to(key, weights)), key) == tuple(weights)


@pytest.mark.parametrize("experiment", ["sweep", "complex"])
def test_log_too_short_to_train_on_is_refused(experiment):
    config = {
        "control": {"sample_rate_hz": 50},
        "experiments": {experiment: {"duration_s": 1}},
        "models": {"fprc": {"n_c": 64}},
    }
    with pytest.raises(ConfigError, match=rf"experiments\.{experiment}.*n_c = 64") as caught:
        check(config)
    assert "duration_s" in str(caught.value)
    config["experiments"][experiment]["duration_s"] = 2
    assert check(config).models.fprc.n_c == 64


@pytest.mark.parametrize(
    "models",
    [{"fprc": {"n_u": 100}}, {"n_y": 100}],
)
def test_taps_must_fit_into_the_log(models):
    config = {
        "control": {"sample_rate_hz": 50},
        "experiments": {"sweep": {"duration_s": 2}},
        "models": models,
    }
    with pytest.raises(ConfigError, match=r"experiments\.sweep.* = 100"):
        check(config)


def test_scikit_fuzzy_is_refused_where_it_is_not_installed(monkeypatch):
    assert check(set_to("models.fprc.clustering", "scikit-fuzzy")).models.fprc.restarts == 1
    monkeypatch.setattr("fprc.config.models.find_spec", lambda name: None)
    message = refused("models.fprc.clustering", "scikit-fuzzy")
    assert "models.fprc.clustering" in message
    assert "pip install scikit-fuzzy" in message
