"""Execution times of the models, and of a step of the control loop."""

import logging
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from fprc.artifacts import write_json
from fprc.control import PD, PressurePI, tracking_law
from fprc.devices import Readings
from fprc.evaluation import time_models
from fprc.evaluation.timing import WARM_UP, machine, time_steps
from fprc.experiments.comparison import Data, able, build, read_data, refuse_mixture
from fprc.experiments.tracking import feedforward
from fprc.models import SequenceModel

log = logging.getLogger(__name__)


def measure_times(
    train: str,
    test: str,
    times: str,
    steps: str,
    *,
    models: Mapping[str, Any],
    control: Mapping[str, Any],
    tracking: Mapping[str, Any],
    repeats: int,
    seed: int,
) -> None:
    """Time training and test of every model on this machine, and a step of the closed loop."""
    train_data, test_data = read_data(train), read_data(test)
    refuse_mixture(train_data, test_data)
    logs = {
        name: (train_data.pair(name), test_data.pair(name)) for name in able(train_data, test_data)
    }
    fitted = {name: build(name, models, seed).fit(*pairs[0]) for name, pairs in logs.items()}
    timed = time_models(
        {name: (model, *logs[name]) for name, model in fitted.items()},
        repeats,
        progress=lambda what: log.info("%s, %d repeats in turn", what, repeats),
    )
    costs = []
    for name, model in fitted.items():
        cost = step_cost(model, test_data, control, tracking)
        costs.append({"model": name, **cost})
        log.info("%s: median %.1f us of %.0f", name, cost["median_us"], cost["budget_us"])
    results = [{"model": name, **entry} for name, entries in timed.items() for entry in entries]
    described = {"source": train_data.attributes["source"], **machine()}
    write_json(times, described | {"times": results})
    write_json(steps, described | {"steps": costs})


def step_cost(
    model: SequenceModel, test: Data, control: Mapping[str, Any], tracking: Mapping[str, Any]
) -> dict[str, float]:
    """Time what the computer does between two samples of the closed loop, sample by sample.

    The readings of the test log are replayed to the controller: feedforward by the
    fitted model, PD and both pressure loops, without any rig.
    """
    period_s = 1.0 / control["sample_rate_hz"]
    samples = len(test.channels["time_s"])
    tick = _controller(model, test, control, tracking, period_s)
    time_steps(tick, min(WARM_UP, samples))
    microseconds = 1e6 * time_steps(tick, samples)
    return {
        "samples": samples,
        "median_us": float(np.median(microseconds)),
        "p99_9_us": float(np.percentile(microseconds, 99.9)),
        "max_us": float(microseconds.max()),
        "budget_us": 1e6 * period_s,
    }


def _controller(
    model: SequenceModel,
    data: Data,
    control: Mapping[str, Any],
    tracking: Mapping[str, Any],
    period_s: float,
) -> Callable[[int], object]:
    theta, p_exp = (data.channels[name] for name in ("theta_deg", "p_exp_kpa"))
    p_o = data.channels.get("p_o_kpa", np.zeros_like(theta))
    readings = [
        Readings(k * period_s, p_exp[k], theta[k], 0.0, p_o[k], 0.0) for k in range(len(theta))
    ]
    law = tracking_law(
        theta,
        k_in_kpa_per_deg=control["k_in_kpa_per_deg"],
        pressure_limit_kpa=tracking["pressure_limit_kpa"],
        feedforward=feedforward(model),
        feedback=PD(**tracking["printed_gains"], period_s=period_s),
    )
    main_loop, reservoir_loop = (
        PressurePI(**control[name], period_s=period_s) for name in ("main_loop", "reservoir_loop")
    )

    def tick(k: int) -> None:
        now = readings[k]
        p_exp_kpa, p_i_kpa, *_ = law(k, now)
        main_loop.step(p_exp_kpa, now.p_exp_kpa)
        reservoir_loop.step(p_i_kpa, now.p_i_kpa)

    model.reset()
    return tick


def measure_times_over_n_c(
    train: str,
    test: str,
    times: str,
    *,
    models: Mapping[str, Any],
    values: Sequence[int],
    repeats: int,
    seed: int,
) -> None:
    """Time FPRC and Fuzzy-linear over the number of rules (Fig. 10c)."""
    train_data, test_data = read_data(train), read_data(test)
    refuse_mixture(train_data, test_data)
    fitted = {}
    for name in able(train_data, test_data):
        for n_c in values if name != "esn" else ():
            train_pair, test_pair = train_data.pair(name), test_data.pair(name)
            model = build(name, models, seed).set_params(n_c=n_c).fit(*train_pair)
            fitted[name, n_c] = (model, train_pair, test_pair)
    timed = time_models(
        fitted,
        repeats,
        modes=("batch",),
        progress=lambda what: log.info("%s, %d repeats in turn", what, repeats),
    )
    results = [
        {"model": name, "n_c": n_c, **entry}
        for (name, n_c), entries in timed.items()
        for entry in entries
    ]
    write_json(times, {"source": train_data.attributes["source"], **machine(), "times": results})
