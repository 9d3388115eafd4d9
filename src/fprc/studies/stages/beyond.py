"""Choose the settings of the competitors."""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import yaml

from fprc.artifacts import read_json, write_json, write_text
from fprc.evaluation.cells import judged_cells
from fprc.experiments.hysteresis import simulate
from fprc.experiments.settings import Judgement
from fprc.studies.beyond.contest import BRIEF
from fprc.studies.beyond.tuning import SPACES, candidates_of, chosen, judge_candidate
from fprc.studies.families.family import unit_of

Settings = Mapping[str, Any]


def tune_family(
    near_print: str,
    tuning: str,
    *,
    family: Settings,
    units: Sequence[int],
    candidates: int,
    seed: int,
    judgement: Settings,
    **run: Any,
) -> None:
    """Judge random settings of the models that are tuned, and choose the best.

    Parameters
    ----------
    units : sequence of int
        Seeds or rigs of the family that judge nothing else.
    seed : int
        Seed of the settings.
    judgement : Mapping
        Arguments of ``Judgement``.
    """
    names = [name for name in SPACES if family["rigs"] == "one" or f"{name}_tuned" in BRIEF]
    cells = [
        {"model": name, "settings": settings}
        for name in names
        for settings in candidates_of(name, candidates, seed)
    ]
    logs = [simulate(*unit_of(unit, family, near_print).rigs[0]) for unit in units]
    with judged_cells(
        partial(judge_candidate, logs=logs, judgement=Judgement(**judgement)),
        cells,
        settings=[family, list(units), judgement],
        files=[near_print],
        **run,
    ) as tried:
        by_model = {name: [cell for cell in tried if cell["model"] == name] for name in names}
        described = {"world": family["name"], "source": "sim"}
        write_json(tuning, described | {"tried": tried, "chosen": chosen(by_model)})


def join_tuned(tunings: Sequence[str], tuned: str) -> None:
    """Write the chosen settings of every family as YAML."""
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
