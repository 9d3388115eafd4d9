"""The whole comparison again with further seeds: other sensors, noise, drift and models."""

import logging
from collections.abc import Mapping
from itertools import chain
from typing import Any

from fprc.artifacts import write_json
from fprc.experiments.comparison import DIRECTIONS, INPUTS, Data, judge_directions
from fprc.experiments.hysteresis import acquire
from fprc.experiments.measures import measure_hysteresis, measure_runs
from fprc.experiments.readout import judge_readout
from fprc.experiments.sweeps import cells_of, judge_cell, weight_shares
from fprc.experiments.tracking import CONTROLLERS, Track, bench_gain
from fprc.models import SequenceModel
from fprc.stages.preprocess import TARGETS

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
    compared: str,
    cells: str,
    measures: str,
    *,
    signals: Mapping[str, Any],
    control: Mapping[str, Any],
    rig: Mapping[str, Any],
    target: str,
    models: Mapping[str, Any],
    values: Mapping[str, Any],
    tracking: Mapping[str, Any],
    folds: int,
    split: str,
    seed: int,
) -> None:
    """Repeat all but the execution times with another seed, from the experiments on.

    Writes Tables II and III and the weights of Fig. 9 (``compared``), the sweeps of
    Figs. 10 and 11 (``cells``), and the closed loops of Sec. IV (``measures``).
    """
    data = simulate(signals, control, rig, target, seed)
    judgement = (models, folds, split, seed)
    found, fprc = compare_models(data, *judgement)
    described = {"seed": seed, "source": "sim"}
    write_json(compared, described | found)
    write_json(cells, described | sweep_models(data, values, *judgement))
    bench = Track(tracking, control, rig, seed)
    write_json(measures, described | measure_control(data["sweep"], bench, fprc))


def compare_models(
    data: Mapping[str, Data], models: Mapping[str, Any], folds: int, split: str, seed: int
) -> tuple[dict[str, Any], SequenceModel]:
    """Return the errors of Tables II and III, the weights of Fig. 9, and the filter alone.

    The filter alone is FPRC with theta_d in place of P_o, trained on the sweep. With them
    comes the FPRC of the sweep, which drives the closed loops.
    """
    judgement = (models, folds, split, seed)
    found = {name: judge_directions(name, *judgement, data, DIRECTIONS) for name in INPUTS}
    in_order = chain.from_iterable(zip(*found.values(), strict=True))
    fprc = {
        "split": split,
        "readout": "theta",
        **{k: models["fprc"][k] for k in ("epsilon", "n_u")},
    }
    settings = {"models": models, "folds": folds, "seed": seed}
    compared = {
        "models": [judged.report for judged in in_order],
        "weights": weight_shares(data["sweep"], *judgement),
        "filter_alone": judge_readout(fprc, train=data["sweep"], test=data["complex"], **settings),
    }
    return compared, found["fprc"][0].judgement.model


def sweep_models(
    data: Mapping[str, Data],
    values: Mapping[str, Any],
    models: Mapping[str, Any],
    folds: int,
    split: str,
    seed: int,
) -> dict[str, list[dict[str, Any]]]:
    """Return the cells of every sweep, the tap sizes on a coarser grid."""
    coarse = dict(values) | {"n_u": values["replicate_taps"], "n_y": values["replicate_taps"]}
    settings = {"models": models, "folds": folds, "split": split, "seed": seed}
    found = {}
    for sweep in ("epsilon", "n_c", "taps"):
        found[sweep] = [
            {**cell, **judge_cell(cell, train=data["sweep"], test=data["complex"], **settings)}
            for cell in cells_of(sweep, coarse)
        ]
        log.info("swept %s: %d cells", sweep, len(found[sweep]))
    return found


def measure_control(sweep: Data, bench: Track, fprc: SequenceModel) -> dict[str, Any]:
    """Follow every reference with every controller; return what the claims measure."""
    gains = bench_gain(bench, fprc)
    runs = {}
    for reference, described in bench.tracking["references"].items():
        for name, (controller, gain) in CONTROLLERS.items():
            channels = bench.follow(reference, name, fprc, gains)
            after = channels["time_s"] >= described["settle_s"]
            run = {channel: values[after] for channel, values in channels.items()}
            runs[f"{reference}/{controller}/{gain}"] = run
        log.info("followed %s with every controller", reference)
    return {
        "gains": {name: gains[name] for name in ("printed", "identified")},
        "hysteresis": measure_hysteresis(sweep.channels),
        **measure_runs(runs, bench.tracking["pushes"]["quiet_s"]),
    }
