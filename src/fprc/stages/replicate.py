"""Repeat the whole comparison with further seeds: other sensors, noise, drift and models."""

from collections.abc import Mapping
from typing import Any

from fprc.artifacts import write_json
from fprc.config.tracking import Tracking
from fprc.experiments.comparison import compare_models, errors_over_starts
from fprc.experiments.grids import evaluate_grids
from fprc.experiments.hysteresis import simulate
from fprc.experiments.settings import CrossValidation, RigSettings
from fprc.experiments.tracking import Track, measure_control, tracking_errors
from fprc.paper import REFERENCES
from fprc.registry import controllers

#: Places where the fuzzy c-means of FPRC begins, to see how much its errors depend on them.
_STARTS = 10

#: Of these, how many also track the references of Table IV; a loop costs more than an error.
_TRACKED = 5


def replicate(
    compared: str,
    cells: str,
    measures: str,
    *,
    on_rig: RigSettings,
    validation: CrossValidation,
    values: Mapping[str, Any],
    tracking: Tracking,
) -> None:
    """Repeat everything but the execution times with another seed, beginning with new logs.

    Writes Tables II and III and the weights of Fig. 9 (``compared``), the grids of
    Figs. 10 and 11 (``cells``), and the closed loops of Sec. IV (``measures``). The seed is that of
    ``validation``.
    """
    how, data = validation, simulate(on_rig, validation.seed)
    comparison, models = compare_models(data, how)
    described = {"seed": how.seed, "source": "sim"}
    starts, started = errors_over_starts(data, how, _STARTS)
    write_json(compared, described | comparison | {"fprc_rmse_over_starts": starts})
    write_json(cells, described | evaluate_grids(data, values, how, folds=1))
    bench = Track(tracking, on_rig.control, on_rig.rig, how.seed)
    measured = measure_control(data["sweep"], bench, models, controllers(how.models))
    loops = {"fprc": 0.0, "fprc_pd": 1.0}
    tracked = [tracking_errors(bench, model, loops) for model in started[:_TRACKED]]
    over_starts = {
        f"{reference}/{name}": [errors[name][reference] for errors in tracked]
        for reference in REFERENCES
        for name in loops
    }
    write_json(measures, described | measured | {"fprc_rmse_over_starts": over_starts})
