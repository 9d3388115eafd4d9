import numpy as np
import pytest

from fprc.channels import Readings
from fprc.config.settings import Control, Feedforward, Gains
from fprc.control import refuse_impossible, run, tracking_law
from fprc.devices.sim import SimulatedRig
from fprc.errors import ControlError
from fprc.models import FPRC, Learning, Online


def reading(theta_deg=0.0, p_o_kpa=50.0):
    return Readings(0.0, 100.0, theta_deg, 120.0, p_o_kpa, 5.0)


class Model:
    """Gives a number, or 5 kPa/deg and P_o."""

    n_features_in_ = 2

    def __init__(self, p_ff=None):
        self.p_ff = p_ff

    def step(self, x):
        return 5.0 * x[0] + x[1] if self.p_ff is None else self.p_ff


def law_of(theta_d, kp=2.0, **options):
    control = Control(
        feedback="positional",
        pd=Gains().changed(kp_kpa_per_deg=kp, kd_kpa_s_per_deg=0.0),
        feedforward=Feedforward(p_o_shift_kpa=1.0),
    )
    return tracking_law(np.asarray(theta_d), control, 450.0, **options)


def test_law_returns_both_setpoints_and_their_parts():
    law = law_of([20.0], model=Model(), feedback=True)
    assert law(0, reading(theta_deg=17.0)) == pytest.approx((157.0, 140.0, 20.0, 151.0, 6.0))


def test_law_without_both_parts_is_refused():
    with pytest.raises(ControlError):
        law_of([20.0])


@pytest.mark.parametrize(
    ("p_ff", "p_d"), [(-80.0, 0.0), (-0.5, 0.0), (449.0, 449.0), (451.0, 450.0), (9e9, 450.0)]
)
def test_sum_is_clipped_and_its_parts_are_remembered_as_they_were(p_ff, p_d):
    found = law_of([20.0], model=Model(p_ff))(0, reading())
    assert found == pytest.approx((p_d, 140.0, 20.0, p_ff, 0.0))


@pytest.mark.parametrize("value", [float("nan"), float("inf"), float("-inf")])
def test_controller_without_a_number_is_refused_and_shown(value):
    feedforward = law_of([20.0], model=Model(value))
    with pytest.raises(ControlError, match=f"P_ff = {value}"):
        feedforward(0, reading())
    feedback = law_of([20.0], kp=value, feedback=True)
    with pytest.raises(ControlError, match=f"P_fb = {value}"):
        feedback(0, reading())


@pytest.mark.parametrize(
    ("theta_d", "limit", "problems"),
    [
        ([10.0, 20.0, -0.25, 10.0, 99.0], 999.0, ["theta_d = -0.25 deg at t = 0.010 s"]),
        ([10.0, 20.0, 65.25, 10.0, -9.0], 999.0, ["theta_d = 65.25 deg at t = 0.010 s"]),
        ([10.0, 64.0, 64.5, 65.0], 450.0, ["P_i = 451.50 kPa at t = 0.010 s"]),
        ([10.0, 64.5, 70.0], 450.0,
         ["theta_d = 70.00 deg at t = 0.010 s", "P_i = 451.50 kPa at t = 0.005 s"]),
    ],
)  # fmt: skip
def test_impossible_reference_is_refused_at_its_first_time_and_value(theta_d, limit, problems):
    control = Control().changed(reservoir_limit_kpa=limit)
    refuse_impossible(np.array([0.0, 64.0, min(65.0, limit / 7.1)]), control, (0.0, 65.0))
    with pytest.raises(ControlError) as caught:
        refuse_impossible(np.array(theta_d), control, (0.0, 65.0))
    for line, problem in zip(str(caught.value).splitlines(), problems, strict=True):
        assert problem in line


@pytest.mark.parametrize("feedback", [False, True])
def test_strongest_learning_that_the_settings_allow_settles(recorded, control, rig, feedback):
    log = recorded["sweep"]
    X = np.column_stack([log["theta_deg"], log["p_o_kpa"]])
    model = FPRC(n_c=4, random_state=1).fit(X, log["p_exp_command_kpa"]).remember(X)
    theta_d = 32.5 - 27.5 * np.cos(2.0 * np.pi * 0.2 * np.arange(3000) / 200.0)
    strongest = Feedforward().changed(prior_s=0.1, kpa_per_deg=20.0, limit_kpa=500.0)
    for name in ("kpa_per_deg", "limit_kpa"):
        with pytest.raises(ValueError, match=name):
            Feedforward(**{name: 1.01 * getattr(strongest, name)})

    def error(online):
        device = SimulatedRig(rig, seed=1, run=10, sample_rate_hz=200.0)
        law = tracking_law(theta_d, control, 450.0, model=model, online=online, feedback=feedback)
        theta = run(
            device, device, law, len(theta_d), control, extra=("",) * (3 + 2 * bool(online))
        )
        return np.sqrt(np.mean((theta_d - theta["theta_deg"])[-1000:] ** 2))

    learning = {name: getattr(strongest, name) for name in Learning._fields}
    assert error(Online(model, Learning(**learning), 0.005, 450.0)) < error(None)
