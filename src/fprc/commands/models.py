"""`fprc simulate`, `train`, `predict`, `export`: from nothing to code, without Snakemake."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pandas as pd
from threadpoolctl import threadpool_limits

from fprc import __version__
from fprc.artifacts import refuse_output, replacing, sha256, write_text
from fprc.config import Settings, from_files
from fprc.config.settings import Control
from fprc.errors import ConfigError, FprcError
from fprc.escape import in_words
from fprc.evaluation import rmse
from fprc.evaluation.crossval import learn, refusals_of
from fprc.experiments.comparison import CrossValidation
from fprc.experiments.data import Data, read_recordings, refuse_other_data, trained_on
from fprc.experiments.tracking import Track
from fprc.given import refuse_repeats
from fprc.models import load_model, save_model
from fprc.models.c_header import c_header
from fprc.plan import of_pressures, validation
from fprc.registry import build, entries, entry_of, load_class, outside_classes
from fprc.stages.record import record


def simulate(
    experiment: str,
    *,
    seed: int | None = None,
    rig: str | None = None,
    config: Sequence[str] = (),
    out: str,
) -> str:
    """Simulate an experiment and write its raw log."""
    refuse_output(out, ".h5")
    settings = _settings(config, seed=seed, rig=rig)
    whole, signal = settings.model_dump(mode="json"), dict(settings.experiments)[experiment]
    how = {"control": Control(**of_pressures(whole)), "rig": whole["rig"], "seed": settings.seed}
    record([out], signals={experiment: signal}, **how)
    return (
        f"{out}: {experiment}, {signal.duration_s:g} s at {settings.control.sample_rate_hz:g} Hz, "
        f"on the simulated rig {settings.fitted.name}, seed {settings.seed}\n"
    )


def train(
    logs: Sequence[str],
    *,
    model: str = "fprc",
    seed: int | None = None,
    config: Sequence[str] = (),
    out: str,
) -> str:
    """Train a model on raw logs."""
    refuse_output(out, ".h5")
    refuse_repeats(logs, "its samples would train and validate at once")
    settings = _settings(config, seed=seed)
    models = settings.models.model_dump()
    if model not in entries(models):
        choice = in_words(entries(models), "or")
        raise ConfigError(f"--model {model}: there is no such model; use {choice}")
    data = _read(logs, settings, entry_of(model, models).inputs)
    folds = CrossValidation(**validation(settings.model_dump(), model)).split_rows(data)
    unfitted = build(model, models, settings.seed)
    with threadpool_limits(1):  # like the workflow; more threads change the last digits
        result = learn(unfitted, data.samples(model, models), folds)
    with replacing(out) as temporary:
        remembered = trained_on(result.model, data, model, models)
        save_model(remembered, temporary, outside_classes(models))
    return (
        f"{out}: {model}, trained on {', '.join(logs)}; fold {result.best + 1} of {len(folds)} is "
        f"best: training RMSE {result.train_rmse[result.best]:.2f} {data.unit}, validation "
        f"{result.validation_rmse[result.best]:.2f} {data.unit}\n"
    )


def predict(model: str, raw: str, *, config: Sequence[str] = (), out: str) -> str:
    """Compute the pressure P_ff that a trained model gives for a raw log."""
    refuse_output(out, ".csv")
    settings = _settings(config)
    models = settings.models.model_dump()
    fitted = load_model(model, outside_classes(models))
    name = next((n for n in entries(models) if load_class(n, models) is type(fitted)), None)
    if name is None:
        part = type(fitted).__name__
        raise FprcError(f"{model}: holds a {part}, a part of a model; train it again")
    inputs = entry_of(name, models).inputs
    data = _read([raw], settings, inputs)
    X, y, _ = data.samples(name, models)
    rate_hz = settings.control.sample_rate_hz
    refuse_other_data(fitted, f"{model}, the model", rate_hz, data.units(inputs))
    with threadpool_limits(1), refusals_of(fitted):
        output = fitted.predict(X)
    names = ("time_s", *inputs, "p_target_kpa")
    columns = {key: data.channels[key] for key in names} | {"p_ff_kpa": output}
    write_text(out, pd.DataFrame(columns).to_csv(index=False, lineterminator="\n"))
    return (
        f"{out}: {name} on {raw}, {len(y)} samples; RMSE against the "
        f"{'commanded' if data.attributes['target'] == 'command' else 'measured'} P_exp "
        f"{rmse(y, output):.2f} {data.unit}\n"
    )


def export(model: str, *, c: str, learn: bool = False, config: Sequence[str] = ()) -> None:
    """Turn a trained model into C code for a controller."""
    path, online = Path(c), None
    refuse_output(path, ".h")
    settings = _settings(config)
    fitted = load_model(model, outside_classes(settings.models.model_dump()))
    origin = f"From {Path(model).name}, SHA-256 {sha256(model)}, by fprc {__version__}."
    try:
        if learn:
            units = getattr(fitted, "units_", ())  # whatever they are, the header names them
            refuse_other_data(fitted, "the model", settings.control.sample_rate_hz, units)
            online = Track(settings.tracking, settings.control, {}, settings.seed).online(fitted)
        text = c_header(fitted, path.stem, origin=origin, online=online)
    except FprcError as error:
        raise FprcError(f"{model}: {error}") from error
    write_text(path, text)


def _settings(files: Sequence[str], **chosen: Any) -> Settings:
    """Return the settings of the files, or of the current folder, with what was chosen beside."""
    over = {name: value for name, value in chosen.items() if value is not None}
    return from_files(files, over)


def _read(logs: Sequence[str], settings: Settings, inputs: tuple[str, ...]) -> Data:
    """Read raw logs as the workflow's preprocessing does; several become one."""
    rate_hz, target = settings.control.sample_rate_hz, settings.evaluation.target
    how: dict[str, Any] = {"target": target, "sample_rate_hz": rate_hz, "limits": settings.quality}
    return read_recordings(logs, experiment=None, inputs=inputs, **how)[0]
