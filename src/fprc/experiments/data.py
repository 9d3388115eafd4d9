"""Preprocessed logs, the input of the models."""

import logging
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from fprc.channels import TARGETS, unit_of
from fprc.errors import LogError
from fprc.logs import Columns, read_columns
from fprc.logs.quality import noted_unit, substitute
from fprc.registry import entries, entry_of

log = logging.getLogger(__name__)


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
    kept = ("experiment", "source", "sample_rate_hz", "seed", "notes")
    attributes = {name: source.attributes[name] for name in kept if name in source.attributes}
    of = {"p_target": TARGETS[target], "theta": "theta_deg", "p_o": "p_o_kpa"}
    units = {f"{name}_unit": noted_unit(of[name], source.attributes) for name in of}
    channels = {
        "time_s": source.channels["time_s"],
        "p_target_kpa": source.channels[of["p_target"]],
    }
    channels |= {k: source.channels[k] for k in ("theta_deg", "p_o_kpa") if k in source.channels}
    return Data(channels, {**attributes, "target": target, **units}, str(source.path))


def join(logs: Mapping[str, Data], period_s: float) -> Data:
    """Return several recordings as one log; its attribute ``recordings`` has their lengths.

    Each begins one period after the end of the one before it. They must agree in source, target,
    units and channels.
    """
    (first, one), *others = logs.items()
    problems = [
        f"{name}: {what} is {_kind(other)[what]}, in {first} {ours}; training logs must agree"
        for name, other in others
        for what, ours in _kind(one).items()
        if ours != _kind(other)[what]
    ]
    if problems:
        raise LogError("\n".join(problems))
    begin, parts = 0.0, []
    for data in logs.values():
        time_s = data.channels["time_s"]
        parts.append({**data.channels, "time_s": time_s - time_s[0] + begin})
        begin = float(parts[-1]["time_s"][-1]) + period_s
    channels = {name: np.concatenate([part[name] for part in parts]) for name in one.channels}
    lengths = {name: len(data.channels["time_s"]) for name, data in logs.items()}
    return Data(channels, {**one.attributes, "recordings": lengths}, ", ".join(logs))


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
