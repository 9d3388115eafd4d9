"""Tables II and III: cross-validation and test of one model."""

from collections.abc import Mapping, Sequence
from typing import Any

from fprc.artifacts import replacing, write_json
from fprc.experiments.comparison import cross_validate_both
from fprc.experiments.data import read_data
from fprc.experiments.settings import CrossValidation
from fprc.logs import write_columns
from fprc.models import save_model
from fprc.paper import DIRECTIONS
from fprc.registry import outside_classes


def judge(
    sweep: str,
    complex: str,
    errors: Sequence[str],
    fitted: Sequence[str],
    fits: Sequence[str],
    predictions: Sequence[str],
    *,
    name: str,
    validation: Mapping[str, Any],
) -> None:
    """Cross-validate one model on each log and test its best fold on the other.

    Writes for each of ``DIRECTIONS`` the errors, the model of the best fold, and its
    output on the training log (``fits``) and on the test log (``predictions``).
    """
    logs = {"sweep": read_data(sweep), "complex": read_data(complex)}
    outside = outside_classes(validation["models"])
    judged = cross_validate_both(name, CrossValidation(**validation), logs)
    for (train, test), (validated, report, tested), error, model, fit, prediction in zip(
        DIRECTIONS, judged, errors, fitted, fits, predictions, strict=True
    ):
        write_json(error, report)
        with replacing(model) as temporary:
            save_model(validated.model, temporary, outside)
        for path, data, output in (
            (fit, logs[train], validated.fit),
            (prediction, logs[test], tested),
        ):
            channels = {key: data.channels[key] for key in ("time_s", "p_target_kpa")}
            channels["p_ff_kpa"] = output
            write_columns(path, channels, dict(data.attributes) | {"model": name})
