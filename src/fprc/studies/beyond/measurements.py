"""Read the measurements of a family of the target ``beyond``; a family is one rig or a set of rigs.

A family has ``name``, ``fitted`` (the terms that its rigs were fitted to) and ``cells`` (one per
rig and seed, with the errors of each model).
"""

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from fprc.registry import title_of

#: Measures of every model, as readers see them, with their units; errors are RMSE.
MEASURES = {
    "train": "training [kPa]",
    "blocks": "unseen blocks [kPa]",
    "forward": "forward test [kPa]",
    "reversed": "reversed test [kPa]",
    "open_loop": "open loop [deg]",
    "closed_loop": "closed loop [deg]",
}

#: Measures by which the best model of each side is chosen and judged.
BEST_MEASURES = ("blocks", "forward", "reversed", "open_loop", "closed_loop")

#: Loops of a tracking run, open and closed.
LOOPS = ("open_loop", "closed_loop")

#: Names of families for readers, where these are not those of the settings.
_TITLES = {"bouc_wen": "Bouc-Wen"}


#: Best models of one side, chosen on other units, for readers.
_BEST = {
    "with_p_o": "Best with P_o",
    "without_p_o": "Best without P_o",
    "other_p_o": "Best other with P_o",
}


def model_title(name: str) -> str:
    """Return the name of a model, or of the best ones, for readers."""
    return _BEST.get(name) or title_of(name)


def family_title(name: str) -> str:
    """Return a family's name for readers."""
    return _TITLES.get(name, name.replace("_", "-"))


def measured(families: Sequence[Mapping[str, Any]]) -> pd.DataFrame:
    """Return every number of the models in families, tidy.

    Returns
    -------
    DataFrame
        ``world``, ``unit``, ``seed``, ``model``, ``measure`` and ``value``, see
        ``contest.judge_rig``. What was not measured has no row, and neither has a model that could
        not be judged.
    """
    rows = [
        (family["name"], cell["unit"], cell["seed"], model, measure, value)
        for family in families
        for cell in family["cells"]
        for model, report in cell.get("models", {}).items()
        if "failed" not in report
        for measure, value in report.items()
    ]
    columns = ["world", "unit", "seed", "model", "measure", "value"]
    return pd.DataFrame(rows, columns=columns).astype({"value": float})
