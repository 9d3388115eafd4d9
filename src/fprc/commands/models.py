"""`fprc train` and `fprc predict`: a model from raw logs to predictions, without Snakemake."""

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd
from threadpoolctl import threadpool_limits

from fprc.artifacts import refuse_output, replacing, write_text
from fprc.config import Settings, from_files, local_files
from fprc.errors import ConfigError, FprcError
from fprc.escape import in_words
from fprc.evaluation import rmse
from fprc.evaluation.crossval import learn, refusals_of
from fprc.experiments.data import Data, join
from fprc.experiments.settings import CrossValidation
from fprc.experiments.trained import refuse_other_data, trained_on
from fprc.given import refuse_repeats
from fprc.models import SequenceModel, load_model, save_model
from fprc.plan.arguments import validation
from fprc.registry import build, entries, entry_of, load_class, outside_classes
from fprc.stages.preprocess import read_recordings


def train(
    logs: Sequence[str],
    *,
    model: str = "fprc",
    seed: int | None = None,
    config: Sequence[str] = (),
    out: str,
) -> None:
    """Train a model on raw logs."""
    refuse_output(out, ".h5")
    refuse_repeats(logs, "its samples would train and validate at once")
    chosen = {} if seed is None else {"seed": seed}
    settings = from_files(config or local_files(), chosen)
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
    report = (
        f"{out}: {model}, trained on {', '.join(logs)}; fold {result.best + 1} of {len(folds)} is "
        f"best: training RMSE {result.train_rmse[result.best]:.2f} {data.unit}, validation "
        f"{result.validation_rmse[result.best]:.2f} {data.unit}"
    )
    print(report)


def predict(model: str, raw: str, *, config: Sequence[str] = (), out: str) -> None:
    """Compute the pressure P_ff that a trained model gives for a raw log."""
    refuse_output(out, ".csv")
    settings = from_files(config or local_files())
    models = settings.models.model_dump()
    fitted = load_model(model, outside_classes(models))
    name = _name_of(fitted, model, models)
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
    report = (
        f"{out}: {name} on {raw}, {len(y)} samples; RMSE against the "
        f"{'commanded' if data.attributes['target'] == 'command' else 'measured'} P_exp "
        f"{rmse(y, output):.2f} {data.unit}"
    )
    print(report)


def _read(logs: Sequence[str], settings: Settings, inputs: tuple[str, ...]) -> Data:
    """Read raw logs as the workflow's preprocessing does; several become one."""
    rate_hz = settings.control.sample_rate_hz
    recordings, _ = read_recordings(
        logs,
        experiment=None,
        target=settings.evaluation.target,
        sample_rate_hz=rate_hz,
        limits=settings.quality,
        inputs=inputs,
    )
    if len(recordings) == 1:
        return recordings[0]
    return join(dict(zip(logs, recordings, strict=True)), 1.0 / rate_hz)


def _name_of(fitted: SequenceModel, path: str, models: Mapping[str, Any]) -> str:
    """Return the name of a model's class in the configuration."""
    for name in entries(models):
        if load_class(name, models) is type(fitted):
            return name
    raise FprcError(f"{path}: holds a {type(fitted).__name__}, a part of a model; train it again")
