"""`fprc train` and `fprc predict`: a model from raw logs to predictions, without Snakemake."""

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd
from threadpoolctl import threadpool_limits

from fprc.artifacts import refuse_output, replacing, write_text
from fprc.config import from_files, local_files
from fprc.errors import ConfigError, FprcError
from fprc.escape import visible
from fprc.evaluation import cross_validate, rmse
from fprc.evaluation.crossval import refusals_of
from fprc.experiments.data import Data, join
from fprc.experiments.settings import Judgement
from fprc.logs import write_columns
from fprc.models import SequenceModel, load_model, save_model
from fprc.plan.arguments import judgement
from fprc.registry import build, entries, load_class, outside_class
from fprc.stages.preprocess import read_recordings

Settings = Mapping[str, Any]


def train(
    logs: Sequence[str],
    out: str,
    *,
    model: str = "fprc",
    seed: int | None = None,
    config: Sequence[str] = (),
) -> None:
    """Cross-validate a model on raw logs, as the workflow does, and save that of the best fold.

    Parameters
    ----------
    logs : sequence of str
        Raw logs, which train together.
    out : str
        Model to write, ``.h5``.
    model : str, default="fprc"
        Its name in the configuration.
    seed : int, optional
        Seed of folds and model; by default the configuration's.
    config : sequence of str
        Configuration files; by default ``config/config.yaml`` of the current folder, if it exists.

    Raises
    ------
    ConfigError
        The configuration is wrong, or has no such model; a log is given twice.
    LogError
        A log cannot be used, or the logs differ in source, units or channels.
    EvaluationError
        The logs do not suit the model.
    OutputError
        ``out`` exists, does not end in ``.h5``, or cannot be written.
    """
    refuse_output(out, ".h5")
    refuse_repeats(logs, "its samples would train and validate at once")
    chosen = {} if seed is None else {"seed": seed}
    settings = from_files(config or local_files(), chosen).model_dump(mode="json")
    models = settings["models"]
    if model not in entries(models):
        *most, last = entries(models)
        choice = f"{', '.join(most)} or {last}"
        raise ConfigError(f"--model {model}: there is no such model; use {choice}")
    data = _read(logs, settings)
    X, y = data.pair(model, models)
    folds = Judgement(**judgement(settings, model)).split_rows(data)
    unfitted = build(model, models, settings["seed"])
    with threadpool_limits(1):  # as in the workflow: sums by more threads have other last digits
        judged = cross_validate(unfitted, X, y, folds, lengths=data.lengths)
    with replacing(out) as temporary:
        save_model(judged.model, temporary, outside_class(model, models))
    report = (
        f"{out}: {model}, trained on {', '.join(logs)}; fold {judged.best + 1} of {len(folds)} is "
        f"best: training RMSE {judged.train_rmse[judged.best]:.2f} {data.unit}, validation "
        f"{judged.validation_rmse[judged.best]:.2f} {data.unit}"
    )
    print(visible(report))


def predict(model: str, raw: str, out: str, *, config: Sequence[str] = ()) -> None:
    """Write the output P_ff of a saved model for a raw log, and print its RMSE.

    The table has the time, the inputs of the model, P_exp (``p_target_kpa``) and P_ff.

    Parameters
    ----------
    model : str
        File that ``train`` or the workflow wrote.
    raw : str
        Raw log.
    out : str
        Table to write, ``.csv``, or ``.h5`` as the workflow writes it.
    config : sequence of str
        Configuration files, as for ``train``.

    Raises
    ------
    FprcError
        The file holds no model, or one that the configuration does not have.
    LogError
        The log cannot be used, or lacks an input of the model.
    OutputError
        ``out`` exists, has another suffix, or cannot be written.
    """
    refuse_output(out, ".csv", ".h5")
    settings = from_files(config or local_files()).model_dump(mode="json")
    models = settings["models"]
    outside = [cls for name in models["others"] for cls in outside_class(name, models)]
    fitted = load_model(model, outside)
    name = _name_of(fitted, model, models)
    data = _read([raw], settings)
    X, y = data.pair(name, models)
    with threadpool_limits(1), refusals_of(fitted):
        output = fitted.predict(X)
    kept = ("time_s", *entries(models)[name].inputs, "p_target_kpa")
    columns = {key: data.channels[key] for key in kept} | {"p_ff_kpa": output}
    if Path(out).suffix == ".h5":
        write_columns(out, columns, dict(data.attributes) | {"model": name})
    else:
        write_text(out, pd.DataFrame(columns).to_csv(index=False, lineterminator="\n"))
    report = (
        f"{out}: {name} on {raw}, {len(y)} samples; RMSE against the "
        f"{'commanded' if data.attributes['target'] == 'command' else 'measured'} P_exp "
        f"{rmse(y, output):.2f} {data.unit}"
    )
    print(visible(report))


def refuse_repeats(paths: Sequence[str], why: str) -> None:
    """Refuse a recording that is given twice.

    Parameters
    ----------
    why : str
        What would be wrong, for the message.

    Raises
    ------
    ConfigError
        Lists every repeated recording.
    """
    places = [os.path.realpath(path) for path in paths]
    repeated = [path for i, path in enumerate(paths) if places[i] in places[:i]]
    if repeated:
        raise ConfigError(f"{', '.join(repeated)}: given twice; give each recording once: {why}")


def _read(logs: Sequence[str], settings: Settings) -> Data:
    """Read raw logs as the workflow's preprocessing does; several become one."""
    rate_hz = settings["control"]["sample_rate_hz"]
    recordings, _ = read_recordings(
        logs,
        experiment=None,
        target=settings["evaluation"]["target"],
        sample_rate_hz=rate_hz,
        limits=settings["quality"],
    )
    if len(recordings) == 1:
        return recordings[0]
    return join(dict(zip(logs, recordings, strict=True)), 1.0 / rate_hz)


def _name_of(fitted: SequenceModel, path: str, models: Settings) -> str:
    """Return the name of a model's class in the configuration."""
    for name in entries(models):
        if load_class(name, models) is type(fitted):
            return name
    raise FprcError(f"{path}: holds a {type(fitted).__name__}, a part of a model; train it again")
