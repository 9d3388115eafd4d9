"""What `fprc readout` judges: whether P_o is worth a second sensor; its memory; B1, B4 and R1.

The limits below were written down before they were run on any recording.
"""

import math
from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import Any

import numpy as np
from scipy.stats import gmean

from fprc.errors import EvaluationError
from fprc.evaluation import sides
from fprc.evaluation.capacity import TAPS, filtered_capacity
from fprc.evaluation.paired import ALPHA, EQUIVALENT_WITHIN, LEAST_UNITS, Part, decide_together
from fprc.evaluation.sides import ALPHAS, BlockReadouts, Recordings
from fprc.figures import style
from fprc.registry import Settings, title_of
from fprc.tables.text import three_digits

YES, NO, UNDECIDED = "Yes", "No", "Not decided"
#: P_o is worth a second sensor if it lowers the error by more than this factor.
MARGIN = EQUIVALENT_WITHIN
#: The theta side explains little if it leaves more than this share of the target's variance.
LITTLE = 0.5
#: A recording is called too short if one of at most this many times its length would decide;
#: beyond that its parts disagree.
MOST_TIMES = 10.0
#: The paper's models, and those that the claims compare FPRC with.
MODELS = ("fprc", "fuzzy_linear", "esn", "fprc_lowpass", "ridge_p_o")
#: FPRC against one model each, by id as in ``fprc.studies.beyond``; R: on recordings only.
CLAIMS = {
    "B1": ("P_o beats low-passed theta", "fprc_lowpass"),
    "B4": ("the fuzzy readout beats a ridge on the same features", "ridge_p_o"),
    "R1": ("FPRC beats the same readout without P_o", "fuzzy_linear"),
}
#: Blocks that a subset leaves out.
LEFT_OUT = 2
#: Most samples of the paper's ESN: of its states there are two copies, of a gigabyte each.
MOST_OF_ESN = 150_000


def answer_recordings(recordings: Recordings, models: Settings, seed: int) -> dict[str, Any]:
    """Compare the best models with and without P_o, and P_o with itself at other times.

    Of one recording; ``models`` are settings for 200 samples a second. Errors are geometric means
    over blocks; ``shifts``, those with P_o of other times. ``new`` is the share of P_o that does
    not come back when the motion repeats, ``needed_s`` the length that would decide, ``explained``
    the share of the variance that models without P_o explain.
    """
    thin = recordings.thinned()
    period, duration_s = sides.period_of(thin.theta), len(thin.theta) / thin.rate_hz
    period_s = period / thin.rate_hz if period else None
    best: dict[str, sides.Side] = {}
    found: dict[str, Any] = {}
    for name in ("without", "with"):
        side = best[name] = sides.best_of_side(thin, name == "with", models, seed)
        chosen = [family for family, _ in side.chosen]
        found[name] = {
            "error": float(gmean(side.errors)),
            "family": max(side.each, key=chosen.count),
            "families": {family: float(gmean(errors)) for family, errors in side.each.items()},
            "blocks": side.errors.tolist(),
            "chosen": chosen,
        }
    ratios = np.log(best["with"].errors / best["without"].errors)
    interval = Part("", dict(enumerate(ratios)), overlap=overlap_of(thin)).interval(ALPHA)
    left = float(np.mean(best["without"].errors ** 2)) / float(np.var(thin.target))
    found |= dict(zip(("ratio", "low", "high"), map(math.exp, interval), strict=True)) | {
        "shifts": [
            sides.error_when_shifted(thin, share, best["with"], models, seed)
            for share in sides.shifts_of(duration_s, period_s)
        ],
        "period_s": period_s,
        "new": float(sides.distances(thin.p_o)[period]) if period else None,
        "explained": max(0.0, 1.0 - left),
        "block_s": [len(block) / thin.rate_hz for _, block in thin.folds()],
        "duration_s": duration_s,
    }
    return found | dict(zip(("verdict", "reason", "needed_s"), decide(found, ratios), strict=True))


def overlap_of(recordings: Recordings) -> float:
    """Return the samples of a block per sample that trains for it."""
    return float(np.mean([len(block) / len(rows) for rows, block in recordings.folds()]))


def decide(found: Mapping[str, Any], ratios: Sequence[float]) -> tuple[str, str, float | None]:
    """Return the verdict, why it is not decided, and which length would decide, s.

    Yes: the whole interval of the ratio lies below 1/1.05, P_o beats all its shifts, and does not
    repeat with the motion. No: the whole interval lies above 1/1.05. Otherwise it is not decided,
    for the one reason that matters most.
    """
    margin, mean, high = math.log(MARGIN), math.log(found["ratio"]), math.log(found["high"])
    shifts, needed_s = found["shifts"], None
    beaten = sum(found["with"]["error"] < error for error in shifts)
    if len(ratios) < LEAST_UNITS:
        needed_s = sides.seconds_of(LEAST_UNITS)
        return UNDECIDED, f"The recording is too short: it takes {needed_s:g} s.", needed_s
    if math.log(found["low"]) > -margin:
        return NO, "", None
    repeats = found["new"] is not None and found["new"] < sides.AWAY
    if high < -margin and not repeats and shifts and beaten == len(shifts):
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
        reason = (
            f"The recording is too short: if its ratio, {found['ratio']:.2f}, stays, it takes "
            f"{math.ceil(needed_s / 60.0)} minutes of this motion."
        )
        if needed_s > MOST_TIMES * found["duration_s"]:
            best, worst = np.exp(np.quantile(ratios, (0.25, 0.75)))
            reason = (
                f"Its parts disagree: the ratio is below {best:.2f} in a quarter of them and above "
                f"{worst:.2f} in another."
            )
    return UNDECIDED, reason, needed_s


