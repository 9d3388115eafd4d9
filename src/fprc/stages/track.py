"""Closed-loop runs of Sec. IV, and the gains of their PD controllers."""

import logging
from collections.abc import Mapping, Sequence
from typing import Any

from fprc.artifacts import read_json, write_json
from fprc.control import RunAbortedError
from fprc.errors import LogError
from fprc.experiments.tracking import Track, bench_gain, identified, tracking_rmse
from fprc.logs import read_run, write_raw
from fprc.logs.isolated import isolated_each
from fprc.models import load_model
from fprc.paper import controller_and_gain
from fprc.registry import feedforward_of, outside_class

log = logging.getLogger(__name__)

_GAINS = ("kp_kpa_per_deg", "kd_kpa_s_per_deg")


def identify_gain(
    model: str,
    gains: str,
    *,
    tracking: Mapping[str, Any],
    control: Mapping[str, Any],
    rig: Mapping[str, Any],
    seed: int,
) -> None:
    """Find the P gain with the least error on a reference outside Table IV.

    The D gain keeps its printed ratio to the P gain.
    """
    bench = Track(tracking, control, rig, seed)
    write_json(gains, bench_gain(bench, load_model(model)))


def identify_gain_from_logs(raw: Sequence[str], gains: str, *, tracking: Mapping[str, Any]) -> None:
    """Find the P gain with the least error in the logs of a real rig, one for each candidate."""
    tried = []
    names = ("time_s", "theta_d_deg", "theta_deg")
    for run in isolated_each(read_run, raw, names=names):
        gains_of_run = gains_of(run.attributes)
        if gains_of_run is None:
            raise LogError(f"{run.path}: attribute rig has no PD gains; record the log again")
        error = tracking_rmse(run.channels, run.attributes["settle_s"])
        tried.append({**gains_of_run, "rmse_deg": error})
    gain = identified(tried, tracking["printed_gains"])
    write_json(gains, gain | {"source": "rig"})


def track(
    models: Sequence[str],
    gains: str,
    raw: Sequence[str],
    *,
    reference: str,
    names: Sequence[str],
    controllers: Sequence[str],
    tracking: Mapping[str, Any],
    control: Mapping[str, Any],
    rig: Mapping[str, Any],
    seed: int,
    classes: Mapping[str, Any] | None = None,
) -> None:
    """Follow one reference with every controller, and write one raw log for each.

    Parameters
    ----------
    models, names : sequences of str
        Files of the feedforward models, and their names.
    classes : Mapping, optional
        The section ``models`` of the configuration, for models from outside this package.

    Raises
    ------
    ControlError
        The reference is impossible, or a run was aborted; its samples are then
        kept next to the log as ``*.aborted.h5``.
    """
    bench = Track(tracking, control, rig, seed)
    fitted = {
        name: load_model(path, outside_class(name, classes or {}))
        for name, path in zip(names, models, strict=True)
    }
    known_gains = read_json(gains)
    for path, name in zip(raw, controllers, strict=True):
        described = bench.describe(reference, name, known_gains)
        described |= {"source": "sim", "rig": {"rig": rig, **described["rig"]}}
        feedforward = feedforward_of(controller_and_gain(name)[0])
        model = fitted[feedforward] if feedforward else None
        try:
            channels = bench.follow(reference, name, model, known_gains)
        except RunAbortedError as stopped:
            rescued = f"{path.removesuffix('.h5')}.aborted.h5"
            write_raw(rescued, stopped.channels, **described, aborted=str(stopped))
            log.error("the recorded samples are kept in %s", rescued)
            raise
        write_raw(path, channels, **described)
        log.info("%s: RMSE %.3f deg", name, tracking_rmse(channels, described["settle_s"]))


def read_gains(runs: Sequence[str], gains: str) -> None:
    """Collect the gains of the PD controllers from closed-loop logs, by name.

    Gains that the logs do not state, or for which they state different values, are left out
    with a warning.

    Raises
    ------
    LogError
        A log cannot be read, or some are simulated and others are not.
    """
    values_of: dict[str, list[Any]] = {}
    logs = isolated_each(read_run, runs, names=())
    kinds = {run.attributes["source"]: str(run.path) for run in logs}
    if len(kinds) > 1:
        each = ", ".join(f"{source} ({path})" for source, path in kinds.items())
        raise LogError(f"closed-loop logs of different sources: {each}; use logs of one kind")
    for run in logs:
        different = values_of.setdefault(run.attributes["gain"], [])
        if (gains_of_run := gains_of(run.attributes)) not in different:
            different.append(gains_of_run)
    values_of.pop("none", None)  # the gain of open loops
    known = {
        name: values[0] for name, values in values_of.items() if len(values) == 1 and values[0]
    }
    for name in values_of:
        if name not in known:
            log.warning("warning: the logs do not agree on the %s gains; they are left out", name)
    first = logs[0].attributes
    origin = {"candidates": [], "source": first["source"], "seed": int(first["seed"])}
    write_json(gains, known | origin)


def gains_of(attributes: Mapping[str, Any]) -> dict[str, float] | None:
    """Return the PD gains in the attributes of a closed-loop log; None if there are none."""
    gains = attributes["rig"].get("gains")
    values: list[Any] = [gains.get(key) for key in _GAINS] if isinstance(gains, Mapping) else [None]
    if not all(isinstance(value, float | int) for value in values):
        return None
    return dict(zip(_GAINS, map(float, values), strict=True))
