"""Claims on a user's recording: those of B1-B8 that need no rig, and FPRC against no P_o.

docs/archive/preregistration.md states them with their limits.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from fprc.evaluation.paired import (
    AGREEING,
    EQUIVALENT,
    INFERIOR,
    LEAST_UNITS,
    NOT_JUDGED,
    SUPERIOR,
    UNDECIDED,
    Part,
    judge_together,
)
from fprc.registry import title_of

#: Blocks that a subset leaves out; fewer than of forty seeds, since there are only ten.
LEFT_OUT = 2


#: FPRC against one competitor each: text and competitor by id, as in
#: ``fprc.studies.beyond.claims``; R marks claims on recordings only.
CLAIMS = {
    "B1": ("P_o beats low-passed theta", "fprc_lowpass"),
    "B4": ("the fuzzy readout beats a ridge on the same features", "ridge_p_o"),
    "R1": ("FPRC beats the same readout without P_o", "fuzzy_linear"),
}


def judge_recording(report: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Judge the claims by paired ratios of the errors on blocks.

    Parameters
    ----------
    report : Mapping
        ``cells``: each with ``model`` and ``validation_rmse_kpa``, one per block, or ``reason``;
        ``overlap``: samples that judge per sample that trains.

    Returns
    -------
    list of dict
        ``id``, ``claim``, ``verdict``, ``p``, ``level`` and ``stable`` as ``judge_together`` gives
        them, ``blocks``, ``reason`` (why it is undecided or not judged), ``other``, and ``ratio``,
        ``low``, ``high``, which are None if it is not judged. A ratio below 1 supports the claim.
    """
    errors = {cell["model"]: cell.get("validation_rmse_kpa", ()) for cell in report["cells"]}
    claims = {}
    for name, (text, other) in CLAIMS.items():
        # not strict: a model that failed has no blocks
        pairs = enumerate(zip(errors["fprc"], errors[other], strict=False))
        ratios = {
            block: math.log(ours) - math.log(theirs)
            for block, (ours, theirs) in pairs
            if ours > 0.0 and theirs > 0.0
        }
        claims[name] = text, [Part(text, ratios, overlap=report["overlap"])]
    kept = ("id", "claim", "verdict", "p", "level", "stable", "turned", "words")
    return [
        {
            **{key: row[key] for key in kept},
            "blocks": row["units"],
            "reason": _reason(row),
            "other": title_of(CLAIMS[row["id"]][1]),
            "ratio": row["mean"],
            **{end: row[end] for end in ("low", "high")},
        }
        for row in judge_together(claims, LEFT_OUT)
    ]


def answer(rows: Sequence[Mapping[str, Any]]) -> str:
    """Return in one sentence whether P_o pays on this recording.

    It pays if FPRC beats both the same readout without P_o (R1) and that on low-passed theta (B1).
    """
    by_id = {row["id"]: row for row in rows}
    alone, lowpass = (by_id[name]["verdict"] for name in ("R1", "B1"))
    if NOT_JUDGED in (alone, lowpass):
        return "**Not judged**: too few blocks have an error of all models; see the reasons below."
    if alone == lowpass == SUPERIOR:
        return (
            "**Yes**: with P_o the error is lower than without it, and than with low-passed theta."
        )
    for against, words in ((INFERIOR, "higher than {}"), (EQUIVALENT, "as low as {}, within 5 %")):
        if against in (alone, lowpass):
            other = (
                "without it" if alone == against else "with low-passed theta, which costs nothing"
            )
            return f"**No**: with P_o the error is {words.format(other)}."
    undecided = by_id["R1" if alone == UNDECIDED else "B1"]
    return (
        f"**Not decided**: whether {undecided['claim']}. {undecided['reason']} A longer recording "
        "of the same motion, or several, may decide it."
    )


def sentences(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return each verdict in a few sentences."""
    lines = []
    for row in rows:
        line = f"{row['claim']} ({row['id']}): {row['words']}."
        if row["ratio"] is not None:
            decides = row["blocks"] >= LEAST_UNITS  # the interval of a few blocks has no end
            interval = f"({row['low']:#.3g} to {row['high']:#.3g}) " if decides else ""
            line += f" FPRC's error is {row['ratio']:#.3g} {interval}times that of {row['other']}."
        lines.append(f"{line[0].upper()}{line[1:]} {row['reason']}".rstrip())
    return lines


def _reason(row: Mapping[str, Any]) -> str:
    """Return why a claim is undecided or not judged; empty if it is decided."""
    blocks = row["units"]
    if row["verdict"] == NOT_JUDGED:
        return f"Only {blocks} blocks have an error of both models; at least 2 are needed."
    if row["verdict"] != UNDECIDED:
        return ""
    if blocks < LEAST_UNITS:
        return f"There are {blocks} blocks; fewer than {LEAST_UNITS} decide nothing."
    if row["stable"] is not None:
        return (
            f"Without {LEFT_OUT} random blocks the verdict stays in {100 * row['stable']:.0f} % "
            f"of the cases; {100 * AGREEING:.0f} % are needed, so it counts as undecided."
        )
    return "The interval contains 1 and is not within 5 % of it."
