"""Cross-validation, test, grids and execution times of the models; all of it with further seeds."""

from collections.abc import Mapping, Sequence
from typing import Any

from fprc.artifacts import replacing, write_json
from fprc.config.settings import Tracking
from fprc.evaluation import time_models
from fprc.evaluation.timing import machine
from fprc.experiments import comparison
from fprc.experiments.data import RigSettings, models_for, read_data, refuse_mixture, simulate
from fprc.experiments.tracking import Track, measure_control
from fprc.logs import write_columns
from fprc.models import save_model
from fprc.paper import DIRECTIONS, GRID_MODELS
from fprc.registry import build, controllers, outside_classes


def judge(
    sweep: str,
    complex: str,
    errors: Sequence[str],
    fitted: Sequence[str],
    fits: Sequence[str],
    predictions: Sequence[str],
    *,
    name: str,
    validation: comparison.CrossValidation,
) -> None:
    """Cross-validate one model on each log and test its best fold on the other.

    Writes for each of ``DIRECTIONS`` the errors, the model of the best fold, and its
    output on the training log (``fits``) and on the test log (``predictions``).
    """
    logs = {"sweep": read_data(sweep), "complex": read_data(complex)}
    outside = outside_classes(validation.models)
    judged = comparison.cross_validate_both(name, validation, logs)
    for k, (validated, report, tested) in enumerate(judged):
        write_json(errors[k], report)
        with replacing(fitted[k]) as temporary:
            save_model(validated.model, temporary, outside)
        files, outputs = (fits[k], predictions[k]), (validated.fit, tested)
        for path, log, output in zip(files, DIRECTIONS[k], outputs, strict=True):
            channels = {key: logs[log].channels[key] for key in ("time_s", "p_target_kpa")}
            channels["p_ff_kpa"] = output
            write_columns(path, channels, {**logs[log].attributes, "model": name})


def grid(
    sweep: str,
    complex: str,
    cells: str,
    *,
    values: Mapping[str, Sequence[int | float]],
    validation: comparison.CrossValidation,
) -> None:
    """Cross-validate and test every cell of every grid, on logs that have no further seeds."""
    data = {"sweep": read_data(sweep), "complex": read_data(complex)}
    source, unit = data["sweep"].attributes["source"], data["sweep"].unit
    described = {"source": source, "seed": validation.seed, "unit": unit}
    write_json(cells, described | comparison.evaluate_grids(data, values, validation))


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
    train, test = read_data(sweep), read_data(complex)
    refuse_mixture(train, test)
    logs = {
        name: [log.samples(name, models)[:2] for log in (train, test)]
        for name in models_for(models, train, test)
    }

    def work(name: str, **changed: int) -> Any:
        return build(name, models, seed, **changed).fit(*logs[name][0]), *logs[name]

    timed = time_models({name: work(name) for name in logs}, repeats)
    with_rules = [(name, rules) for name in GRID_MODELS["n_c"] if name in logs for rules in n_c]
    over_n_c = {(name, rules): work(name, n_c=rules) for name, rules in with_rules}
    timed_over_n_c = time_models(over_n_c, repeats, sequential=False)
    described = {"source": train.attributes["source"], **machine()}
    found = [{"model": name, **entry} for name, entries in timed.items() for entry in entries]
    write_json(times, described | {"times": found})
    found = [{"model": name, "n_c": rules, **entry}
             for (name, rules), entries in timed_over_n_c.items() for entry in entries]  # fmt: skip
    write_json(times_over_n_c, described | {"times": found})


def replicate(
    compared: str,
    cells: str,
    measures: str,
    *,
    on_rig: RigSettings,
    validation: comparison.CrossValidation,
    values: Mapping[str, Any],
    tracking: Tracking,
) -> None:
    """Repeat all but the execution times with the seed of ``validation``, of the rig's noise too.

    Writes Tables II and III and the weights of Fig. 9 (``compared``), the grids of Figs. 10 and 11
    (``cells``), and the closed loops of Sec. IV (``measures``).
    """
    how, data = validation, simulate(on_rig, validation.seed)
    results, models = comparison.compare_models(data, how)
    described = {"seed": how.seed, "source": "sim"}
    write_json(compared, described | results)
    write_json(cells, described | comparison.evaluate_grids(data, values, how, folds=1))
    bench = Track(tracking, on_rig.control, on_rig.rig, how.seed)
    measured = measure_control(data["sweep"], bench, models, controllers(how.models))
    write_json(measures, described | measured)