def first_line(found: Mapping[str, Any], unit: str) -> str:
    """Return verdict, both errors and families, and the reason."""
    one, other = found["with"], found["without"]
    best = "FPRC" if one["family"] == "fuzzy" else f"{one['family']} + P_o"
    rival = "FPRC on low-passed theta" if other["family"] == "fuzzy" else other["family"]
    errors = [three_digits(side["error"]) for side in (one, other)]
    more = found["reason"]
    if found["verdict"] == NO and found["period_s"]:
        more = f"The motion repeats every {found['period_s']:.3g} s; on another one it may differ."
    both = f"with P_o {errors[0]} {unit} ({best}), without {errors[1]} ({rival})"
    return f"{found['verdict']}: {both}. {more}".rstrip()


def judge_memory(recordings: Recordings, models: Settings, seed: int) -> dict[str, Any]:
    """Measure memory and capacity of P_o and of theta, each with its low-passes.

    On one recording, thinned. ``linear`` and ``hysteresis`` are shares of P_o's variance on unseen
    blocks that a filter of theta explains, and that plays add.
    """
    found, explained, p_o = {}, [], recordings.p_o
    for name, signal in {"p_o": p_o, "theta": recordings.theta}.items():
        of = filtered_capacity(signal, recordings.theta, recordings.rate_hz)
        curves = {"lags_s": of.lags_s, "memory": of.memory, "degrees": of.degrees}
        found[name] = {key: values.tolist() for key, values in curves.items()}
        found[name] |= {"memory_s": of.memory_s, "rank": of.rank}
    for name in ("bank", "plays"):
        fits = BlockReadouts(recordings._replace(target=p_o), name, models, seed)
        errors = [fits.errors(block)[len(ALPHAS) // 2] for block in range(len(fits.blocks))]
        explained.append(max(0.0, 1.0 - float(np.mean(np.square(errors)) / np.var(p_o))))
    return found | {"linear": explained[0], "hysteresis": max(0.0, explained[1] - explained[0])}


def memory_in_words(found: Mapping[str, Any], new: float | None) -> list[str]:
    """Return what was measured as sentences."""
    p_o, theta, linear, plays = (found[key] for key in ("p_o", "theta", "linear", "hysteresis"))
    again = "" if new is None else f", and {new:.0%} is new at each repetition"
    degrees = [
        ", ".join(f"{share:.2g} of degree {number}" for number, share in enumerate(each, 1))
        for each in (p_o["degrees"], theta["degrees"])
    ]
    return [
        f"Memory beyond theta's newest {TAPS} samples: P_o and its low-passes have "
        f"{p_o['memory_s']:.2g} s, the same low-passes of theta {theta['memory_s']:.2g} s.",
        f"Capacity: {degrees[0]} of {p_o['rank']} states with P_o; {degrees[1]} of "
        f"{theta['rank']} with theta. The input is correlated, so these compare states on this "
        "recording only.",
        f"Of P_o's variance, a linear filter of theta explains {linear:.0%}, plays of theta "
        f"{plays:.0%} more, and neither {max(0.0, 1.0 - linear - plays):.0%}{again}.",
    ]


def draw_memory(found: Mapping[str, Any], png: str) -> None:
    """Draw the memory curves of P_o and of theta."""
    fig, ax = style.figure(1, 1, style.COLUMN_IN, 2.4)
    for name, colour, symbol in (("p_o", "0.15", "P$_o$"), ("theta", "0.65", "θ")):
        curve, label = found[name], f"{symbol} and its low-passes"
        ax.plot(curve["lags_s"], curve["memory"], color=colour, label=label)
    highest = max(found["p_o"]["memory"] + found["theta"]["memory"])
    ax.set(xlabel="Lag [s]", ylabel="Share of past θ added", xlim=(0, None))
    ax.set_ylim(0.0, max(0.1, 1.1 * highest))
    ax.legend()
    style.save(fig, {"source": "import"}, png)


def judge_models(recordings: Recordings, models: Settings, seed: int) -> dict[str, list[float]]:
    """Return the RMSE on blocks of each of the paper's models that suits the recording."""
    errors = {}
    for name in MODELS:
        if name != "esn" or len(recordings.theta) <= MOST_OF_ESN:
            with suppress(EvaluationError):
                fits = BlockReadouts(recordings, name, models, seed, as_is=True)
                errors[name] = [float(fits.errors(k)[0]) for k in range(len(fits.blocks))]
    return errors


def judge_claims(errors: Mapping[str, Sequence[float]], overlap: float) -> list[dict[str, Any]]:
    """Judge B1, B4 and R1 by the ratios of errors on blocks, see ``decide_together``."""
    claims = {}
    for name, (text, other) in CLAIMS.items():
        ratios = {}
        if "fprc" in errors and other in errors:
            ratios = dict(enumerate(np.log(errors["fprc"]) - np.log(errors[other])))
        claims[name] = text, [Part(text, ratios, overlap=overlap)]
    return decide_together(claims, LEFT_OUT)


def sentences(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return each verdict in a few sentences."""
    lines = []
    for row in rows:
        line = f"{row['claim'][:1].upper()}{row['claim'][1:]} ({row['id']}): {row['words']}."
        if row["mean"] is not None and row["units"] < LEAST_UNITS:
            line += f" Fewer than {LEAST_UNITS} blocks decide nothing."
        elif row["mean"] is not None:
            ratio = "{mean:#.3g} ({low:#.3g} to {high:#.3g})".format_map(row)
            line += f" FPRC's error is {ratio} times that of {title_of(CLAIMS[row['id']][1])}."
        lines.append(line)
    return lines
