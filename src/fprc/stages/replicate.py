"""The whole comparison again with further seeds: other sensors, noise, drift and models."""

import hashlib
import json
import logging
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

from fprc.artifacts import write_json
from fprc.claims.measures import measure_hysteresis, measure_runs
from fprc.evaluation.sweeps import run_cells
from fprc.stages.judge import DIRECTIONS, INPUTS, Data, judge_directions, judge_model
from fprc.stages.preprocess import TARGETS
from fprc.stages.readout import judge_readout
from fprc.stages.record import acquire
from fprc.stages.sweep import cells_of, judge_cell, report_progress, weight_shares
from fprc.stages.track import CONTROLLERS, Track, bench_gain

log = logging.getLogger(__name__)


def simulate(
    signals: Mapping[str, Any],
    control: Mapping[str, Any],
    rig: Mapping[str, Any],
    target: str,
    seed: int,
) -> dict[str, Data]:
    """Return both hysteresis experiments with another seed."""
    data = {}
    for experiment, signal in signals.items():
        channels = acquire(experiment, signal, control, rig, seed)
        channels["p_exp_kpa"] = channels[TARGETS[target]]
        attributes = {"experiment": experiment, "source": "sim", "target": target, "seed": seed}
        data[experiment] = Data(channels, attributes)
    return data


def replicate(
    errors: str,
    *,
    signals: Mapping[str, Any],
    control: Mapping[str, Any],
    rig: Mapping[str, Any],
    target: str,
    models: Mapping[str, Any],
    folds: int,
    split: str,
    seed: int,
) -> None:
    """Repeat Tables II and III and the weights of Fig. 9."""
    data = simulate(signals, control, rig, target, seed)
    compared = compare_models(data, models, folds, split, seed)
    write_json(errors, {"seed": seed, "source": "sim", **compared})


def compare_models(
    data: Mapping[str, Data], models: Mapping[str, Any], folds: int, split: str, seed: int
) -> dict[str, Any]:
    """Return the errors of Tables II and III, the weights of Fig. 9, and the filter alone.

    The filter alone is FPRC with theta_d in place of P_o, trained on the sweep.
    """
    judgement = (models, folds, split, seed)
    found = {name: judge_directions(name, *judgement, data, DIRECTIONS) for name in INPUTS}
    reports = [found[name][i][1] for i in range(len(DIRECTIONS)) for name in INPUTS]
    fprc = {
        "split": split,
        "readout": "theta",
        **{k: models["fprc"][k] for k in ("epsilon", "n_u")},
    }
    settings = {"models": models, "folds": folds, "seed": seed}
    return {
        "models": reports,
        "weights": weight_shares(data["sweep"], *judgement),
        "filter_alone": judge_readout(fprc, train=data["sweep"], test=data["complex"], **settings),
    }


def replicate_sweeps(
    cells: str,
    *,
    signals: Mapping[str, Any],
    control: Mapping[str, Any],
    rig: Mapping[str, Any],
    target: str,
    models: Mapping[str, Any],
    values: Mapping[str, Any],
    folds: int,
    split: str,
    seed: int,
    checkpoint: str,
    version: str,
) -> None:
    """Repeat the sweeps of Figs. 10 and 11, the tap sizes on a coarser grid."""
    rig_settings = {"signals": signals, "control": control, "rig": rig, "target": target}
    judgement = {"models": models, "folds": folds, "split": split, "seed": seed}
    key = json.dumps([rig_settings, judgement, version], sort_keys=True)
    coarse = dict(values) | {"n_u": values["replicate_taps"], "n_y": values["replicate_taps"]}
    planned = {sweep: cells_of(sweep, coarse) for sweep in ("epsilon", "n_c", "taps")}
    data = simulate(**rig_settings, seed=seed)
    judged = run_cells(
        partial(judge_cell, train=data["sweep"], test=data["complex"], **judgement),
        sum(planned.values(), []),
        workers=1,
        checkpoint=checkpoint,
        key=hashlib.sha256(key.encode()).hexdigest(),
        progress=report_progress,
    )
    remaining = iter(judged)
    found = {sweep: [next(remaining) for _ in group] for sweep, group in planned.items()}
    write_json(cells, {"seed": seed, "source": "sim", **found})
    Path(checkpoint).unlink()


def replicate_control(
    measures: str,
    *,
    signals: Mapping[str, Any],
    tracking: Mapping[str, Any],
    control: Mapping[str, Any],
    rig: Mapping[str, Any],
    target: str,
    models: Mapping[str, Any],
    folds: int,
    split: str,
    seed: int,
) -> None:
    """Repeat the closed-loop runs of Sec. IV, gain and all, and measure them."""
    data = simulate(signals, control, rig, target, seed)
    bench = Track(tracking, control, rig, seed)
    measured = measure_control(data, bench, models, folds, split)
    write_json(measures, {"seed": seed, "source": "sim", **measured})


def measure_control(
    data: Mapping[str, Data], bench: Track, models: Mapping[str, Any], folds: int, split: str
) -> dict[str, Any]:
    """Follow every reference with every controller; return what the claims measure."""
    judged, *_ = judge_model(
        "fprc", models, folds, split, bench.seed, data["sweep"], data["complex"]
    )
    gains = bench_gain(bench, judged.model)
    runs = {}
    for reference, described in bench.tracking["references"].items():
        for name, (controller, gain) in CONTROLLERS.items():
            channels = bench.follow(reference, name, judged.model, gains)
            after = channels["time_s"] >= described["settle_s"]
            run = {channel: values[after] for channel, values in channels.items()}
            runs[f"{reference}/{controller}/{gain}"] = run
        log.info("followed %s with every controller", reference)
    return {
        "gains": {name: gains[name] for name in ("printed", "identified")},
        "hysteresis": measure_hysteresis(data["sweep"].channels),
        **measure_runs(runs, bench.tracking["pushes"]["quiet_s"]),
    }
