"""Preprocessed logs, the input of the models."""

import logging
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from fprc.artifacts import write_json
from fprc.channels import TARGETS, unit_of
from fprc.config.settings import Quality
from fprc.errors import LogError
from fprc.logs import Columns, assess, read_columns, read_raw, write_columns
from fprc.logs.columns import read_each
from fprc.logs.quality import noted_unit, substitute, warnings
from fprc.registry import entries, entry_of

log = logging.getLogger(__name__)

#: Channels of a raw log that are kept, beside P_exp.
_TAKEN = ("time_s", "theta_deg", "p_o_kpa")


class Data(NamedTuple):
    """One preprocessed log; its channel ``p_target_kpa`` is P_exp, commanded or measured.

    It may hold several recordings, one after the other.
    """

    channels: Mapping[str, np.ndarray]
    attributes: Mapping[str, Any]
    name: str = "log"  #: its files, for messages

    @property
    def lengths(self) -> list[int]:
        """Number of samples of each recording."""
        several = self.attributes.get("recordings")
        return list(several.values()) if several else [len(self.channels["time_s"])]

    @property
    def period_s(self) -> float:
        """Mean time from one sample to the next, s."""
        time_s = self.channels["time_s"]
        return float(time_s[-1] - time_s[0]) / (len(time_s) - 1)

    @property
    def unit(self) -> str:
        """Unit of P_exp, and so of every error: kPa, unless an import gives another."""
        return self.attributes.get("p_target_unit", "kPa")

    def units(self, inputs: Sequence[str]) -> list[str]:
        """Return the units of P_exp and of channels."""
        return [
            self.attributes.get(f"{name.rpartition('_')[0]}_unit", unit_of(name))
            for name in ("p_target_kpa", *inputs)
        ]

    def samples(
        self, model: str, models: Mapping[str, Any] | None = None
    ) -> tuple[np.ndarray, np.ndarray, list[int]]:
        """Return the inputs of a model, P_exp, and the samples of each recording."""
        inputs = entry_of(model, models).inputs
        missing = [name for name in inputs if name not in self.channels]
        if missing:
            raise LogError(
                f"{self.name}: no {', '.join(missing)}, which {model} needs; use another model"
            )
        X = np.column_stack([self.channels[name] for name in inputs])
        return X, self.channels["p_target_kpa"], self.lengths


def read_data(path: str) -> Data:
    """Read a preprocessed log."""
    file = read_columns(path, ("time_s", "p_target_kpa", "theta_deg"), optional=("p_o_kpa",))
    return Data(file.channels, file.attributes, path)


def preprocess(raw: Sequence[str], data: str, quality: str, *, limits: Quality, **how: Any) -> None:
    """Write the models' channels of raw logs and the quality records, see ``read_recordings``.

    Nothing is filtered here: filter and taps are parts of the models, since the control loop
    needs the same ones.
    """
    read, reports = read_recordings(raw, limits=limits, **how)
    write_json(quality, {"recordings": reports})
    write_columns(data, read.channels, read.attributes)


def read_recordings(
    paths: Sequence[str],
    *,
    experiment: str | None,
    target: str,
    sample_rate_hz: float,
    limits: Quality,
    inputs: Sequence[str] = ("theta_deg", "p_o_kpa"),
) -> tuple[Data, list[dict[str, Any]]]:
    """Return the models' channels of raw logs, which become one log, and their quality records.

    ``experiment`` is that which is expected, or None; ``target`` and ``inputs`` are as
    ``select_channels`` takes them.

    Raises
    ------
    LogError
        Lists every log that cannot be read; or they differ in source, target, units or channels.
    """
    asked = {"sample_rate_hz": sample_rate_hz, "rate_tolerance": limits.rate_tolerance}
    recordings, reports = [], []
    for source in read_each(read_raw, paths, experiment=experiment, **asked):
        report = assess(source, limits, sample_rate_hz)
        for warning in warnings(report):
            log.warning("warning: %s", warning)
        passed = sum(check["passed"] for check in report["checks"].values())
        log.info("%d of %d quality checks passed", passed, len(report["checks"]))
        recordings.append(select_channels(source, target, inputs))
        reports.append(report)
    several = len(recordings) > 1
    return join(recordings, 1.0 / sample_rate_hz) if several else recordings[0], reports


def select_channels(
    source: Columns, target: str, inputs: Sequence[str] = ("theta_deg", "p_o_kpa")
) -> Data:
    """Return the channels and attributes of a raw log that the models need.

    The target is the P_exp that the models learn, ``command`` or ``measured``. An imported log may
    have only one; then that one is used. Of ``inputs`` it is warned if they hold another quantity.
    """
    if TARGETS[target] not in source.channels:
        log.warning("warning: no %s in %s; the other P_exp is used", TARGETS[target], source.path)
        target = next(name for name in TARGETS if name != target)
    for name in (TARGETS[target], *inputs):
        if (other := substitute(name, source.attributes)) is not None:
            log.warning("warning: %s: not in %s: %s", name, unit_of(name), other)
    channels = {"p_target_kpa": source.channels[TARGETS[target]]}
    channels |= {k: source.channels[k] for k in _TAKEN if k in source.channels}
    of = {"p_target": TARGETS[target], "theta": "theta_deg", "p_o": "p_o_kpa"}
    units = {f"{name}_unit": noted_unit(of[name], source.attributes) for name in of}
    kept = ("experiment", "source", "sample_rate_hz", "seed", "notes")
    attributes = {name: source.attributes[name] for name in kept if name in source.attributes}
    return Data(channels, {**attributes, "target": target, **units}, str(source.path))


def join(logs: Sequence[Data], period_s: float) -> Data:
    """Return several recordings as one log; its attribute ``recordings`` has their lengths.

    Each begins one period after the end of the one before it. They must agree in source, target,
    units and channels.
    """
    first = logs[0]
    problems = [
        f"{data.name}: {what} is {theirs}, in {first.name} {ours}; training logs must agree"
        for data in logs[1:]
        for (what, ours), theirs in zip(_kind(first).items(), _kind(data).values(), strict=True)
        if ours != theirs
    ]
    if problems:
        raise LogError("\n".join(problems))
    begin, times = 0.0, []
    for data in logs:
        time_s = data.channels["time_s"]
        times.append(time_s - time_s[0] + begin)
        begin = float(times[-1][-1]) + period_s
    channels = {
        name: np.concatenate([data.channels[name] for data in logs]) for name in first.channels
    }
    channels["time_s"] = np.concatenate(times)
    lengths = {data.name: len(data.channels["time_s"]) for data in logs}
    names = ", ".join(lengths)
    return Data(channels, {**first.attributes, "recordings": lengths}, names)


def _kind(data: Data) -> dict[str, Any]:
    """Return what logs that train one model have in common."""
    names = ("source", "target", "p_target_unit", "theta_unit", "p_o_unit")
    channels = {"list of channels": ", ".join(sorted(data.channels))}
    return {name: data.attributes.get(name) for name in names} | channels


def models_for(models: Mapping[str, Any], *logs: Data) -> list[str]:
    """Return the models whose inputs are in every one of the logs."""
    return [
        model
        for model, entry in entries(models).items()
        if all(name in data.channels for data in logs for name in entry.inputs)
    ]


def refuse_mixture(train: Data, test: Data) -> None:
    """Refuse a training log and a test log of different sources, or units of P_exp."""
    ours, theirs = (f"{data.attributes['source']}, {data.unit}" for data in (train, test))
    if ours != theirs:
        raise LogError(
            f"source and unit of P_exp are {ours} in the training log, and {theirs} in the test "
            "log; use two logs of one kind"
        )
