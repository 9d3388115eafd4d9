import re
from functools import reduce

import pytest

from fprc.config import Settings, check
from fprc.config.rig import squeeze_lag
from fprc.config.section import fields, limit_of
from fprc.errors import ConfigError

#: Range and default of every setting that has a range.
RANGES = {key: (limit_of(field), default) for key, default, field, _ in fields(Settings)
          if limit_of(field)}  # fmt: skip


def set_to(key, value):
    config = value
    for name in reversed(key.split(".")):
        config = {name: config}
    return config


def refused(key, value):
    with pytest.raises(ConfigError) as caught:
        check(set_to(key, value))
    return str(caught.value)


def test_every_number_has_range_and_meaning():
    for key, default, field, _ in fields(Settings):
        assert field.description, key
        assert limit_of(field) or type(default) not in (int, float), key


def test_number_beyond_either_end_of_its_range_is_refused():
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
        for key, (limits, _) in RANGES.items():
            own = re.findall(
                rf"^  {re.escape(key)}(?:\.\d+)? = .*", str(caught.value), re.MULTILINE
            )
            ends = re.findall(r"(?:equal to|greater than|less than) ([-+.\w]*\d)", " ".join(own))
            assert set(map(float, ends)) == {limits[side]}, key


NAN, INFINITY = float("nan"), float("inf")


@pytest.mark.parametrize(
    ("key", "value", "place"),
    [("seed", True, ""), ("models.alpha", NAN, ""), ("models.fprc.n_c", 1.5, ""),
     ("control.main_loop.kp_v_per_kpa", 0.0, ""), ("models.fprc.n_c", "many", ""),
     ("models.fprc.n_c", None, ""), ("experiments.complex.f_hz", [], ""),
     ("experiments.complex.f_hz", [0.2, NAN], ".1"), ("experiments.complex.f_hz", [True], ""),
     ("experiments.sweep.duration_s", INFINITY, ""), ("experiments.sweep.form", "sine", ""),
     ("quality.pressure_range_kpa", [100.0, -20.0], ""), ("evaluation.split", True, ""),
     ("evaluation.replicate_seeds", [101, 101], ""), ("evaluation.replicate_seeds", [101], ""),
     ("grids.epsilon", [0.1, 0.01, 0.01], ""), ("grids.n_u", [1, 2], ""),
     ("calibration.free", ["valve.leak"], ""),
     ("evaluation.replicate_seeds", [101, 1_000_000], ""), ("calibration.fit", [], ""),
     ("source", "real", ""),
     ("control.feedforward.kpa_per_deg", 100.0, ""), ("control.feedforward.prior_s", 0.05, ""),
     ("control.feedforward.limit_kpa", 501.0, ""),
     ("models", 3, ""), ("models", None, ""), ("rig", ["dry"], ""),
     ("models.others.mine", {"estimator": 5, "inputs": ["theta_deg"]}, ".estimator"),
     ("models.others.mine", {"estimator": "a.B", "inputs": ["p_o_kpa"]}, ".inputs"),
     ("models.others.mine", {"inputs": ["theta_deg"]}, ".estimator"),
     ("models.others.mine", {"estimator": "a.B", "settings": {"a": [1]}}, ".settings.a"),
     ("models.others.mine", {"estimator": "a.B", "settings": {"a": NAN}}, ".settings.a")],
)  # fmt: skip
def test_value_that_makes_no_sense_is_one_error_at_its_key(key, value, place):
    _, line = refused(key, value).splitlines()
    assert line.startswith((f"  {key}{place} = ", f"  {key}{place}: "))


