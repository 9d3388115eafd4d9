"""Fit the simulated rig to published numbers, and write what came of it."""

import hashlib
import json
import logging
import os
import textwrap
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from joblib import Parallel, delayed, parallel_config
from threadpoolctl import threadpool_limits

from fprc import __version__
from fprc.artifacts import write_json, write_text
from fprc.calibration import (
    Free,
    Target,
    decode,
    encode,
    loss_of,
    properties,
    residuals,
    search,
    surrogate_errors,
)
from fprc.config import check, from_files
from fprc.config.free import free_ranges
from fprc.config.rig import Rig
from fprc.errors import ConfigError, FprcError
from fprc.experiments.comparison import DIRECTIONS, INPUTS, judge_directions
from fprc.fingerprint import fingerprint
from fprc.paper import PRINTED
from fprc.provenance import hash_of
from fprc.stages.replicate import simulate
from fprc.yaml_file import read_yaml

log = logging.getLogger(__name__)

#: Loss of a rig that cannot be simulated or breaks a rule of the configuration.
IMPOSSIBLE = 100.0


def calibrate(
    published: str,
    fitted: str,
    report: str,
    *,
    rig: Mapping[str, Any],
    signals: Mapping[str, Any],
    control: Mapping[str, Any],
    target: str,
    models: Mapping[str, Any],
    calibration: Mapping[str, Any],
    folds: int,
    split: str,
    workers: int,
    checkpoint: str,
    version: str,
) -> None:
    """Fit the free parameters by CMA-ES, beginning at ``rig``.

    The stand-in of the models is first compared with the full models on the
    rig that the search begins at; their ratios correct it. At the end the
    full models judge the fitted rig on the seeds of the objective.

    Writes the changed parameters (``fitted``, YAML, to be used as
    config/rig.yaml) and all that is known of the fit (``report``, JSON).
    """
    printed = read_yaml(published)
    aim = target_of(printed, calibration)
    free = free_parameters(calibration["free"], calibration["ranges"])
    experiments = {"signals": signals, "control": control, "target": target}
    judgement = {"models": models, "folds": folds, "split": split}
    standin = {key: calibration[key] for key in ("stride", "esn_nodes")}
    seeds = calibration["seeds"]

    log.info("full models on the rig that the search begins at")
    start = encode(rig, free)
    begun_at = decode(start, rig, free)
    full = full_errors(begun_at, seeds[:2], workers, experiments, judgement)
    cheap = [judge_cheaply(begun_at, s, experiments, models, standin)[0] for s in seeds[:2]]
    ratios = {
        key: float(np.mean([e[key] for e in full]) / np.mean([e[key] for e in cheap]))
        for key in aim.errors
    }
    loss = partial(
        loss_at,
        rig=rig,
        free=free,
        seeds=seeds,
        aim=aim,
        ratios=ratios,
        experiments=experiments,
        models=models,
        standin=standin,
    )
    depends_on = [rig, experiments, judgement, free, standin, seeds, aim, version]
    found = search(
        loss,
        start,
        step=calibration["step"],
        population=calibration["population"],
        generations=calibration["generations"],
        seed=seeds[0],
        workers=workers,
        checkpoint=checkpoint,
        key=hashlib.sha256(json.dumps(depends_on, sort_keys=True).encode()).hexdigest(),
        seconds=60.0 * calibration["minutes"],
        progress=_report_progress,
    )
    loss_at_start = loss(start)
    point = found.point if found.loss <= loss_at_start else start
    best = decode(point, rig, free)
    log.info("full models on the fitted rig, seeds of the objective")
    errors = full_errors(best, seeds, workers, experiments, judgement)
    measured = [judge_cheaply(best, seed, experiments, models, standin)[1] for seed in seeds]
    after = residuals(errors, aim)
    on_other_seeds = partial(loss, seeds=calibration["check_seeds"])
    summary = {
        "date": datetime.now(UTC).date().isoformat(),
        "software": f"fprc {__version__}",
        "seeds": list(seeds),
        "targets_kpa": dict(aim.errors),
        "residuals": after,
        "median_deviation": float(np.median(np.abs(list(after.values())))),
        "largest_deviation": float(np.max(np.abs(list(after.values())))),
        "properties": {name: float(np.mean([m[name] for m in measured])) for name in measured[0]},
        "plausible": dict(aim.ranges),
        "standin_ratios": ratios,
        "loss_at_start": loss_at_start,
        "loss": min(found.loss, loss_at_start),
        "check_seeds": list(calibration["check_seeds"]),
        "check_loss_at_start": on_other_seeds(start),
        "check_loss": on_other_seeds(point),
        "rig_sha256": hash_of(best),
        "generations": found.generations,
        "evaluations": found.evaluations,
        "finished": found.finished,
        "parameters": [
            {
                "path": p.path,
                "low": p.low,
                "high": p.high,
                "began_at": float(before),
                "share": float(share),
            }
            for p, before, share in zip(free, start, point, strict=True)
        ],
    }
    write_json(report, summary)
    write_text(fitted, parameter_file(best, summary))
    log.info(
        "loss on other seeds: %.4f at the start, %.4f now",
        summary["check_loss_at_start"], summary["check_loss"],
    )  # fmt: skip
    if summary["check_loss"] > summary["check_loss_at_start"]:
        log.warning(
            "warning: on seeds outside the fit the rig that the search began at is nearer to "
            "print; keep that one, or use more calibration.seeds"
        )
    log.info(
        "median deviation %.1f %%, largest %.1f %%; wrote %s",
        100 * summary["median_deviation"], 100 * summary["largest_deviation"], fitted,
    )  # fmt: skip


