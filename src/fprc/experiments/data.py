"""Preprocessed logs, the input of the models.

They are made of raw logs, or simulated; a trained model knows rate and units of its log.
"""

import logging
import math
from collections.abc import Container, Mapping, Sequence
from typing import Any, Literal, NamedTuple

import numpy as np

from fprc.artifacts import write_json
from fprc.channels import TARGETS, unit_of
from fprc.config.section import Section
from fprc.config.settings import Control, Quality, Signal
from fprc.devices.sim import SimulatedRig
from fprc.errors import FprcError, LogError
from fprc.logs import Columns, assess, read_columns, read_raw, write_columns
from fprc.logs.columns import read_each
from fprc.logs.quality import noted_unit, substitute, warnings
from fprc.registry import entries, entry_of
from fprc.signals import pressure_command

log = logging.getLogger(__name__)

#: Run number of each experiment; with the seed it sets the noise of the run.
RUNS = {"sweep": 0, "complex": 1}


class Data(NamedTuple):
    """One preprocessed log, of one or more recordings; ``p_target_kpa`` is the P_exp to learn."""

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


def preprocess(
    data: Sequence[str],
    quality: Sequence[str],
    sweep: Sequence[str] = (),
    complex: Sequence[str] = (),
    *,
    limits: Quality,
    **how: Any,
) -> None:
    """Write the models' channels of raw logs and the quality records, see ``read_recordings``.

    Nothing is filtered here: filter and taps are parts of the models, since the control loop
    needs the same ones.
    """
    raw = {name: paths for name, paths in (("sweep", sweep), ("complex", complex)) if paths}

    def read(name: str) -> Any:
        return read_recordings(raw[name], experiment=name, limits=limits, **how)

    logs = read_each(read, [*raw])
    for (found, reports), samples, record in zip(logs, data, quality, strict=True):
        write_json(record, {"recordings": reports})
        write_columns(samples, found.channels, found.attributes)


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

    ``experiment`` is that which is expected, or None; ``target`` and ``inputs`` are those of
    ``select_channels``. LogError lists every log that cannot be read, or that differs.
    """
    asked = {"sample_rate_hz": sample_rate_hz, "rate_tolerance": limits.rate_tolerance}
    recordings, reports = [], []
    for source in read_each(read_raw, paths, experiment=experiment, **asked):
        report = assess(source, limits, sample_rate_hz)
        for warning in warnings(report):
            log.warning("warning: %s", warning)
        recordings.append(select_channels(source, target, inputs))
        reports.append(report)
    return join(recordings, 1.0 / sample_rate_hz), reports


def select_channels(
    source: Columns, target: str, inputs: Sequence[str] = ("theta_deg", "p_o_kpa")
) -> Data:
    """Return the channels and attributes of a raw log that the models need.

    The target is the P_exp to learn, ``command`` or ``measured``; an imported log may have only
    one, which is used then. A warning names the ``inputs`` that hold another quantity.
    """
    if TARGETS[target] not in source.channels:
        log.warning("warning: no %s in %s; the other P_exp is used", TARGETS[target], source.path)
        target = next(name for name in TARGETS if name != target)
    for name in (TARGETS[target], *inputs):
        if (other := substitute(name, source.attributes)) is not None:
            log.warning("warning: %s: not in %s: %s", name, unit_of(name), other)
    channels = {"p_target_kpa": source.channels[TARGETS[target]]}
    taken = ("time_s", "theta_deg", "p_o_kpa")
    channels |= {name: source.channels[name] for name in taken if name in source.channels}
    of = {"p_target": TARGETS[target], "theta": "theta_deg", "p_o": "p_o_kpa"}
    units = {f"{name}_unit": noted_unit(of[name], source.attributes) for name in of}
    kept = ("experiment", "source", "sample_rate_hz", "seed", "notes")
    attributes = {name: source.attributes[name] for name in kept if name in source.attributes}
    return Data(channels, {**attributes, "target": target, **units}, str(source.path))


def join(logs: Sequence[Data], period_s: float) -> Data:
    """Return several recordings as one log; its attribute ``recordings`` has their lengths.

    Each begins one period after the end of the one before it. They must agree in source, target,
    units and channels. One alone is returned as it is.
    """
    first = logs[0]
    if len(logs) == 1:
        return first
    refuse_mixture(*logs, names=_kind(first))
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
    return Data(channels, {**first.attributes, "recordings": lengths}, ", ".join(lengths))


def refuse_mixture(
    first: Data, *others: Data, names: Container[str] = ("source", "unit of P_exp")
) -> None:
    """Refuse logs that are not of one kind: in all that ``_kind`` returns, or in these names."""
    ours = _kind(first)
    problems = [
        f"{data.name}: {name} is {theirs}, in {first.name} {ours[name]}; use logs of one kind"
        for data in others
        for name, theirs in _kind(data).items()
        if name in names and theirs != ours[name]
    ]
    if problems:
        raise LogError("\n".join(problems))


def _kind(data: Data) -> dict[str, Any]:
    """Return what logs of one kind have in common, by the names that readers see."""
    return {
        "source": data.attributes.get("source"),
        "target": data.attributes.get("target"),
        "unit of P_exp": data.unit,
        "unit of theta": data.attributes.get("theta_unit"),
        "unit of P_o": data.attributes.get("p_o_unit"),
        "list of channels": ", ".join(sorted(data.channels)),
    }


def models_for(models: Mapping[str, Any], *logs: Data) -> list[str]:
    """Return the models whose inputs are in every one of the logs."""
    return [
        model
        for model, entry in entries(models).items()
        if all(name in data.channels for data in logs for name in entry.inputs)
    ]


class RigSettings(Section):
    """Settings for the simulation of the hysteresis experiments."""

    rig: dict[str, Any]  #: section of the configuration, or a rig of a search
    control: Control
    signals: dict[str, Signal]  #: pressure signal of each experiment
    target: Literal["command", "measured"]  #: P_exp that the models learn


def simulate(settings: RigSettings, seed: int) -> dict[str, Data]:
    """Return both hysteresis experiments as preprocessed logs."""
    data = {}
    for experiment, signal in settings.signals.items():
        channels = acquire(experiment, signal, settings.control, settings.rig, seed)
        channels["p_target_kpa"] = channels[TARGETS[settings.target]]
        attributes = {"experiment": experiment, "source": "sim", "target": settings.target}
        data[experiment] = Data(channels, {**attributes, "seed": seed})
    return data


def acquire(
    experiment: str, signal: Signal, control: Control, rig: Mapping[str, Any], seed: int
) -> dict[str, np.ndarray]:
    """Return the channels of one hysteresis experiment on the simulated rig."""
    rate_hz = control.sample_rate_hz
    device = SimulatedRig(rig, seed=seed, run=RUNS[experiment], sample_rate_hz=rate_hz)
    return device.follow(control, pressure_command(signal, rate_hz))


def trained_on(model: Any, data: Data, name: str, models: Mapping[str, Any] | None = None) -> Any:
    """Return a fitted model that knows the sample rate and the units of its data.

    It remembers the data too if it can learn online.
    """
    model.sample_rate_hz_ = 1.0 / data.period_s
    model.units_ = np.array(data.units(entry_of(name, models).inputs), dtype=object)
    if model.learns_online():
        X, _, lengths = data.samples(name, models)
        return model.remember(X, lengths)
    return model


def refuse_other_data(model: Any, which: str, sample_rate_hz: float, units: Sequence[str]) -> None:
    """Refuse a model that knows to be trained at another rate or in other units, P_exp's first."""
    trained_hz = getattr(model, "sample_rate_hz_", sample_rate_hz)
    if not math.isclose(trained_hz, sample_rate_hz, rel_tol=1e-3):
        raise FprcError(
            f"{which}, was trained at {trained_hz:g} Hz, and control.sample_rate_hz is "
            f"{sample_rate_hz:g}; train it again at this rate, or change the setting"
        )
    trained = list(getattr(model, "units_", units))
    if trained != list(units):
        theirs, ours = (f"{first} from {', '.join(others)}" for first, *others in (trained, units))
        raise FprcError(
            f"{which}, was trained to give {theirs}, and here must give {ours}; train it again on "
            "logs in these units"
        )
