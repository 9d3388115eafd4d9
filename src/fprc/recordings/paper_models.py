"""The paper's three models on a recording, and the claims on them that need no rig."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from fprc.errors import EvaluationError
from fprc.evaluation.paired import (
    AGREEING,
    LEAST_UNITS,
    NOT_JUDGED,
    UNDECIDED,
    Part,
    decide_together,
)
from fprc.evaluation.readouts import BlockReadouts
from fprc.evaluation.sides import Recordings
from fprc.registry import build, entry_of, title_of

#: The paper's models, and those that the claims compare FPRC with.
MODELS = ("fprc", "fuzzy_linear", "esn", "fprc_lowpass", "ridge_p_o")
#: FPRC against one model each: text and model by id, as in ``fprc.studies.beyond``; R marks
#: claims on recordings only.
CLAIMS = {
    "B1": ("P_o beats low-passed theta", "fprc_lowpass"),
    "B4": ("the fuzzy readout beats a ridge on the same features", "ridge_p_o"),
    "R1": ("FPRC beats the same readout without P_o", "fuzzy_linear"),
}
#: Blocks that a subset leaves out.
LEFT_OUT = 2
#: Most bytes of a model's features, of which there are two copies: those of the paper's ESN of
#: 150,000 samples.
MOST_BYTES = 966_000_000


def judge_models(
    recordings: Recordings,
    models: Mapping[str, Any],
    seed: int,
    step: Callable[[str], None] = lambda what: None,
) -> list[dict[str, Any]]:
    """Judge the paper's models on every block.

    Returns
    -------
    list of dict
        ``model``, and ``blocks``, the RMSE on each, or the ``reason`` why a model cannot be judged.
    """
    cells: list[dict[str, Any]] = []
    inputs = {"theta_deg": recordings.theta, "p_o_kpa": recordings.p_o}
    folds = recordings.folds()
    for name in MODELS:
        X = np.column_stack([inputs[channel] for channel in entry_of(name).inputs])
        try:
            if name == "esn" and 8 * len(X) * (models["esn"]["r"] + models["n_y"]) > MOST_BYTES:
                raise EvaluationError(f"{len(X):,} samples take too much memory; use a shorter log")
            model = build(name, models, seed)
            fits = BlockReadouts(model, X, recordings.target, recordings.lengths, folds)
            errors = [float(fits.errors(block)[0]) for block in range(len(folds))]
            cells.append({"model": name, "blocks": errors})
        except EvaluationError as error:
            cells.append({"model": name, "reason": str(error)})
        step(title_of(name))
    return cells


def judge_claims(cells: Sequence[Mapping[str, Any]], overlap: float) -> list[dict[str, Any]]:
    """Judge B1, B4 and R1 by the ratios of errors on blocks.

    Returns
    -------
    list of dict
        What ``decide_together`` gives, with ``other``, the model that FPRC is compared with, and
        ``reason``, why a claim is undecided or not judged.
    """
    errors = {cell["model"]: np.log(cell["blocks"]) for cell in cells if "blocks" in cell}
    claims = {}
    for name, (text, other) in CLAIMS.items():
        both = {"fprc", other} <= errors.keys()
        ratios = dict(enumerate(errors["fprc"] - errors[other])) if both else {}
        claims[name] = text, [Part(text, ratios, overlap=overlap)]
    return [
        row | {"other": title_of(CLAIMS[row["id"]][1]), "reason": _reason(row)}
        for row in decide_together(claims, LEFT_OUT)
    ]


def _reason(row: Mapping[str, Any]) -> str:
    """Return why a claim is undecided or not judged; empty if it is decided."""
    if row["verdict"] == NOT_JUDGED:
        return "A model has no errors."
    if row["verdict"] != UNDECIDED:
        return ""
    if row["units"] < LEAST_UNITS:
        return f"There are {row['units']} blocks; fewer than {LEAST_UNITS} decide nothing."
    if row["stable"] is not None:
        return (
            f"Without {LEFT_OUT} random blocks the verdict stays in {100 * row['stable']:.0f} % "
            f"of the cases; {100 * AGREEING:.0f} % are needed."
        )
    return "The interval contains 1 and is not within 5 % of it."


def sentences(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return each verdict in a few sentences."""
    lines = []
    for row in rows:
        line = f"{row['claim'][:1].upper()}{row['claim'][1:]} ({row['id']}): {row['words']}."
        if row["mean"] is not None:
            decides = row["units"] >= LEAST_UNITS  # the interval of a few blocks has no end
            interval = f"({row['low']:#.3g} to {row['high']:#.3g}) " if decides else ""
            line += f" FPRC's error is {row['mean']:#.3g} {interval}times that of {row['other']}."
        lines.append(f"{line} {row['reason']}".rstrip())
    return lines
