"""Execution times of the models."""

import logging
from collections.abc import Mapping, Sequence
from typing import Any

from fprc.artifacts import write_json
from fprc.evaluation import time_model
from fprc.evaluation.timing import machine
from fprc.stages.judge import INPUTS, build, read_data, refuse_mixture

log = logging.getLogger(__name__)


def measure_times(
    train: str,
    test: str,
    times: str,
    *,
    models: Mapping[str, Any],
    repeats: int,
    seed: int,
) -> None:
    """Time training and test of every model on this machine."""
    train_data, test_data = read_data(train), read_data(test)
    refuse_mixture(train_data, test_data)
    results = []
    for name in INPUTS:
        timed = time_model(
            build(name, models, seed),
            train_data.pair(name),
            test_data.pair(name),
            repeats,
            progress=lambda what, name=name: log.info("%s: %s, %d repeats", name, what, repeats),
        )
        results += [{"model": name, **result} for result in timed]
    write_json(times, {"source": train_data.attributes["source"], **machine(), "times": results})


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
    results = []
    for name in ("fprc", "fuzzy_linear"):
        for n_c in values:
            timed = time_model(
                build(name, models, seed).set_params(n_c=n_c),
                train_data.pair(name),
                test_data.pair(name),
                repeats,
                modes=("batch",),
            )
            log.info("%s: n_c = %d", name, n_c)
            results += [{"model": name, "n_c": n_c, **result} for result in timed]
    write_json(times, {"source": train_data.attributes["source"], **machine(), "times": results})
