"""Judge the competitors on the rigs of a world, and choose their settings."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import yaml

from fprc.artifacts import read_json, write_json, write_text
from fprc.calibration.ensemble import draw_rig
from fprc.calibration.fit import free_parameters
from fprc.config.rig import Rig
from fprc.errors import FprcError
from fprc.evaluation.cells import judged_cells
from fprc.evaluation.timing import machine
from fprc.experiments.beyond import (
    ALL,
    BRIEF,
    SLOW,
    Contest,
    judge_build,
    judge_lengths,
    time_of_step,
)
from fprc.experiments.capacity import judge_capacity
from fprc.experiments.hysteresis import simulate
from fprc.experiments.settings import Judgement, RigSettings
from fprc.experiments.tuning import SPACES, candidates_of, chosen, judge_candidate
from fprc.yaml_file import read_yaml


def judge_world(
    rigs: str,
    tuned: str,
    judged: str,
    *,
    world: Mapping[str, Any],
    units: int,
    slow: int,
    contest: Mapping[str, Any],
    workers: int,
    checkpoint: str,
    version: str,
) -> None:
    """Judge the models on every seed or rig of a world.

    Parameters
    ----------
    rigs : str
        Rigs of the posterior.
    tuned : str
        Settings of the tuned models, by world and name.
    world : Mapping
        ``name``, ``rigs`` (one, posterior or drawn), ``fitted`` (terms that its rigs were fitted
        to), ``every_model`` (else only those of ``BRIEF``), ``first_seed``, ``seeds_per_rig``, and
        ``on_rig``, ``ensemble`` and ``free`` for the rigs.
    slow : int
        Number of the first units that also judge the slow models, in a world with every model.
    contest : Mapping
        Arguments of ``Contest`` without ``tuned``.
    """
    settings = _tuned(tuned, world)
    described = {
        "name": world["name"],
        "fitted": world["fitted"],
        "unit": "seed" if world["rigs"] == "one" else "rig",
        "source": "sim",
    }
    with judged_cells(
        partial(_judge, rigs=rigs, world=world, slow=slow, contest={**contest, "tuned": settings}),
        [{"unit": unit} for unit in range(units)],
        workers=workers,
        checkpoint=checkpoint,
        settings=[world, contest, settings, slow, version],
        files=[rigs],
    ) as cells:
        builds = [{"unit": cell["unit"], **build} for cell in cells for build in cell["builds"]]
        write_json(judged, described | {"cells": builds})


def tune_world(
    rigs: str,
    tuning: str,
    *,
    world: Mapping[str, Any],
    units: Sequence[int],
    candidates: int,
    seed: int,
    restarts: int,
    judgement: Mapping[str, Any],
    workers: int,
    checkpoint: str,
    version: str,
) -> None:
    """Judge random settings of the models that are tuned, and choose the best.

    Parameters
    ----------
    units : sequence of int
        Seeds or rigs of the world that ``judge_world`` does not judge.
    seed : int
        Seed of the settings.
    judgement : Mapping
        Arguments of ``Judgement``.
    """
    how = Judgement(**judgement)
    names = (
        SPACES if world["rigs"] == "one" else [name for name in SPACES if f"{name}_tuned" in BRIEF]
    )
    cells = [
        {"model": name, "settings": each}
        for name in names
        for each in candidates_of(name, candidates, seed)
    ]
    logs = [simulate(*builds_of(unit, rigs, world)[0]) for unit in units]
    with judged_cells(
        partial(_try, logs=logs, judgement=how, restarts=restarts),
        cells,
        workers=workers,
        checkpoint=checkpoint,
        settings=[world, list(units), restarts, judgement, version],
        files=[rigs],
    ) as tried:
        by_model = {name: [each for each in tried if each["model"] == name] for name in names}
        described = {"world": world["name"], "source": "sim"}
        write_json(tuning, described | {"tried": tried, "chosen": chosen(by_model)})


def join_tuned(tunings: Sequence[str], tuned: str) -> None:
    """Write the chosen settings of every world as YAML."""
    reports = [read_json(path) for path in tunings]
    text = yaml.safe_dump(
        {report["world"]: report["chosen"] for report in reports},
        sort_keys=False,
        default_flow_style=None,
        width=96,
    )
    write_text(tuned, _HEAD + text)


_HEAD = """\
# Settings of the tuned competitors, by world, that differ from their defaults. Made by
# `snakemake tuned` on logs that judge nothing else; docs/beyond.md explains it.
"""


def judge_training_logs(
    tuned: str,
    judged: str,
    *,
    world: Mapping[str, Any],
    contest: Mapping[str, Any],
    seeds: int,
    seconds: Sequence[float],
    second_log: Mapping[str, Any],
    workers: int,
    checkpoint: str,
    version: str,
) -> None:
    """Judge the models trained on one log of each length in ``seconds``, and on two logs."""
    settings = _tuned(tuned, world)
    with judged_cells(
        partial(
            _judge_lengths,
            world=world,
            contest={**contest, "tuned": settings},
            seconds=seconds,
            second_log=second_log,
        ),
        [{"unit": unit} for unit in range(seeds)],
        workers=workers,
        checkpoint=checkpoint,
        settings=[world, contest, settings, seconds, second_log, version],
    ) as cells:
        trained = [each for cell in cells for each in cell["trained"]]
        write_json(judged, {"source": "sim", "training_length": trained})


def judge_capacities(
    judged: str,
    *,
    worlds: Sequence[Mapping[str, Any]],
    models: Mapping[str, Any],
    capacity: Mapping[str, Any],
    seeds: int,
    workers: int,
    checkpoint: str,
    version: str,
) -> None:
    """Measure capacities on the rigs of the worlds that have one rig.

    Parameters
    ----------
    capacity : Mapping
        As ``judge_capacity`` takes it.
    """
    by_name = {world["name"]: world for world in worlds}
    with judged_cells(
        partial(_judge_capacity, worlds=by_name, models=models, capacity=capacity),
        [{"world": name, "unit": unit} for name in by_name for unit in range(seeds)],
        workers=workers,
        checkpoint=checkpoint,
        settings=[by_name, models, capacity, version],
    ) as cells:
        found = {
            name: [
                {key: cell[key] for key in ("unit", "seed", "noise_of_p_o", "sets")}
                for cell in cells
                if cell["world"] == name
            ]
            for name in by_name
        }
        write_json(judged, {"source": "sim", "worlds": found})


def time_steps(
    tuned: str, steps: str, *, world: Mapping[str, Any], contest: Mapping[str, Any]
) -> None:
    """Time a step of every model on this machine, us."""
    settings = _tuned(tuned, world)
    on_rig, seed = builds_of(0, "", world)[0]
    given = Contest(**contest, tuned=settings)
    logs = simulate(on_rig, seed)
    times = {name: time_of_step(name, logs, given, seed) for name in ALL}
    write_json(steps, {"source": "sim", **machine(), "step_us": times})


def _tuned(tuned: str, world: Mapping[str, Any]) -> Mapping[str, Any]:
    known = read_yaml(tuned)
    if world["name"] not in known:
        raise FprcError(
            f"{tuned}: no settings for the world {world['name']}; make them with "
            "`snakemake tuned`, and copy results/beyond/tuned.yaml there"
        )
    return known[world["name"]]


def builds_of(unit: int, rigs: str, world: Mapping[str, Any]) -> list[tuple[RigSettings, int]]:
    """Return the rig of a unit, once with each of its seeds."""
    on_rig = RigSettings(**world["on_rig"])
    count = world["seeds_per_rig"]
    if world["rigs"] == "posterior":
        known = read_json(rigs)["rigs"]
        if unit >= len(known):
            raise FprcError(
                f"{rigs}: {len(known)} rigs, but beyond.rigs and beyond.tuning.units need more "
                f"than {unit}; reduce them"
            )
        on_rig = replace(on_rig, rig=Rig.model_validate(known[unit]).model_dump(mode="json"))
    elif world["rigs"] == "drawn":
        drawn = world["ensemble"]["seed"] + unit
        on_rig, _, _ = draw_rig(drawn, world["ensemble"], free_parameters(**world["free"]), on_rig)
    first = world["first_seed"] + unit * count
    return [(on_rig, seed) for seed in range(first, first + count)]


def _judge(
    cell: Mapping[str, int],
    *,
    rigs: str,
    world: Mapping[str, Any],
    slow: int,
    contest: Mapping[str, Any],
) -> dict[str, Any]:
    names: Sequence[str] = BRIEF
    if world["every_model"]:
        names = [name for name in ALL if name not in SLOW or cell["unit"] < slow]
    builds = []
    for on_rig, seed in builds_of(cell["unit"], rigs, world):
        report: dict[str, Any]
        try:
            report = {"models": judge_build(on_rig, seed, names, Contest(**contest))}
        except FprcError as error:
            report = {"failed": " ".join(str(error).split())}
        builds.append({"seed": seed, **report})
    return {"builds": builds}


def _judge_lengths(
    cell: Mapping[str, int],
    *,
    world: Mapping[str, Any],
    contest: Mapping[str, Any],
    seconds: Sequence[float],
    second_log: Mapping[str, Any],
) -> dict[str, Any]:
    on_rig, seed = builds_of(cell["unit"], "", world)[0]
    return {
        "trained": judge_lengths(
            on_rig, seed, BRIEF, Contest(**contest), seconds=seconds, second_log=second_log
        )
    }


def _judge_capacity(
    cell: Mapping[str, Any],
    *,
    worlds: Mapping[str, Mapping[str, Any]],
    models: Mapping[str, Any],
    capacity: Mapping[str, Any],
) -> dict[str, Any]:
    on_rig, seed = builds_of(cell["unit"], "", worlds[cell["world"]])[0]
    return {"seed": seed, **judge_capacity(on_rig.rig, on_rig.control, models, capacity, seed)}


def _try(
    cell: Mapping[str, Any],
    *,
    logs: Sequence[Mapping[str, Any]],
    judgement: Judgement,
    restarts: int,
) -> dict[str, float]:
    return judge_candidate(cell["model"], cell["settings"], logs, judgement, restarts)
