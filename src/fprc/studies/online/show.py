"""Verdicts, tables and the figure of a model that learns while it runs."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes

from fprc.claims.paired import Part, judge_together, verdict_in_words
from fprc.studies.beyond.measurements import family_title, over_references

#: Loops, as readers see them.
LOOPS = {"open": "open loop", "closed": "closed loop"}

#: Growth of the error that D1 allows.
_MOST = 1.10

#: Claims in words.
CLAIMS = {
    "D1": "learning keeps tracking within 10 % of the undisturbed for offsets of P_o up to 5 kPa",
    "D2": "with learning, P_o still beats low-passed theta_d",
    "D3": "learning FPRC with PD beats PD alone, at 0.5 Hz and in the sweep",
    "D4": "the authors' next scheme with P_o beats the same without a reservoir",
}
#: Models, as readers see them.
_TITLES = {
    "fprc": "FPRC", "fprc_lowpass": "FPRC on low-passed theta_d", "fuzzy_linear": "Fuzzy-linear",
    "pd": "PD alone", "follow_up_linear": "next scheme, linear",
    "follow_up_p_o": "next scheme, P_o", "follow_up_esn": "next scheme, ESN of 50",
}  # fmt: skip

Family = Mapping[str, Any]
Key = tuple[str, str, bool, str]


def rmse_by_condition(family: Family) -> dict[Key, dict[int, dict[str, float]]]:
    """Return errors in deg by (model, condition, learns, loop), unit and reference."""
    found: dict[Key, dict[int, dict[str, float]]] = {}
    for cell in family["cells"]:
        for row in cell.get("rows", ()):
            key = row["model"], row["condition"], row["learns"], row["loop"]
            unit = found.setdefault(key, {}).setdefault(cell["unit"], {})
            unit[row["reference"]] = row["rmse_deg"]
    return found


def _overall(by_unit: Mapping[int, Mapping[str, float]]) -> dict[int, float]:
    """Return the root mean square over the references of Table IV, by unit."""
    return {unit: over_references(errors) for unit, errors in by_unit.items()}


def _part(
    text: str, ours: Mapping[int, float], theirs: Mapping[int, float], limit: float = 1.0
) -> Part:
    values = {unit: math.log(ours[unit] / theirs[unit] / limit) for unit in ours if unit in theirs}
    return Part(text, values, limit == 1.0, lambda value: limit * math.exp(value))


def parts_of(family: Family) -> list[list[Part]]:
    """Return the comparisons of D1 to D4."""
    errors = rmse_by_condition(family)

    def overall(model: str, condition: str = "none", loop: str = "closed") -> dict[int, float]:
        return _overall(errors.get((model, condition, True, loop), {}))

    def at(model: str, learns: bool, reference: str) -> dict[int, float]:
        by_unit = errors.get((model, "none", learns, "closed"), {})
        return {unit: rms_deg[reference] for unit, rms_deg in by_unit.items()}

    return [
        [
            _part(
                f"{offset}, {LOOPS[loop]}", overall("fprc", offset, loop=loop),
                overall("fprc", loop=loop), _MOST,
            )
            for loop in LOOPS
            for offset in ("-5 kPa", "+5 kPa")
        ],
        [
            _part(LOOPS[loop], overall("fprc", loop=loop), overall("fprc_lowpass", loop=loop))
            for loop in LOOPS
        ],
        [
            _part(words, at("fprc", True, name), at("pd", False, name))
            for name, words in (("sine_0p5", "0.5 Hz"), ("sweep", "sweep"))
        ],
        [_part("closed loop", overall("follow_up_p_o"), overall("follow_up_linear"))],
    ]  # fmt: skip


def _verdicts(families: Sequence[Family]) -> tuple[pd.DataFrame, pd.DataFrame, str]:
    nothing = dict.fromkeys(("mean", "low", "high"), math.nan)
    table = pd.DataFrame(
        {
            "family": family["name"],
            "id": name,
            "claim": CLAIMS[name],
            "part": part.text,
            "verdict": verdict_in_words(outcome.verdict, part.ratio, outcome.turned),
            **(part.ends(outcome.level) if len(part.values) > 1 else nothing),
            "units": len(part.values),
            "source": "sim",
        }
        for family in families
        for parts in [parts_of(family)]
        for name, of_claim, outcome in zip(CLAIMS, parts, judge_together(parts), strict=True)
        for part in of_claim
    )
    page = []
    for name, of_claim in table.groupby("id", sort=False):
        line = {"Id": name, "Claim": of_claim["claim"].iloc[0]}
        for family, of_family in of_claim.groupby("family", sort=False):
            ratios = ", ".join(f"{mean:.3g}" for mean in of_family["mean"])
            line[family_title(str(family))] = f"{of_family['verdict'].iloc[0]} {ratios}"
        page.append(line)
    note = (
        "Learning while it runs: verdicts on D1 to D4 of the preregistration, with the means of "
        "the ratios. D1: at -5 and +5 kPa, in open and in closed loop; D2: open and closed loop; "
        "D3: at 0.5 Hz and in the sweep."
    )
    return table, pd.DataFrame(page), note


def _errors(families: Sequence[Family]) -> tuple[pd.DataFrame, pd.DataFrame, str]:
    rows = []
    for family in families:
        for (model, condition, learns, loop), by_unit in rmse_by_condition(family).items():
            values = np.array(list(_overall(by_unit).values()))
            rows.append(
                {
                    "family": family["name"], "model": model, "condition": _words(condition),
                    "learns": learns, "loop": loop, "mean_deg": float(values.mean()),
                    "low_deg": float(values.min()), "high_deg": float(values.max()),
                    "units": len(values), "source": "sim",
                }
            )  # fmt: skip
    table = pd.DataFrame(rows)
    first = table[table["family"] == families[0]["name"]]
    page = []
    for (model, condition), by_loop in first.groupby(["model", "condition"], sort=False):
        line = {"Model": _TITLES[str(model)], "Changed since the training": str(condition)}
        for loop, words in LOOPS.items():
            for learns, how in ((False, "as trained"), (True, "learning")):
                cell = by_loop[(by_loop["loop"] == loop) & (by_loop["learns"] == learns)]
                value = "" if cell.empty else f"{cell['mean_deg'].iloc[0]:.2f}"
                line[f"{words[:1].upper()}{words[1:]}, {how}"] = value
        page.append(line)
    note = (
        f"Tracking error on the rig {family_title(families[0]['name'])}, root mean square over the "
        f"four references of Table IV, mean over {int(first['units'].max())} seeds [deg]. "
        "Re-zeroed, an FPRC with a constant offset of P_o is one without."
    )
    return table, pd.DataFrame(page), note


def _words(condition: str) -> str:
    if condition.endswith(" kPa"):
        return f"P_o {condition}"
    return {
        "none": "nothing", "leak": "P_o falls by 4 kPa a minute",
        "warmer": "5 K warmer from half the run on", "stiffer": "actuator 10 % stiffer",
        "worn": "20 % less friction",
    }[condition]  # fmt: skip


TABLES = {"verdicts": _verdicts, "errors": _errors}


def plot_offsets(table: pd.DataFrame, ax: Axes) -> None:
    """Draw the error of FPRC over the offset of P_o, as trained and learning; and PD alone."""
    of_fprc = table[table["model"] == "fprc"]
    offsets = of_fprc["condition"].str.extract(r"P_o ([+-][\d.]+) kPa")[0]
    offsets = offsets.mask(of_fprc["condition"] == _words("none"), "0")
    of_fprc = of_fprc.assign(offset=pd.to_numeric(offsets)).dropna(subset=["offset"])
    for learns, marker, color in ((False, "o", "0.55"), (True, "s", "black")):
        line = of_fprc[of_fprc["learns"] == learns].sort_values("offset")
        label = "FPRC, learning" if learns else "FPRC as trained"
        ax.plot(line["offset"], line["mean_deg"], marker=marker, color=color, markersize=3,
                label=label)  # fmt: skip
        ax.fill_between(line["offset"], line["low_deg"], line["high_deg"], color=color, alpha=0.2,
                        linewidth=0)  # fmt: skip
    other = table[(table["model"] == "fuzzy_linear") & (table["condition"] == _words("none"))]
    for learns, dashes in ((False, ":"), (True, "--")):
        level = other.loc[other["learns"] == learns, "mean_deg"]
        if len(level):
            label = "Fuzzy-linear, learning" if learns else "Fuzzy-linear as trained"
            ax.axhline(level.iloc[0], color="tab:blue", linestyle=dashes, linewidth=0.9,
                       label=label)  # fmt: skip
    ax.set(xlabel="Offset of $P_o$ [kPa]", ylabel="RMSE [deg]", ylim=(0, None))
