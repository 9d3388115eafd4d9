"""Execution times of the models."""

from collections.abc import Mapping, Sequence
from typing import Any

from fprc.artifacts import write_json
from fprc.evaluation import time_models
from fprc.evaluation.timing import machine
from fprc.experiments.data import models_for, read_data, refuse_mixture
from fprc.paper import GRID_MODELS
from fprc.registry import build


def measure_times(
    train: str,
    test: str,
    times: str,
    times_over_n_c: str,
    *,
    models: Mapping[str, Any],
    n_c: Sequence[int],
    repeats: int,
    seed: int,
) -> None:
    """Time training and test of every model on this machine.

    FPRC and Fuzzy-linear also over the number of rules (Fig. 10c).
    """
    train_data, test_data = read_data(train), read_data(test)
    refuse_mixture(train_data, test_data)
    logs = {
        name: (train_data.samples(name, models)[:2], test_data.samples(name, models)[:2])
        for name in models_for(models, train_data, test_data)
    }
    fitted = {name: build(name, models, seed).fit(*pairs[0]) for name, pairs in logs.items()}
    work = {name: (model, *logs[name]) for name, model in fitted.items()}
    timed = time_models(work, repeats)
    results = [{"model": name, **entry} for name, entries in timed.items() for entry in entries]
    described = {"source": train_data.attributes["source"], **machine()}
    write_json(times, described | {"times": results})

    with_rules = {
        (name, rules): (build(name, models, seed, n_c=rules).fit(*logs[name][0]), *logs[name])
        for name in GRID_MODELS["n_c"]
        if name in logs
        for rules in n_c
    }
    over_n_c = [
        {"model": name, "n_c": rules, **entry}
        for (name, rules), entries in time_models(with_rules, repeats, sequential=False).items()
        for entry in entries
    ]
    write_json(times_over_n_c, described | {"times": over_n_c})