def target_of(published: Mapping[str, Any], calibration: Mapping[str, Any]) -> Target:
    """Return what the search aims at: Tables II and III, orders, plausible properties.

    Validation errors are left to follow the training errors, which they hardly
    differ from with shuffled folds.
    """
    errors = {}
    for trained_on, table in PRINTED.items():
        for model in INPUTS:
            printed = published[table][model]
            errors[f"{trained_on}/{model}/train"] = float(printed["train_rmse_kpa"][0])
            errors[f"{trained_on}/{model}/test"] = float(printed["test_rmse_kpa"])
    return Target(errors, calibration["plausible"], calibration["margin"], calibration["ratio"])


def free_parameters(
    paths: Sequence[str], ranges: Mapping[str, Sequence[float]] | None = None
) -> list[Free]:
    """Return the free parameters with their ranges, the physical ones unless narrower are given.

    Raises
    ------
    ConfigError
        A path or a range is wrong; all at once.
    """
    try:
        known = free_ranges(paths, ranges or {})
    except ValueError as error:
        raise ConfigError(f"cannot calibrate:\n  {error}") from None
    return [Free(path, *limits) for path, limits in known.items()]


def loss_at(
    point: np.ndarray,
    *,
    rig: Mapping[str, Any],
    free: Sequence[Free],
    seeds: Sequence[int],
    aim: Target,
    ratios: Mapping[str, float],
    experiments: Mapping[str, Any],
    models: Mapping[str, Any],
    standin: Mapping[str, int],
) -> float:
    """Return the loss of one point of the unit cube."""
    candidate = decode(point, rig, free)
    try:
        Rig.model_validate(candidate)
        judged = [judge_cheaply(candidate, seed, experiments, models, standin) for seed in seeds]
        errors = [{key: ratios[key] * seed[key] for key in ratios} for seed, _ in judged]
        loss = loss_of(errors, [found for _, found in judged], aim)
    except (FprcError, ValueError):
        return IMPOSSIBLE
    return loss if np.isfinite(loss) else IMPOSSIBLE


def judge_cheaply(
    rig: Mapping[str, Any],
    seed: int,
    experiments: Mapping[str, Any],
    models: Mapping[str, Any],
    standin: Mapping[str, int],
) -> tuple[dict[str, float], dict[str, float]]:
    """Return the stand-in's errors and the properties of a rig, one seed."""
    logs = {name: d.channels for name, d in simulate(rig=rig, seed=seed, **experiments).items()}
    return surrogate_errors(logs, models, seed=seed, **standin), properties(logs)


def full_errors(
    rig: Mapping[str, Any],
    seeds: Sequence[int],
    workers: int,
    experiments: Mapping[str, Any],
    judgement: Mapping[str, Any],
) -> list[dict[str, float]]:
    """Return the errors of Tables II and III by the full models, one mapping a seed."""
    with parallel_config("loky", inner_max_num_threads=1):
        return Parallel(n_jobs=workers)(
            delayed(_judge_fully)(rig, seed, experiments, judgement) for seed in seeds
        )


