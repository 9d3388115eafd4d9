"""What `fprc readout` judges: whether P_o is worth a second sensor; its memory; B1, B4 and R1.

The limits below were written down before they were run on any recording.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from fprc.errors import EvaluationError
from fprc.evaluation import sides
from fprc.evaluation.capacity import TAPS, filtered_capacity
from fprc.evaluation.paired import EQUIVALENT_WITHIN, LEAST_UNITS, Part, decide_together
from fprc.evaluation.readouts import BlockReadouts
from fprc.evaluation.sides import ALPHAS, PURGE_S, PURGES, WARM_UP_S, Recordings
from fprc.figures import style
from fprc.registry import build, entry_of, title_of
from fprc.tables.text import three_digits

YES, NO, UNDECIDED = "Yes", "No", "Not decided"
#: P_o is worth a second sensor if it lowers the error by more than this factor.
MARGIN = EQUIVALENT_WITHIN
#: Chance that the interval of the ratio errs.
LEVEL = 0.05
#: The theta side explains little if it leaves more than this share of the target's variance.
LITTLE = 0.5
#: A recording is called too short if one of at most this many times its length would decide;
#: beyond that its parts disagree.
MOST_TIMES = 10.0
#: Share of the blocks at either end that show how far the parts disagree.
_ENDS = 0.25
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


def answer_recordings(
    recordings: Recordings, models: Mapping[str, Any], seed: int, unit: str = "kPa"
) -> dict[str, Any]:
    """Compare the best models with and without P_o, and P_o with itself at other times.

    ``models`` is the configuration's section, for 200 samples a second; ``seed`` is of rules and
    networks. Returned are ``verdict``, ``reason`` (why it is not decided, else empty), ``words``
    (the first line); ``ratio`` with P_o over without, ``low`` and ``high``; of ``without`` and
    ``with``: ``error`` (geometric mean over blocks, ``unit`` of the target), ``family``,
    ``families`` (error of each) and ``blocks``; ``shifts``, the errors with P_o of other times;
    ``period_s`` of the motion or None; ``needed_s``, which length would decide, or None;
    ``explained``, share of the target's variance that the side without P_o explains; ``block_s``,
    ``duration_s``.
    """
    thin = recordings.thinned()
    period_s = sides.period_of(thin)
    best = {
        name: sides.best_of_side(thin, name == "with", models, seed) for name in ("without", "with")
    }
    ratios = np.log(best["with"].errors / best["without"].errors)
    interval = Part("", dict(enumerate(ratios)), overlap=overlap_of(thin)).interval(LEVEL)
    left = float(np.mean(best["without"].errors ** 2)) / float(np.var(thin.target))
    found: dict[str, Any] = {
        name: {
            "error": side.error,
            "family": side.family,
            "families": {of: float(np.exp(np.log(e).mean())) for of, e in side.each.items()},
            "blocks": side.errors.tolist(),
            "chosen": [family for family, _ in side.chosen],
        }
        for name, side in best.items()
    }
    found |= dict(zip(("ratio", "low", "high"), map(math.exp, interval), strict=True)) | {
        "shifts": [
            sides.error_when_shifted(thin.shifted(share), best["with"], models, seed)
            for share in sides.shifts_of(thin, period_s)
        ],
        "period_s": period_s,
        "p_o_repeats": bool(period_s and sides.p_o_repeats(thin, period_s)),
        "explained": max(0.0, 1.0 - left),
        "block_s": [len(block) / thin.rate_hz for _, block in thin.folds()],
        "duration_s": len(thin.theta) / thin.rate_hz,
    }
    found |= dict(zip(("verdict", "reason", "needed_s"), decide(found, ratios), strict=True))
    return found | {"words": first_line(found, unit)}


def overlap_of(recordings: Recordings) -> float:
    """Return the samples of a block per sample that trains for it."""
    return float(np.mean([len(block) / len(rows) for rows, block in recordings.folds()]))


def decide(found: Mapping[str, Any], ratios: Sequence[float]) -> tuple[str, str, float | None]:
    """Return the verdict, why it is not decided, and which length would decide, s.

    Yes: the whole interval of the ratio lies below 1/1.05, P_o beats all its shifts, and does not
    repeat with the motion. No: the whole interval lies above 1/1.05. Otherwise it is not decided,
    for the one reason that matters most.
    """

    def time(seconds: float) -> str:
        minutes = seconds >= 100.0
        return f"{math.ceil(seconds / 60.0)} minutes" if minutes else f"{math.ceil(seconds)} s"

    margin, mean, high = math.log(MARGIN), math.log(found["ratio"]), math.log(found["high"])
    shifts, needed_s = found["shifts"], None
    beaten = sum(found["with"]["error"] < error for error in shifts)
    if len(ratios) < LEAST_UNITS:
        needed_s = WARM_UP_S + LEAST_UNITS * PURGES * PURGE_S
        return UNDECIDED, f"The recording is too short: it takes {time(needed_s)}.", needed_s
    if math.log(found["low"]) > -margin:
        return NO, "", None
    if high < -margin and not found["p_o_repeats"] and shifts and beaten == len(shifts):
        return YES, "", None
    if found["period_s"]:
        reason = (
            f"The motion repeats every {found['period_s']:.3g} s, so each part has a twin in the "
            "rest: record one that does not repeat."
        )
    elif high < -margin:
        reason = (
            f"P_o of another time does as well in {len(shifts) - beaten} of {len(shifts)} trials: "
            "it tells the time, not what the chamber remembers."
        )
    elif found["explained"] < LITTLE:
        share = 100.0 * found["explained"]
        reason = f"theta explains only {share:.0f} % of P_exp: check the columns."
    else:
        needed_s = found["duration_s"] * ((high - mean) / abs(mean + margin)) ** 2
        best, worst = np.exp(np.quantile(ratios, (_ENDS, 1.0 - _ENDS)))
        reason = (
            f"The recording is too short: if its ratio, {found['ratio']:.2f}, stays, it takes "
            f"{time(needed_s)} of this motion."
            if needed_s <= MOST_TIMES * found["duration_s"]
            else f"Its parts disagree: the ratio is below {best:.2f} in a quarter of them and "
            f"above {worst:.2f} in another."
        )
    return UNDECIDED, reason, needed_s


def first_line(found: Mapping[str, Any], unit: str) -> str:
    """Return verdict, both errors and families, and the reason."""
    fuzzy = {"with": "FPRC", "without": "FPRC on low-passed theta"}
    errors = [three_digits(found[side]["error"]) for side in fuzzy]
    families = [
        fuzzy[side] if (family := found[side]["family"]) == "fuzzy" else f"{family}{ending}"
        for side, ending in {"with": " + P_o", "without": ""}.items()
    ]
    more = found["reason"]
    if found["verdict"] == NO and found["period_s"]:
        more = f"The motion repeats every {found['period_s']:.3g} s; on another one it may differ."
    line = f"{found['verdict']}: with P_o {errors[0]} {unit} ({families[0]}), "
    return f"{line}without {errors[1]} ({families[1]}). {more}".rstrip()


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
    found: dict[str, Any] = {}
    for name, signal in {"p_o": p_o, "theta": theta}.items():
        of = filtered_capacity(signal, theta, recordings.rate_hz)
        curves = {"memory": of.memory.tolist(), "degrees": of.degrees.tolist()}
        found[name] = curves | {"memory_s": of.memory_s, "rank": of.rank}
        found["lags_s"] = of.lags_s.tolist()
    of_p_o, explained = recordings._replace(target=recordings.p_o), []
    for name in ("bank", "plays"):
        fits = sides.readouts_of(of_p_o, name, models, seed)
        errors = [fits.errors(block)[len(ALPHAS) // 2] for block in range(len(fits.blocks))]
        explained.append(max(0.0, 1.0 - float(np.mean(np.square(errors)) / np.var(of_p_o.target))))
    lag = round((period_s or 0.0) * recordings.rate_hz)
    found["parts"] = {
        "linear": explained[0],
        "hysteresis": max(0.0, explained[1] - explained[0]),
        "new": float(sides.distances(p_o)[lag]) if 0 < lag <= len(p_o) // 2 else None,
    }
    return found


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
    inputs, folds = recordings._asdict(), recordings.folds()
    for name in MODELS:
        X = np.column_stack(
            [inputs[channel.rpartition("_")[0]] for channel in entry_of(name).inputs]
        )
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
    """Judge B1, B4 and R1 by the ratios of errors on blocks, see ``decide_together``."""
    errors = {cell["model"]: np.log(cell["blocks"]) for cell in cells if "blocks" in cell}
    claims = {}
    for name, (text, other) in CLAIMS.items():
        both = {"fprc", other} <= errors.keys()
        ratios = dict(enumerate(errors["fprc"] - errors[other])) if both else {}
        claims[name] = text, [Part(text, ratios, overlap=overlap)]
    return decide_together(claims, LEFT_OUT)


def sentences(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return each verdict in a few sentences."""
    lines = []
    for row in rows:
        line = f"{row['claim'][:1].upper()}{row['claim'][1:]} ({row['id']}): {row['words']}."
        if row["mean"] is not None:
            decides = row["units"] >= LEAST_UNITS  # the interval of a few blocks has no end
            interval = f"({row['low']:#.3g} to {row['high']:#.3g}) " if decides else ""
            other = title_of(CLAIMS[row["id"]][1])
            line += f" FPRC's error is {row['mean']:#.3g} {interval}times that of {other}."
            line += "" if decides else f" Fewer than {LEAST_UNITS} blocks decide nothing."
        lines.append(line)
    return lines
