"""Cross-validation, test, grids and execution times of the models, Secs. III-D and III-E."""

from collections.abc import Mapping, Sequence
from typing import Any

from fprc.artifacts import replacing, write_json
from fprc.evaluation import time_models
from fprc.evaluation.timing import machine
from fprc.experiments.comparison import cross_validate_both
from fprc.experiments.data import models_for, read_data, refuse_mixture
from fprc.experiments.grids import evaluate_grids
from fprc.experiments.settings import CrossValidation
from fprc.logs import write_columns
from fprc.models import save_model
from fprc.paper import DIRECTIONS, GRID_MODELS
from fprc.registry import build, outside_classes


def judge(
    sweep: str,
    complex: str,
    errors: Sequence[str],
    fitted: Sequence[str],
    fits: Sequence[str],
    predictions: Sequence[str],
    *,
    name: str,
    validation: CrossValidation,
) -> None:
    """Cross-validate one model on each log and test its best fold on the other.

    Writes for each of ``DIRECTIONS`` the errors, the model of the best fold, and its
    output on the training log (``fits``) and on the test log (``predictions``).
    """
    logs = {"sweep": read_data(sweep), "complex": read_data(complex)}
    outside = outside_classes(validation.models)
    judged = cross_validate_both(name, validation, logs)
    for k, (train, test) in enumerate(DIRECTIONS):
        validated, report, tested = judged[k]
        write_json(errors[k], report)
        with replacing(fitted[k]) as temporary:
            save_model(validated.model, temporary, outside)
        for path, log, output in ((fits[k], train, validated.fit), (predictions[k], test, tested)):
            data = logs[log]
            channels = {key: data.channels[key] for key in ("time_s", "p_target_kpa")}
            channels["p_ff_kpa"] = output
            write_columns(path, channels, dict(data.attributes) | {"model": name})


def grid(
    sweep: str,
    complex: str,
    cells: str,
    *,
    values: Mapping[str, Sequence[int | float]],
    validation: CrossValidation,
) -> None:
    """Cross-validate and test every cell of every grid, on logs that have no further seeds."""
    data = {"sweep": read_data(sweep), "complex": read_data(complex)}
    described = {
        "source": data["sweep"].attributes["source"],
        "seed": validation.seed,
        "unit": data["sweep"].unit,
    }
    write_json(cells, described | evaluate_grids(data, values, validation))


def measure_times(
    sweep: str,
    complex: str,
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
    train_data, test_data = read_data(sweep), read_data(complex)
    refuse_mixture(train_data, test_data)
    logs = {
        name: (train_data.samples(name, models)[:2], test_data.samples(name, models)[:2])
        for name in models_for(models, train_data, test_data)
    }
    work = {
        name: (build(name, models, seed).fit(*pairs[0]), *pairs) for name, pairs in logs.items()
    }
    timed = time_models(work, repeats)
    described = {"source": train_data.attributes["source"], **machine()}
    found = [{"model": name, **entry} for name, entries in timed.items() for entry in entries]
    write_json(times, described | {"times": found})
    with_rules = {
        (name, rules): (build(name, models, seed, n_c=rules).fit(*logs[name][0]), *logs[name])
        for name in GRID_MODELS["n_c"]
        if name in logs
        for rules in n_c
    }
    of_rules = time_models(with_rules, repeats, sequential=False)
    found = [{"model": name, "n_c": rules, **entry}
             for (name, rules), entries in of_rules.items() for entry in entries]  # fmt: skip
    write_json(times_over_n_c, described | {"times": found})
