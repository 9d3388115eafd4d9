"""Page of `fprc readout`: the answer, what it rests on, and the paper's models, in words."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from fprc.config import from_files
from fprc.evaluation.rates import settings_at
from fprc.evaluation.sides import SHIFTS
from fprc.paper import SOURCES
from fprc.recordings.answer import MARGIN, family_title
from fprc.recordings.gather import Recording
from fprc.recordings.judge import Judgement
from fprc.recordings.memory import memory_in_words
from fprc.recordings.paper_models import sentences
from fprc.registry import title_of
from fprc.tables.text import three_digits, write_table

_TARGETS = {"command": "commanded", "measured": "measured"}


class Recorded(NamedTuple):
    """A recording, and what was found in it."""

    recording: Recording
    found: Judgement


def report_page(
    recorded: Mapping[str, Recorded],
    map_file: str,
    settings: Mapping[str, Any],
    folder: Path,
    report: Mapping[str, Any],
    rates: str,
) -> str:
    """Return the report as Markdown, with links to the pictures of each recording, by file."""
    found = report["answer"]
    default = from_files([]).model_dump(mode="json")["models"]
    verdict, _, rest = found["words"].partition(":")
    doubts = [line for one in recorded.values() for line in one.found.doubts]
    names = ", ".join(f"`{Path(path).name}`" for path in recorded)
    lines = [
        f"# Is P_o worth a second sensor in {names}?",
        "",
        f"**{verdict}**:{rest}",
        *(f"\n- Doubtful: {line}" for line in doubts),
        "",
        f"Map: `{map_file}`. Data: {SOURCES[report['source']]}. Predicted is the "
        f"{_TARGETS[report['target']]} P_exp.",
        "",
        "## What the answer rests on",
        "",
        *(f"- {line}" for line in _grounds(found)),
        "",
        _read(folder / "readout/sides.md"),
        "## What P_o remembers",
        "",
        *(f"- {line}" for line in memory_in_words(report["memory"])),
        "",
        "![memory and capacity of P_o](readout/memory.png)",
        "",
        "## The paper's models",
        "",
        f"{rates} Settings as in the paper"
        f"{'' if settings['models'] == default else ', except for the settings given'}; no model "
        "is tuned to this recording.",
        "",
        *(f"- {line}" for line in sentences(report["claims"])),
        "",
        "Each ratio is the geometric mean over blocks; below 1 it favours FPRC. The chance that "
        "any of these verdicts is wrong is kept at 5 % (Holm).",
        "",
        _read(folder / "readout/paper.md"),
        "Every number: [readout/answer.json](readout/answer.json).",
    ]
    for number, ((path, one), digest) in enumerate(
        zip(recorded.items(), report["recordings"], strict=True), 1
    ):
        words = (*one.found.words, *one.recording.notes)
        lines += ["", f"## `{path}`", "", f"SHA-256 `{digest[:16]}`.", ""]
        lines += [*(f"- {word}" for word in words), "", f"![it](raw/recording_{number}.png)"]
    return "\n".join(lines) + "\n"


def _read(path: Path) -> str:
    return path.read_text(encoding="utf-8")


def _grounds(found: Mapping[str, Any]) -> list[str]:
    """Return what was compared, and how it came out, in sentences."""
    beaten = sum(found["with"]["error"] < error for error in found["shifts"])
    shifted = (
        f"P_o of another time, in {len(found['shifts'])} trials: the error is "
        f"{three_digits(min(found['shifts']))} to {three_digits(max(found['shifts']))}; P_o beats "
        f"{beaten} of them."
        if found["shifts"]
        else f"The motion repeats so often that fewer than {SHIFTS} shifts of P_o are controls."
    )
    period = found["period_s"]
    return [
        f"Ratio of the errors, with P_o over without: {found['ratio']:.3f} "
        f"({found['low']:.3f} to {found['high']:.3f}, 95 %). Worth a second sensor is what lies "
        f"below {1.0 / MARGIN:.3f}.",
        shifted,
        f"The motion repeats every {period:.3g} s." if period else "The motion does not repeat.",
        f"Without P_o, {100.0 * found['explained']:.3g} % of the variance of P_exp are explained.",
    ]


def write_tables(report: Mapping[str, Any], folder: Path) -> None:
    """Write the errors of both sides, and those of the paper's models, as CSV and Markdown."""
    found, unit = report["answer"], report["unit"]
    blocks = len(found["block_s"])
    length = three_digits(float(np.mean(found["block_s"])))
    note = (
        f"Geometric mean of the RMSE over {blocks} blocks of {length} s. Each block is predicted "
        "by models that the other blocks trained, without 2 s on each side of it; families and "
        "settings are chosen by these other blocks alone."
    )
    sides = pd.DataFrame(
        {
            "family": family,
            "without": found["without"]["families"][family],
            "with": found["with"]["families"][family],
            "chosen_without": found["without"]["chosen"].count(family),
            "chosen_with": found["with"]["chosen"].count(family),
            "unit": unit,
        }
        for family in found["with"]["families"]
    )
    page = pd.DataFrame(
        {
            "Family": f"{family_title(row.family, False)}; {family_title(row.family, True)}"
            if row.family == "fuzzy"
            else row.family,
            f"Without P_o [{unit}]": three_digits(row.without),
            f"With P_o [{unit}]": three_digits(row.with_p_o),
            "Chosen without": f"{row.chosen_without} of {blocks}",
            "Chosen with": f"{row.chosen_with} of {blocks}",
        }
        for row in sides.rename(columns={"with": "with_p_o"}).itertuples()
    )
    write_table(sides, page, note, str(folder / "sides.csv"), str(folder / "sides.md"))
    paper = pd.DataFrame(
        {
            "model": cell["model"],
            "rmse": float(np.exp(np.log(cell["blocks"]).mean())) if "blocks" in cell else np.nan,
            "unit": unit,
            "reason": cell.get("reason", ""),
        }
        for cell in report["cells"]
    )
    page = pd.DataFrame(
        {
            "Model": title_of(row.model),
            f"Blocks [{unit}]": row.reason or three_digits(row.rmse),
        }
        for row in paper.itertuples()
    )
    note = f"Geometric mean of the RMSE over {blocks} blocks."
    write_table(paper, page, note, str(folder / "paper.csv"), str(folder / "paper.md"))


def rates_in_words(
    recorded_hz: Sequence[float], rate_hz: float, settings: Mapping[str, Any]
) -> str:
    """Return the rates of the recordings, the rate that the models use, and what was scaled."""
    recorded = ", ".join(f"{hz:g}" for hz in dict.fromkeys(recorded_hz))
    line = f"Sample rates: recorded at {recorded} Hz; the models use {rate_hz:g} Hz."
    before, after = settings["models"], settings_at(settings, rate_hz)["models"]
    if before == after:
        return f"{line} Settings in samples are for that rate: none was scaled."
    changes = [
        f"{section}.{key} {before[section][key]:g} to {after[section][key]:.4g}"
        for section, key in (("fprc", "epsilon"), ("esn", "gamma"), ("esn", "washout"))
    ]
    return (
        f"{line} Settings in samples were scaled to the same time: {', '.join(changes)}; taps keep "
        "their number."
    )
