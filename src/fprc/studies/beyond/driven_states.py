"""Capacities of the simulated reservoir, and of states that a computer makes, on random holds."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from fprc.devices.sim import SimulatedRig
from fprc.errors import EvaluationError
from fprc.experiments.settings import Unit
from fprc.models import EchoStates, lowpass, taps
from fprc.studies.beyond.capacity import processing_capacity

#: Runs of the same input on the simulated rig; their difference is the noise of P_o.
_RUNS = (70, 71)

#: Number of holds whose network states are computed at a time.
_AT_ONCE = 200


def judge_capacity(
    unit: Unit, *, models: Mapping[str, Any], capacity: Mapping[str, Any]
) -> list[dict[str, Any]]:
    """Return memory and information processing capacities of several sets of states.

    The input is random: theta_d holds values that are independent and uniform over
    ``angle_range_deg``, and P_i = K_in theta_d. Holds of 0.5 s are samples at twice 1 Hz, the
    highest frequency of the paper's signals. The states are taken at the end of each hold:

    - ``p_o``: P_o; ``p_o_taps``: the taps of low-passed P_o, as FPRC has them; ``p_o_virtual``: P_o
      at ``virtual_nodes`` equidistant times of each hold.
    - ``theta_lowpass_taps``: the same taps of low-passed theta_d; ``bank``: theta_d, low-passed
      with each of ``bank_epsilons``.
    - ``esn``: the network of the ESN with ``esn_nodes`` nodes, and taps of theta_d;
      ``esn_noisy``: the same with noise on theta_d that is as large, relative to the signal, as
      the noise of P_o.

    Parameters
    ----------
    unit : Unit
        Its rig, and its first seed: of the input, the rig and the network.
    models : Mapping
        Section of the configuration.
    capacity : Mapping
        ``hold_s``, ``angle_range_deg``, ``samples`` (holds that count), ``washout`` (holds before
        them), ``max_delay``, ``max_degree``, ``p`` (as in ``processing_capacity``),
        ``virtual_nodes``, ``bank_epsilons``, ``esn_nodes``.

    Returns
    -------
    list of one dict
        ``seed``. ``noise_of_p_o``: standard deviation of the noise over that of the signal.
        ``sets``: for each set the number of ``states``, the ``rank``, the ``threshold``, and the
        capacities ``by_degree`` and, of the input itself, ``by_delay``.

    Raises
    ------
    EvaluationError
        A hold is shorter than ``virtual_nodes`` samples, or there are too few samples.
    SimulationError
        The simulation diverges.
    """
    on_rig, seed = unit.rigs[0]
    rig, control = on_rig.rig, on_rig.control
    hold = round(capacity["hold_s"] * control["sample_rate_hz"])
    if hold < capacity["virtual_nodes"]:
        raise EvaluationError(
            f"a hold of {capacity['hold_s']} s has {hold} samples, fewer than the "
            f"{capacity['virtual_nodes']} virtual nodes; lengthen hold_s or use fewer nodes"
        )
    # the first max_delay states are not judged; their inputs are the delayed ones of later states
    holds = capacity["washout"] + capacity["max_delay"] + capacity["samples"]
    rng = np.random.default_rng([seed, 60])
    u = rng.uniform(-1.0, 1.0, holds)
    low, high = capacity["angle_range_deg"]
    theta_d = np.repeat(low + 0.5 * (high - low) * (u + 1.0), hold)
    # P_i = K_in theta_d; the actuator stays vented
    p_o, repeated = (
        SimulatedRig(rig, seed=seed, run=run, sample_rate_hz=control["sample_rate_hz"]).follow(
            control, np.zeros_like(theta_d), theta_d
        )["p_o_kpa"]
        for run in _RUNS
    )
    noise = float(np.std(p_o - repeated) / np.sqrt(2.0) / np.std(p_o))
    noisy = theta_d + noise * np.std(theta_d) * rng.standard_normal(len(theta_d))
    epsilon, n_u = models["fprc"]["epsilon"], models["fprc"]["n_u"]
    last = slice(hold - 1, None, hold)
    nodes = np.linspace(0, hold, capacity["virtual_nodes"] + 1)[1:].round().astype(int) - 1
    settings = {"r": capacity["esn_nodes"], "n_y": models["n_y"], "random_state": seed}
    network = EchoStates(**models["esn"] | settings).fit(np.zeros((models["n_y"], 1)))
    sets = {
        "p_o": p_o[last, None],
        "p_o_taps": taps(lowpass(p_o, epsilon), n_u)[last],
        "p_o_virtual": p_o.reshape(holds, hold)[:, nodes],
        "theta_lowpass_taps": taps(lowpass(theta_d, epsilon), n_u)[last],
        "bank": np.column_stack([lowpass(theta_d, e)[last] for e in capacity["bank_epsilons"]]),
        "esn": _at_ends(network, theta_d, hold, capacity["washout"]),
        "esn_noisy": _at_ends(network, noisy, hold, capacity["washout"]),
    }
    how = {name: capacity[name] for name in ("max_delay", "max_degree", "p")}
    judged = slice(capacity["washout"], None)
    found = {
        name: processing_capacity(u[judged], states[judged], **how) for name, states in sets.items()
    }
    return [{"seed": seed, "noise_of_p_o": noise, "sets": found}]


def _at_ends(network: EchoStates, theta_d: np.ndarray, hold: int, before: int) -> np.ndarray:
    """Return the features of the network at the end of each hold.

    All samples at once would fill the memory. Each part is preceded by ``before`` holds, in which
    the network forgets its initial state.
    """
    found = []
    for first in range(0, len(theta_d), _AT_ONCE * hold):
        begin = max(0, first - before * hold)
        rows = network.transform(theta_d[begin : first + _AT_ONCE * hold, None])
        found.append(rows[first - begin + hold - 1 :: hold])
    return np.concatenate(found)
