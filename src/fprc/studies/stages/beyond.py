"""Judge the competitors on the rigs of a world, and choose their settings."""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import yaml

from fprc.artifacts import read_json, write_json, write_text
from fprc.errors import FprcError
from fprc.evaluation.cells import judged_cells
from fprc.evaluation.timing import machine
from fprc.experiments.hysteresis import simulate
from fprc.experiments.settings import Judgement
from fprc.studies.beyond.contest import (
    ALL,
    BRIEF,
    SLOW,
    Contest,
    judge_build,
    judge_lengths,
    judge_settings,
    time_of_step,
)
from fprc.studies.beyond.driven_states import judge_capacity
from fprc.studies.beyond.tuning import SPACES, candidates_of, chosen, judge_candidate
from fprc.studies.families.family import rigs_of
from fprc.yaml_file import read_yaml

Settings = Mapping[str, Any]


def judge_world(
    near_print: str,
    tuned: str,
    judged: str,
    *,
    world: Settings,
    units: int,
    slow: int,
    contest: Settings,
    **run: Any,
) -> None:
    """Judge the models on every seed or rig of a world.

    Parameters
    ----------
    near_print : str
        File of the rigs near print.
    tuned : str
        Settings of the tuned models, by world and name.
    world : Mapping
        A family, see ``rigs_of``, with ``name``, ``fitted`` (terms that its rigs were fitted to)
        and ``every_model`` (else only those of ``BRIEF``).
    slow : int
        Number of the first units that also judge the slow models, in a world with every model.
    contest : Mapping
        Arguments of ``Contest`` without ``tuned``.
    **run
        ``workers``, ``checkpoint`` and ``version`` of ``judged_cells``; so in the stages below.
    """
    entered = _contest(contest, tuned, world)
    described = {
        "name": world["name"],
        "fitted": world["fitted"],
        "unit": "seed" if world["rigs"] == "one" else "rig",
        "source": "sim",
    }
    with judged_cells(
        partial(_judge, near_print=near_print, world=world, slow=slow, contest=entered),
        [{"unit": unit} for unit in range(units)],
        settings=[world, entered, slow],
        files=[near_print],
        **run,
    ) as cells:
        builds = [{"unit": cell["unit"], **build} for cell in cells for build in cell["builds"]]
        write_json(judged, described | {"cells": builds})


def tune_world(
    near_print: str,
    tuning: str,
    *,
    world: Settings,
    units: Sequence[int],
    candidates: int,
    seed: int,
    restarts: int,
    judgement: Settings,
    **run: Any,
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
    names = [name for name in SPACES if world["rigs"] == "one" or f"{name}_tuned" in BRIEF]
    cells = [
        {"model": name, "settings": each}
        for name in names
        for each in candidates_of(name, candidates, seed)
    ]
    logs = [simulate(*rigs_of(unit, world, near_print)[0]) for unit in units]
    with judged_cells(
        partial(judge_candidate, logs=logs, judgement=Judgement(**judgement), restarts=restarts),
        cells,
        settings=[world, list(units), restarts, judgement],
        files=[near_print],
        **run,
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
# the target `tuned` on logs that judge nothing else; docs/beyond.md explains it.
"""


def judge_training_logs(
    tuned: str,
    judged: str,
    *,
    world: Settings,
    contest: Settings,
    seeds: int,
    seconds: Sequence[float],
    second_log: Settings,
    **run: Any,
) -> None:
    """Judge the models trained on one log of each length in ``seconds``, and on two logs."""
    entered = _contest(contest, tuned, world)
    how: dict[str, Any] = {"contest": entered, "seconds": seconds, "second_log": second_log}
    with judged_cells(
        partial(_judge_lengths, world=world, **how),
        [{"unit": unit} for unit in range(seeds)],
        settings=[world, how],
        **run,
    ) as cells:
        trained = [each for cell in cells for each in cell["trained"]]
        write_json(judged, {"source": "sim", "training_length": trained})


def judge_capacities(
    judged: str,
    *,
    worlds: Sequence[Settings],
    models: Settings,
    capacity: Settings,
    seeds: int,
    **run: Any,
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
        settings=[by_name, models, capacity],
        **run,
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


def judge_settings_of(
    judged: str,
    tuned: str,
    *,
    worlds: Sequence[Settings],
    contest: Settings,
    grids: Settings,
    seeds: int,
    **run: Any,
) -> None:
    """Judge FPRC with P_o and with low-passed theta_d over epsilon and n_c, on named rigs."""
    entered = {world["name"]: _contest(contest, tuned, world) for world in worlds}
    by_name = {world["name"]: world for world in worlds}
    with judged_cells(
        partial(_judge_settings, worlds=by_name, contests=entered, grids=grids),
        [{"world": name, "unit": unit} for name in by_name for unit in range(seeds)],
        settings=[by_name, entered, grids],
        **run,
    ) as cells:
        found = [
            {"world": cell["world"], "unit": cell["unit"], **row}
            for cell in cells
            for row in cell["errors"]
        ]
        write_json(judged, {"source": "sim", "worlds": found})


def time_steps(tuned: str, steps: str, *, world: Settings, contest: Settings) -> None:
    """Time a step of every model on this machine, us."""
    entered = _contest(contest, tuned, world)
    on_rig, seed = rigs_of(0, world)[0]
    logs = simulate(on_rig, seed)
    times = {name: time_of_step(name, logs, entered, seed) for name in ALL}
    write_json(steps, {"source": "sim", **machine(), "step_us": times})


def _contest(contest: Settings, tuned: str, world: Settings) -> Contest:
    known = read_yaml(tuned)
    if world["name"] not in known:
        raise FprcError(
            f"{tuned}: no settings for the world {world['name']}; make them with "
            "the target `tuned`, and copy results/beyond/tuned.yaml there"
        )
    return Contest(**contest, tuned=known[world["name"]])


def _judge(
    cell: Mapping[str, int], *, near_print: str, world: Settings, slow: int, contest: Contest
) -> dict[str, Any]:
    names: Sequence[str] = BRIEF
    if world["every_model"]:
        names = [name for name in ALL if name not in SLOW or cell["unit"] < slow]
    builds = []
    for on_rig, seed in rigs_of(cell["unit"], world, near_print):
        try:
            report: dict[str, Any] = {"models": judge_build(on_rig, seed, names, contest)}
        except FprcError as error:
            report = {"failed": " ".join(str(error).split())}
        builds.append({"seed": seed, **report})
    return {"builds": builds}


def _judge_lengths(cell: Mapping[str, int], *, world: Settings, **how: Any) -> dict[str, Any]:
    on_rig, seed = rigs_of(cell["unit"], world)[0]
    return {"trained": judge_lengths(on_rig, seed, BRIEF, **how)}


def _judge_settings(
    cell: Mapping[str, Any], *, worlds: Settings, contests: Mapping[str, Contest], grids: Settings
) -> dict[str, Any]:
    on_rig, seed = rigs_of(cell["unit"], worlds[cell["world"]])[0]
    return {"errors": judge_settings(on_rig, seed, contests[cell["world"]], grids)}


def _judge_capacity(
    cell: Mapping[str, Any], *, worlds: Settings, models: Settings, capacity: Settings
) -> dict[str, Any]:
    on_rig, seed = rigs_of(cell["unit"], worlds[cell["world"]])[0]
    return {"seed": seed, **judge_capacity(on_rig.rig, on_rig.control, models, capacity, seed)}
