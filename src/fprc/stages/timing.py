"""Execution times of the models, and of a step of the control loop."""

import logging
from collections.abc import Mapping, Sequence
from typing import Any

from fprc.artifacts import write_json
from fprc.evaluation import time_models
from fprc.evaluation.timing import machine
from fprc.experiments.data import models_for, read_data, refuse_mixture
from fprc.experiments.step_cost import step_cost
from fprc.paper import GRID_MODELS
from fprc.registry import build, has_steps

log = logging.getLogger(__name__)

#: Samples of each log that are timed one by one over the number of rules.
STEPS = 3000


def measure_times(
    train: str,
    test: str,
    times: str,
    steps: str,
    *,
    models: Mapping[str, Any],
    control: Mapping[str, Any],
    pressure_limit_kpa: float,
    repeats: int,
    seed: int,
) -> None:
    """Time training and test of every model on this machine, and steps of the closed loop."""
    train_data, test_data = read_data(train), read_data(test)
    refuse_mixture(train_data, test_data)
    logs = {
        name: (train_data.pair(name, models), test_data.pair(name, models))
        for name in models_for(models, train_data, test_data)
    }
    fitted = {name: build(name, models, seed).fit(*pairs[0]) for name, pairs in logs.items()}
    work = {name: (model, *logs[name]) for name, model in fitted.items()}
    stepping = {name: pieces for name, pieces in work.items() if has_steps(type(pieces[0]))}
    timed = time_models(stepping, repeats)
    others = {name: pieces for name, pieces in work.items() if name not in stepping}
    timed |= time_models(others, repeats, modes=("batch",)) if others else {}
    costs = []
    for name, (model, *_) in stepping.items():
        cost = step_cost(model, test_data, control, pressure_limit_kpa)
        costs.append({"model": name, **cost})
        log.info("%s: median %.1f us of %.0f", name, cost["median_us"], cost["budget_us"])
    results = [{"model": name, **entry} for name, entries in timed.items() for entry in entries]
    described = {"source": train_data.attributes["source"], **machine()}
    write_json(times, described | {"times": results})
    write_json(steps, described | {"steps": costs})


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
    """Time FPRC and Fuzzy-linear over the number of rules (Fig. 10c).

    Whole logs at once, and the first ``STEPS`` samples of each log one by one.
    """
    train_data, test_data = read_data(train), read_data(test)
    refuse_mixture(train_data, test_data)
    fitted = {}
    for name in models_for(models, train_data, test_data):
        for n_c in values if name in GRID_MODELS["n_c"] else ():
            train_pair, test_pair = train_data.pair(name), test_data.pair(name)
            model = build(name, models, seed).set_params(n_c=n_c).fit(*train_pair)
            fitted[name, n_c] = (model, train_pair, test_pair)
    parts = {
        name: (model, *(tuple(values[:STEPS] for values in log) for log in logs))
        for name, (model, *logs) in fitted.items()
    }
    results = []
    for mode, timed in (("batch", fitted), ("sequential", parts)):
        found = time_models(timed, repeats, modes=(mode,))
        results += [
            {"model": name, "n_c": n_c, **entry}
            for (name, n_c), entries in found.items()
            for entry in entries
        ]
    write_json(times, {"source": train_data.attributes["source"], **machine(), "times": results})
