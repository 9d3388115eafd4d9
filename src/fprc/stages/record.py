"""Run experiments on the simulated rig and write their raw logs."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from fprc.config.settings import Control, Signal, Tracking
from fprc.experiments.data import acquire
from fprc.experiments.tracking import Track, describe_model
from fprc.logs import write_raw
from fprc.models import load_model
from fprc.paper import reference_and_controller
from fprc.registry import feedforward_of, outside_classes


def record(
    raw: Sequence[str],
    *,
    signals: Mapping[str, Signal],
    control: Control,
    rig: Mapping[str, Any],
    seed: int,
) -> None:
    """Record hysteresis experiments (Sec. II-B), each with its signal into its file."""
    for path, (experiment, signal) in zip(raw, signals.items(), strict=True):
        channels = acquire(experiment, signal, control, rig, seed)
        read = {"control": control, "signal": signal}
        dumped = {k: of.model_dump(mode="json", exclude_unset=True) for k, of in read.items()}
        write_raw(
            path, channels, experiment=experiment, source="sim", seed=seed,
            sample_rate_hz=control.sample_rate_hz, rig={"rig": rig, **dumped},
        )  # fmt: skip


def track(
    models: Sequence[str],
    raw: Sequence[str],
    *,
    tracking: Tracking,
    control: Control,
    rig: Mapping[str, Any],
    seed: int,
    others: Mapping[str, Any],
) -> None:
    """Follow references with controllers (Sec. IV), and write one raw log per run.

    The names of the ``raw`` logs say which runs they are. ``models`` are those of the controllers,
    in their order, ``others`` is the section ``models.others``.
    """
    runs: dict[str, dict[str, str]] = {}
    for path in raw:
        reference, controller = reference_and_controller(Path(path).stem)
        runs.setdefault(reference, {})[controller] = path
    driven = filter(None, map(feedforward_of, next(iter(runs.values()))))
    files = dict(zip(dict.fromkeys(driven), models, strict=True))
    outside = outside_classes({"others": others})
    fitted = {name: load_model(path, outside) for name, path in files.items()}
    bench = Track(tracking, control, rig, seed)
    for reference, paths in runs.items():
        for controller, channels in bench.follow(reference, [*paths], fitted).items():
            described = bench.describe(reference, controller)
            described |= {"source": "sim", "rig": {"rig": rig, **described["rig"]}}
            if feedforward := feedforward_of(controller):
                described |= describe_model(fitted[feedforward], files[feedforward])
            write_raw(paths[controller], channels, **described)