@pytest.mark.parametrize(
    ("key", "value", "named"),
    [("experiments.sweep.offset_kpa", 174.0, "tracking.pressure_limit_kpa"),
     ("experiments.complex.amplitude_kpa", 35.1, "experiments.complex"),
     ("tracking.pressure_limit_kpa", 349.0, "experiments.sweep"),
     ("tracking.pushes.quiet_s", 3.0, "settle_s"), ("tracking.pushes.quiet_s", 46.0, "settle_s"),
     ("experiments.sweep.f_hz", [0.1], "experiments.sweep: "),
     ("tracking.references.sweep.f_hz", [0.1], "tracking.references.sweep: "),
     ("rig.bending.slip_weight", [1.0], "slip_distance_deg"),
     ("rig.bending.relaxation_time_s", [1.0], "relaxation_stiffness_kpa_per_deg"),
     ("rig.reservoir.slip_weight", [1.0], "slip_distance_ml"),
     ("rig.bending.slip_weight", [0.5] * 4, "must be 1"),
     ("rig.reservoir.squeeze_damping_kpa_s_per_ml", 5.0, "lags by 0."),
     ("rig.reservoir.slip_distance_ml", [0.01, 0.5, 1.2], "step_s")],
)  # fmt: skip
def test_values_that_do_not_go_together_are_refused(key, value, named):
    assert named in refused(key, value)


def test_unsafe_values_are_refused_beside_other_errors():
    limits, theta = {"p_exp_kpa": [10.0, 400.0], "stale_s": 99.0}, {"gain": 0.05, "bus": 99}
    assert len(refused("hardware", {"limits": limits, "theta": theta}).splitlines()) == 5


def test_seeds_that_a_fit_saw_judge_no_claim():
    with pytest.raises(ConfigError, match="21"):
        check({"rig": "dry", "evaluation": {"replicate_seeds": [101, 21]}})


def test_squeeze_lags_by_its_damping_over_its_stiffness():
    of = {"squeeze_damping_kpa_s_per_ml": 0.9, "squeeze_stiffness_kpa_per_ml": 20.0,
          "back_pressure_gain": 1.5, "passive_volume_ml": 50.0, "precharge_kpa": 100.0}  # fmt: skip
    gas_kpa_per_ml = (100.0 + 101.325) / 50.0
    lag = squeeze_lag(check({"rig": {"reservoir": of}}).rig.model_dump())
    assert lag == pytest.approx(0.9 / (20.0 + 1.5 * gas_kpa_per_ml), rel=1e-3)


@pytest.mark.parametrize(
    ("hardware", "place", "what"),
    [
        # a vent voltage that does not open the valve to the atmosphere
        ({"valves": {"neutral_v": 5.0, "vent_v": 5.0}}, "valves", "vent_v"),
        ({"valves": {"neutral_v": 4.5, "vent_v": 2.6}}, "valves", "vent_v"),
        # limits that leave out a vented chamber
        ({"limits": {"p_exp_kpa": (0.0, 400.0)}}, "limits.p_exp_kpa", "(0.0, 400.0)"),
        ({"limits": {"p_i_kpa": (-90.0, -10.0)}}, "limits.p_i_kpa", "begin below 0"),
        # a sensor that would hide a fault
        ({"p_exp": {"zero_v": 0.0}}, "", "p_exp: with a broken cable"),
        ({"p_exp": {"gain_kpa_per_v": 100.0}}, "", "p_exp: at its full 5 V it reads 400"),
        ({"p_o": {"zero_v": 3.5}}, "", "p_o: at its full 5 V"),
        ({"p_exp": {"gain_kpa_per_v": 2.5}}, "p_exp.gain_kpa_per_v", ""),
        ({"theta": {"gain": 0.05}}, "theta.gain", "0.05"),
        ({"phi": {"address": 0x12}}, "", "0x12"),
        # wiring and names
        ({"boards": {"main_output": 5, "heartbeat_output": 5}}, "boards", "output"),
        ({"boards": {"p_i_input": 0}}, "boards", "input"),
        ({"boards": {"input_device": "AIO001"}}, "boards", "AIO001"),
    ],
)
def test_setting_that_makes_no_safe_rig_is_refused(hardware, place, what):
    with pytest.raises(ConfigError) as caught:
        check({"hardware": hardware})
    _, line = str(caught.value).splitlines()
    place = f"hardware.{place}".rstrip(".")
    assert line.startswith((f"  {place}: ", f"  {place} = ", f"  {place}.{what} = "))
    assert what in line
