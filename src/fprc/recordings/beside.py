"""What `fprc readout` says beside its answer: the memory of P_o, and the paper's models."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from fprc.errors import EvaluationError
from fprc.evaluation.capacity import TAPS, filtered_capacity
from fprc.evaluation.paired import (
    AGREEING,
    LEAST_UNITS,
    NOT_JUDGED,
    UNDECIDED,
    Part,
    decide_together,
)
from fprc.evaluation.readouts import BlockReadouts
from fprc.evaluation.sides import ALPHAS, Recordings, distances, readouts_of
from fprc.figures import style
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
#: Colour and words of each state whose memory is measured.
_STATES = {"p_o": ("0.15", "P$_o$ and its low-passes"), "theta": ("0.65", "θ and its low-passes")}


def judge_memory(
    recordings: Recordings, models: Mapping[str, Any], seed: int, period_s: float | None
) -> dict[str, Any]:
    """Measure memory, capacity and parts of P_o, on the longest of thinned recordings.

    Of ``p_o`` and ``theta``, each with its low-passes: ``memory``, ``memory_s``, ``degrees`` and
    ``rank``, see ``fprc.capacity``; ``lags_s``; ``parts``, shares of the variance of P_o on unseen
    blocks: ``linear``, a filter of theta; ``hysteresis``, what plays add; and ``new``, what does
    not come back when the motion repeats (None if it does not repeat).
    """
    longest = int(np.argmax(recordings.lengths))
    p_o, theta = (recordings.parts(x)[longest] for x in (recordings.p_o, recordings.theta))
    of_each = {
        name: filtered_capacity(signal, theta, recordings.rate_hz)
        for name, signal in {"p_o": p_o, "theta": theta}.items()
    }
    of_p_o, explained = recordings._replace(target=recordings.p_o), []
    for name in ("bank", "plays"):
        fits = readouts_of(of_p_o, name, models, seed)
        errors = [fits.errors(block)[len(ALPHAS) // 2] for block in range(len(fits.blocks))]
        explained.append(max(0.0, 1.0 - float(np.mean(np.square(errors)) / np.var(of_p_o.target))))
    new = None
    if period_s and (lag := round(period_s * recordings.rate_hz)) <= len(p_o) // 2:
        new = float(distances(p_o)[lag])
    return {
        name: {
            "memory": found.memory.tolist(),
            "memory_s": found.memory_s,
            "degrees": found.degrees.tolist(),
            "rank": found.rank,
        }
        for name, found in of_each.items()
    } | {
        "lags_s": of_each["p_o"].lags_s.tolist(),
        "parts": {
            "linear": explained[0],
            "hysteresis": max(0.0, explained[1] - explained[0]),
            "new": new,
        },
    }


def memory_in_words(found: Mapping[str, Any]) -> list[str]:
    """Return what was measured as sentences."""
    parts, p_o, theta = found["parts"], found["p_o"], found["theta"]
    new = "" if parts["new"] is None else f", and {parts['new']:.0%} is new at each repetition"
    rest = max(0.0, 1.0 - parts["linear"] - parts["hysteresis"])
    degrees = [
        ", ".join(f"{share:.2g} of degree {number}" for number, share in enumerate(each, 1))
        for each in (p_o["degrees"], theta["degrees"])
    ]
    return [
        f"Memory: P_o and its low-passes add {p_o['memory_s']:.2g} s to theta's own newest "
        f"{TAPS} samples, the same low-passes of theta {theta['memory_s']:.2g} s. This is the sum, "
        f"over lags up to {found['lags_s'][-1]:.2g} s, of the share of past theta's variance that "
        "they explain on unseen blocks; 0 where the same of another time does as well.",
        f"Capacity: {degrees[0]} of {p_o['rank']} states with P_o; {degrees[1]} of "
        f"{theta['rank']} with theta. The input is correlated, so these compare states on this "
        "recording only.",
        f"Of P_o's variance, a linear filter of theta explains {parts['linear']:.0%}, plays of "
        f"theta {parts['hysteresis']:.0%} more, and neither {rest:.0%}{new}.",
    ]


def draw_memory(found: Mapping[str, Any], png: str) -> None:
    """Draw the memory curve, and the capacity by degree below the number of states."""
    fig, (curve, bars) = style.figure(1, 2, style.PAGE_IN, 2.4)
    rank = max(found[name]["rank"] for name in _STATES)
    for shift, (name, (colour, label)) in zip((-0.2, 0.2), _STATES.items(), strict=True):
        curve.plot(found["lags_s"], found[name]["memory"], color=colour, label=label)
        degrees = found[name]["degrees"]
        at = np.arange(1, len(degrees) + 1)
        drawn = bars.bar(at + shift, degrees, color=colour, width=0.38)
        paper = {"facecolor": "white", "edgecolor": "none", "pad": 0.5}
        bars.bar_label(drawn, fmt="%.2g", padding=3, bbox=paper, zorder=3)
    curve.set(xlabel="Lag [s]", ylabel="Share of past θ added", xlim=(0, None))
    curve.set_ylim(0.0, max(0.1, 1.1 * max(max(found[name]["memory"]) for name in _STATES)))
    curve.legend()
    bars.axhline(rank, color="0.2", linestyle=":", linewidth=0.8)
    bars.text(at[-1] + 0.4, rank, "number of states", ha="right", va="bottom")
    bars.set(xlabel="Degree", ylabel="Capacity", ylim=(0.0, 1.2 * rank), xticks=at)
    style.save(fig, {"source": "import"}, png)


def judge_models(
    recordings: Recordings, models: Mapping[str, Any], seed: int
) -> list[dict[str, Any]]:
    """Return of each of the paper's models the RMSE on ``blocks``, or a ``reason`` for none."""
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
    return cells


def judge_claims(cells: Sequence[Mapping[str, Any]], overlap: float) -> list[dict[str, Any]]:
    """Judge B1, B4 and R1 by the ratios of errors on blocks.

    To what ``decide_together`` gives come ``other``, the model that FPRC is compared with, and
    ``reason``, why a claim is undecided or not judged.
    """
    errors = {cell["model"]: np.log(cell["blocks"]) for cell in cells if "blocks" in cell}
    claims = {}
    for name, (text, other) in CLAIMS.items():
        both = {"fprc", other} <= errors.keys()
        ratios = dict(enumerate(errors["fprc"] - errors[other])) if both else {}
        claims[name] = text, [Part(text, ratios, overlap=overlap)]
    rows = decide_together(claims, LEFT_OUT)
    for row in rows:
        row |= {"other": title_of(CLAIMS[row["id"]][1]), "reason": ""}
        if row["verdict"] == NOT_JUDGED:
            row["reason"] = "A model has no errors."
        elif row["verdict"] == UNDECIDED and row["units"] < LEAST_UNITS:
            row["reason"] = (
                f"There are {row['units']} blocks; fewer than {LEAST_UNITS} decide nothing."
            )
        elif row["verdict"] == UNDECIDED:
            row["reason"] = "The interval contains 1 and is not within 5 % of it."
            if row["stable"] is not None:
                row["reason"] = (
                    f"Without {LEFT_OUT} random blocks the verdict stays in {row['stable']:.0%} of "
                    f"the cases; {AGREEING:.0%} are needed."
                )
    return rows


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
