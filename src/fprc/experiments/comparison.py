"""Cross-validation and test of the models."""

import logging
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from fprc.artifacts import replacing, write_json
from fprc.errors import LogError
from fprc.evaluation import Judgement, rmse, split_rows
from fprc.evaluation.crossval import refusals_of, validate_rows
from fprc.logs import EXPERIMENTS, read_columns, write_columns
from fprc.models import ESN, FPRC, FuzzyLinear, SequenceModel, save_model

log = logging.getLogger(__name__)

#: Tables II and III: the log that trains, and the log that tests.
DIRECTIONS = (EXPERIMENTS, EXPERIMENTS[::-1])

#: Channels that each model sees, in the order of its columns.
INPUTS = {
    "esn": ("theta_deg",),
    "fprc": ("theta_deg", "p_o_kpa"),
    "fuzzy_linear": ("theta_deg",),
}


class Judged(NamedTuple):
    """A model that was cross-validated on one log and tested on another."""

    judgement: Judgement
    report: dict[str, Any]  #: its errors
    tested: np.ndarray  #: output for the log that tests


class Data(NamedTuple):
    """One log as the models see it."""

    channels: Mapping[str, np.ndarray]
    attributes: Mapping[str, Any]

    @property
    def unit(self) -> str:
        """Unit of P_exp, and so of every error: kPa, unless an import says something else."""
        return self.attributes.get("p_exp_unit", "kPa")

    def pair(self, model: str) -> tuple[np.ndarray, np.ndarray]:
        """Return the inputs of a model, and P_exp.

        Raises
        ------
        LogError
            The log has no channel that the model needs.
        """
        missing = [name for name in INPUTS[model] if name not in self.channels]
        if missing:
            raise LogError(
                f"the {self.attributes['experiment']} log has no {', '.join(missing)}, which "
                f"{model} needs; import it with that channel, or judge the other models only"
            )
        columns = [self.channels[name] for name in INPUTS[model]]
        return np.column_stack(columns), self.channels["p_exp_kpa"]


def build(name: str, models: Mapping[str, Any], seed: int) -> SequenceModel:
    """Return the unfitted model of that name with its settings."""
    shared = {"n_y": models["n_y"], "alpha": models["alpha"], "random_state": seed}
    if name == "esn":
        return ESN(**models["esn"], **shared)
    if name == "fprc":
        return FPRC(**models["fprc"], **shared)
    fuzzy = {key: models["fprc"][key] for key in ("n_c", "sigma")}
    return FuzzyLinear(**fuzzy, **shared)


def read_data(path: str) -> Data:
    """Read a preprocessed log."""
    file = read_columns(path, ("time_s", "p_exp_kpa", "theta_deg"), optional=("p_o_kpa",))
    return Data(file.channels, file.attributes)


def able(*logs: Data) -> list[str]:
    """Return the models whose inputs are in every one of the logs."""
    return [
        model
        for model, names in INPUTS.items()
        if all(name in data.channels for data in logs for name in names)
    ]


def refuse_mixture(train: Data, test: Data) -> None:
    """Refuse to judge a model that was trained on one kind of data on another.

    Raises
    ------
    LogError
        One log is simulated, recorded or imported, and the other is not; or
        their P_exp has different units.
    """
    kinds = train.attributes["source"], test.attributes["source"]
    if kinds[0] != kinds[1]:
        raise LogError(
            f"the training log's source is {kinds[0]}, the test log's {kinds[1]}; "
            "use two logs of one kind"
        )
    if train.unit != test.unit:
        raise LogError(
            f"P_exp of the training log is in {train.unit}, that of the test log in {test.unit}; "
            "import both in one unit"
        )


def judge(
    sweep: str,
    complex: str,
    errors: Sequence[str],
    fitted: Sequence[str],
    fits: Sequence[str],
    predictions: Sequence[str],
    *,
    name: str,
    models: Mapping[str, Any],
    folds: int,
    split: str,
    seed: int,
) -> None:
    """Cross-validate one model on each log and test its best fold on the other.

    Writes for each of ``DIRECTIONS`` the errors, the model of the best fold, and what
    it predicts on the training log (``fits``) and on the test log (``predictions``).
    """
    logs = {"sweep": read_data(sweep), "complex": read_data(complex)}
    found = judge_directions(name, models, folds, split, seed, logs, DIRECTIONS)
    for (train, test), (judged, report, tested), error, model, fit, prediction in zip(
        DIRECTIONS, found, errors, fitted, fits, predictions, strict=True
    ):
        write_json(error, report)
        with replacing(model) as temporary:
            save_model(judged.model, temporary)
        for path, data, output in (
            (fit, logs[train], judged.fit),
            (prediction, logs[test], tested),
        ):
            channels = {key: data.channels[key] for key in ("time_s", "p_exp_kpa")}
            channels["p_ff_kpa"] = output
            write_columns(path, channels, dict(data.attributes) | {"model": name})


def judge_directions(
    name: str,
    models: Mapping[str, Any],
    folds: int,
    split: str,
    seed: int,
    logs: Mapping[str, Data],
    directions: Sequence[tuple[str, str]],
) -> list[Judged]:
    """Cross-validate and test one model for each (log that trains, log that tests).

    The features of each log are computed once for all directions.
    """
    for train, test in directions:
        refuse_mixture(logs[train], logs[test])
    model = build(name, models, seed)
    pairs = {key: data.pair(name) for key, data in logs.items()}
    log.info(
        "%s: features of %s samples", name, " and ".join(str(len(y)) for _, y in pairs.values())
    )
    with refusals_of(model):
        features = model.make_features().fit(pairs[directions[0][0]][0])
        rows = {key: features.transform(X) for key, (X, _) in pairs.items()}
    found = []
    for train, test in directions:
        y = pairs[train][1]
        label = f"{name}, trained on {logs[train].attributes['experiment']}"
        judged = validate_rows(
            model, features, rows[train], y, split_rows(len(y), folds, split, seed),
            progress=partial(_tell_fold, label, folds),
        )  # fmt: skip
        tested = judged.model.readout_.predict(rows[test])
        test_rmse = rmse(pairs[test][1], tested)
        log.info("%s: best fold %d, test %.2f kPa", label, judged.best + 1, test_rmse)
        report = {
            "model": name,
            "trained_on": logs[train].attributes["experiment"],
            "source": logs[train].attributes["source"],
            "seed": seed,
            "target": logs[train].attributes["target"],
            "unit": logs[train].unit,
            "split": split,
            "train_rmse_kpa": judged.train_rmse,
            "validation_rmse_kpa": judged.validation_rmse,
            "best_fold": judged.best,
            "test_rmse_kpa": test_rmse,
        }
        found.append(Judged(judged, report, tested))
    return found


def _tell_fold(label: str, folds: int, fold: int, e_train: float, e_validation: float) -> None:
    log.info(
        "%s: fold %d of %d: training %.2f, validation %.2f kPa",
        label, fold + 1, folds, e_train, e_validation,
    )  # fmt: skip