def _judge_fully(
    rig: Mapping[str, Any], seed: int, experiments: Mapping, judgement: Mapping
) -> dict[str, float]:
    data = simulate(rig=rig, seed=seed, **experiments)
    errors = {}
    for name in INPUTS:
        judged = judge_directions(name, seed=seed, logs=data, directions=DIRECTIONS, **judgement)
        for (train, _), (_, report, _) in zip(DIRECTIONS, judged, strict=True):
            errors[f"{train}/{name}/train"] = float(np.mean(report["train_rmse_kpa"]))
            errors[f"{train}/{name}/test"] = report["test_rmse_kpa"]
    return errors


def parameter_file(rig: Mapping[str, Any], summary: Mapping[str, Any]) -> str:
    """Return the rig as YAML, only what differs from the defaults, under its provenance."""
    changed = _different(rig, Rig().model_dump(mode="json"))
    head = _HEAD.format(
        **summary,
        median=100 * summary["median_deviation"],
        largest=100 * summary["largest_deviation"],
        shown_seeds=", ".join(map(str, summary["seeds"])),
        count=len(summary["parameters"]),
        rows="\n".join(
            f"#   {key}: {summary['targets_kpa'][key]:g} kPa, {100 * value:+.1f} %"
            for key, value in summary["residuals"].items()
        ),
        edges=_edges(summary["parameters"]),
    )
    return head + yaml.safe_dump({"rig": changed}, sort_keys=False, default_flow_style=None)


_HEAD = """\
# Parameters of the simulated rig that differ from their defaults. Written by `fprc calibrate`
# ({software}, {date}); docs/calibration.md explains it.
#
# Fitted, by CMA-ES over {count} parameters within the ranges of `calibration` ({evaluations} rigs),
# on the noise seeds {shown_seeds}:
# the training and test RMSEs of Tables II and III; the order of the models in them, seed by seed;
# and plausible loops and swings (calibration.plausible).
# No part of the fit: every other seed, Table IV, Figures 9 to 17.
# Deviation from print on the seeds of the fit, full models: median {median:.1f} %, largest
# {largest:.1f} %:
{rows}
{edges}
"""


def _edges(parameters: Sequence[Mapping[str, Any]]) -> str:
    near = [p["path"] for p in parameters if not 0.02 <= p["share"] <= 0.98]
    text = f"Within 2 % of an end of their range: {', '.join(near) or 'none'}."
    return textwrap.fill(
        text, 100, initial_indent="# ", subsequent_indent="# ", break_long_words=False
    )


def _different(rig: Mapping[str, Any], default: Mapping[str, Any]) -> dict[str, Any]:
    changed = {}
    for key, value in rig.items():
        if isinstance(value, Mapping):
            inner = _different(value, default[key])
            if inner:
                changed[key] = inner
        elif value != default[key]:
            changed[key] = value
    return changed


def _report_progress(done: int, total: int, best: float, elapsed: float) -> None:
    log.info("generation %d of %d, least loss %.4f, %.0f s", done, total, best, elapsed)


def calibrate_from_files(
    files: Sequence[str],
    published: str,
    out: str,
    *,
    minutes: float | None = None,
    workers: int | None = None,
) -> None:
    """Calibrate as configuration files say, without a workflow.

    The report goes beside ``out`` as JSON, and so does the checkpoint of the
    search, with which more generations can be added.

    Raises
    ------
    ConfigError
        The configuration or a limit is wrong; all errors at once.
    """
    settings = from_files(files).model_dump(mode="json")
    if minutes is not None:
        changed = settings["calibration"] | {"minutes": minutes}
        settings = check(settings | {"calibration": changed}).model_dump(mode="json")
    calibration = settings["calibration"]
    if workers is not None and workers < 1:
        raise ConfigError(
            f"--workers {workers}: must be 1 or more; leave it out for all processors"
        )
    if Path(out).suffix not in (".yaml", ".yml"):
        raise ConfigError(f"--out {out}: must end in .yaml; the report goes beside it as .json")
    logging.basicConfig(level=logging.INFO, format="%(message)s")
    stem = Path(out).with_suffix("")
    with threadpool_limits(1):
        calibrate(
            published,
            out,
            f"{stem}.json",
            rig=settings["rig"],
            signals=settings["experiments"],
            control=settings["control"],
            target=settings["evaluation"]["target"],
            models=settings["models"],
            calibration=calibration,
            folds=settings["evaluation"]["folds"],
            split=settings["evaluation"]["split"],
            workers=workers or len(os.sched_getaffinity(0)),
            checkpoint=f"{stem}.partial.jsonl",
            version=fingerprint("fprc.calibration.fit.calibrate"),
        )
