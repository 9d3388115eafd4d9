"""Capacities of the simulated reservoir, and of states that a computer makes, on random holds."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from fprc.devices.sim import SimulatedRig
from fprc.experiments.settings import Unit
from fprc.models import EchoStates, lowpass, taps
from fprc.studies.beyond.capacity import processing_capacity

#: Runs of the same input on the simulated rig; their difference is the noise of P_o.
_RUNS = (70, 71)

#: Length of a hold, s: a sample at twice 1 Hz, the highest frequency of the paper's signals.
HOLD_S = 0.5

#: Range from which the theta_d of each hold is drawn, deg.
_ANGLES_DEG = (5.0, 60.0)

#: Holds that are discarded before those that are judged.
_WASHOUT = 20

#: Samples of P_o in a hold; at the lowest sample rate a hold has 25.
_VIRTUAL_NODES = 10

#: Filter factors of the bank of low-passes, and nodes of the ESN.
_EPSILONS = (0.03, 0.01, 0.003)
_ESN_NODES = 100

#: Longest delay of a target in holds, its highest degree, and the probability that a capacity
#: due to chance counts; see ``processing_capacity``.
_TARGETS: dict[str, Any] = {"max_delay": 10, "max_degree": 3, "p": 1e-4}

#: Number of holds whose network states are computed at a time.
_AT_ONCE = 200


def judge_capacity(unit: Unit, *, models: Mapping[str, Any], holds: int) -> list[dict[str, Any]]:
    """Return memory and information processing capacities of several sets of states.

    The input is random: theta_d holds values that are independent and uniform, and
    P_i = K_in theta_d. The states are taken at the end of each hold:

    - ``p_o``: P_o; ``p_o_taps``: the taps of low-passed P_o, as FPRC has them; ``p_o_virtual``: P_o
      at equidistant times of each hold.
    - ``theta_lowpass_taps``: the same taps of low-passed theta_d; ``bank``: theta_d, low-passed
      with each of several filter factors.
    - ``esn``: the network of a small ESN, and taps of theta_d;
      ``esn_noisy``: the same with noise on theta_d that is as large, relative to the signal, as
      the noise of P_o.

    Parameters
    ----------
    unit : Unit
        Its rig, and its first seed: of the input, the rig and the network.
    models : Mapping
        Section of the configuration.
    holds : int
        Number of holds that count.

    Returns
    -------
    list of one dict
        ``seed``. ``noise_of_p_o``: standard deviation of the noise over that of the signal.
        ``sets``: for each set the number of ``states``, the ``rank``, the ``threshold``, and the
        capacities ``by_degree`` and, of the input itself, ``by_delay``.

    Raises
    ------
    EvaluationError
        There are too few holds.
    SimulationError
        The simulation diverges.
    """
    on_rig, seed = unit.rigs[0]
    rig, control = on_rig.rig, on_rig.control
    hold = round(HOLD_S * control["sample_rate_hz"])
    # the first max_delay states are not judged; their inputs are the delayed ones of later states
    holds += _WASHOUT + _TARGETS["max_delay"]
    rng = np.random.default_rng([seed, 60])
    u = rng.uniform(-1.0, 1.0, holds)
    low, high = _ANGLES_DEG
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
    nodes = np.linspace(0, hold, _VIRTUAL_NODES + 1)[1:].round().astype(int) - 1
    settings = {"r": _ESN_NODES, "n_y": models["n_y"], "random_state": seed}
    network = EchoStates(**models["esn"] | settings).fit(np.zeros((models["n_y"], 1)))
    sets = {
        "p_o": p_o[last, None],
        "p_o_taps": taps(lowpass(p_o, epsilon), n_u)[last],
        "p_o_virtual": p_o.reshape(holds, hold)[:, nodes],
        "theta_lowpass_taps": taps(lowpass(theta_d, epsilon), n_u)[last],
        "bank": np.column_stack([lowpass(theta_d, e)[last] for e in _EPSILONS]),
        "esn": _at_ends(network, theta_d, hold),
        "esn_noisy": _at_ends(network, noisy, hold),
    }
    found = {
        name: processing_capacity(u[_WASHOUT:], states[_WASHOUT:], **_TARGETS)
        for name, states in sets.items()
    }
    return [{"seed": seed, "noise_of_p_o": noise, "sets": found}]


def _at_ends(network: EchoStates, theta_d: np.ndarray, hold: int) -> np.ndarray:
    """Return the features of the network at the end of each hold.

    All samples at once would fill the memory. Each part is preceded by the holds of the washout, in
    which the network forgets its initial state.
    """
    found = []
    for first in range(0, len(theta_d), _AT_ONCE * hold):
        begin = max(0, first - _WASHOUT * hold)
        rows = network.transform(theta_d[begin : first + _AT_ONCE * hold, None])
        found.append(rows[first - begin + hold - 1 :: hold])
    return np.concatenate(found)
