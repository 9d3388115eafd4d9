import json

import numpy as np
import pytest

from fprc.config import Settings
from fprc.config.section import limits_of
from fprc.config.settings import Control
from fprc.devices.sim import SimulatedRig
from fprc.experiments.settings import RigSettings, Unit
from fprc.studies.beyond import driven_states as experiment
from fprc.studies.beyond.driven_states import judge_capacity

MODELS = Settings().models.model_dump()
SMALL = {
    "HOLD_S": 0.1,
    "_WASHOUT": 10,
    "_VIRTUAL_NODES": 4,
    "_EPSILONS": (0.03,),
    "_ESN_NODES": 8,
    "_TARGETS": {"max_delay": 4, "max_degree": 2, "p": 1e-4},
}


@pytest.fixture
def judge(rig, control, monkeypatch):
    """Judge a rig whose parameters of a section are replaced."""

    def judge(seed=1, holds=600, changed=(), **sections):
        for name, value in (SMALL | dict(changed)).items():
            monkeypatch.setattr(experiment, name, value)
        for section, changed in sections.items():
            rig[section] |= changed
        on_rig = RigSettings(rig, control, {}, "command")
        (found,) = judge_capacity(Unit(0, {}, [(on_rig, seed)]), models=MODELS, holds=holds)
        return found

    return judge


def test_lowpass_of_held_input_has_the_memory_of_its_impulse_response(judge):
    """A hold of 20 samples makes one step of it, with the pole (1 - epsilon)^20."""
    targets = SMALL["_TARGETS"] | {"max_degree": 1}
    bank = judge(holds=2500, changed={"_TARGETS": targets, "_ESN_NODES": 1})["sets"]["bank"]
    pole = 0.97**20
    expected = (1.0 - pole**2) * pole ** (2 * np.arange(5))
    np.testing.assert_allclose(bank["by_delay"], expected, atol=0.04)


def test_each_set_has_its_states_and_the_results_are_json(judge):
    judged = judge()
    assert {name: found["states"] for name, found in judged["sets"].items()} == {
        "p_o": 1,
        "p_o_taps": 3,
        "p_o_virtual": 4,
        "theta_lowpass_taps": 3,
        "bank": 1,
        "esn": 13,
        "esn_noisy": 13,
    }
    assert json.loads(json.dumps(judged)) == judged
    for found in judged["sets"].values():
        assert found["by_degree"]["1"] == pytest.approx(sum(found["by_delay"]))


def test_taps_of_lowpassed_held_theta_know_two_numbers(judge):
    """Within a hold they are the held angle and one average of the earlier ones."""
    found = judge()["sets"]["theta_lowpass_taps"]
    assert found["rank"] == 2
    assert found["by_delay"][0] == pytest.approx(1.0)


def test_p_o_of_a_reservoir_without_friction_or_noise_forgets_every_earlier_hold(judge):
    judged = judge(
        reservoir={"friction_kpa": 0.0, "friction_per_kpa": 0.0, "bending_time_s": 0.02},
        pressure_sensor={"noise_kpa": 0.0},
        holds=300,
        changed={"HOLD_S": 0.3},
    )
    assert judged["sets"]["p_o"]["by_delay"][0] > 0.97
    assert judged["sets"]["p_o"]["by_delay"][1:] == [0.0] * 4


def test_noise_of_p_o_is_that_of_its_sensor(judge, quiet_rig, control):
    """Over the standard deviation of P_o on other random holds of the same range."""
    judged = judge(pressure_sensor={"noise_kpa": 0.9})
    theta_d = np.repeat(np.random.default_rng(8).uniform(5.0, 60.0, 1000), 20)
    device = SimulatedRig(quiet_rig, seed=1, run=0, sample_rate_hz=200.0)
    run = device.follow(control, np.zeros_like(theta_d), theta_d)
    assert judged["noise_of_p_o"] == pytest.approx(0.9 / np.std(run["p_o_kpa"]), rel=0.08)


def test_network_at_the_end_of_a_long_hold_knows_the_held_angle_alone(judge):
    found = judge(holds=100, changed={"HOLD_S": 0.4})["sets"]["esn"]
    assert found["by_delay"] == pytest.approx([1.0, 0.0, 0.0, 0.0, 0.0])


def test_noise_makes_the_network_lose_capacity(judge):
    sets = judge(pressure_sensor={"noise_kpa": 1.5})["sets"]
    total = {name: sum(sets[name]["by_degree"].values()) for name in ("esn", "esn_noisy")}
    assert total["esn_noisy"] < total["esn"] - 0.1


def test_states_of_the_network_do_not_depend_on_the_parts(judge, monkeypatch):
    whole = judge(holds=150)["sets"]["esn"]
    monkeypatch.setattr(experiment, "_AT_ONCE", 37)
    parts = judge(holds=150)["sets"]["esn"]
    assert parts["by_degree"] == pytest.approx(whole["by_degree"], abs=1e-6)


def test_a_hold_has_enough_samples_for_the_virtual_nodes_at_the_lowest_sample_rate():
    lowest, _ = limits_of(Control.model_fields["sample_rate_hz"])
    assert experiment.HOLD_S * lowest >= experiment._VIRTUAL_NODES
