"""Page of `fprc readout`: the answer, what it rests on, and the paper's models, in words."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from fprc.config import from_files
from fprc.evaluation.sides import SHIFTS
from fprc.paper import SOURCES
from fprc.recordings.answer import MARGIN, family_title
from fprc.recordings.gather import Recording
from fprc.recordings.judge import Judgement
from fprc.recordings.memory import memory_in_words
from fprc.recordings.paper_models import sentences
from fprc.registry import title_of
from fprc.tables.text import markdown, three_digits

_TARGETS = {"command": "commanded", "measured": "measured"}


class Recorded(NamedTuple):
    """A recording, and what was found in it."""

    recording: Recording
    found: Judgement


def report_page(
    recorded: Mapping[str, Recorded],
    map_file: str,
    settings: Mapping[str, Any],
    report: Mapping[str, Any],
    rate_hz: float,
) -> str:
    """Return the report as Markdown, with links to the pictures of each recording, by file."""
    found, unit, period = report["answer"], report["unit"], report["answer"]["period_s"]
    verdict, _, rest = found["words"].partition(":")
    blocks, shifts = len(found["block_s"]), found["shifts"]
    beaten = sum(found["with"]["error"] < error for error in shifts)
    names = ", ".join(f"`{Path(path).name}`" for path in recorded)
    sides = pd.DataFrame(
        {
            "Family": f"{family_title(family, False)}; {family_title(family, True)}"
            if family == "fuzzy"
            else family,
            f"Without P_o [{unit}]": three_digits(found["without"]["families"][family]),
            f"With P_o [{unit}]": three_digits(found["with"]["families"][family]),
            "Chosen without": f"{found['without']['chosen'].count(family)} of {blocks}",
            "Chosen with": f"{found['with']['chosen'].count(family)} of {blocks}",
        }
        for family in found["with"]["families"]
    )
    of_each = f"Geometric mean of the RMSE over {blocks} blocks"
    note = (
        f"{of_each} of {three_digits(float(np.mean(found['block_s'])))} s. Each block is predicted "
        "by models that the other blocks trained, without 2 s on each side of it; families and "
        "settings are chosen by these other blocks alone."
    )
    paper = pd.DataFrame(
        {
            "Model": title_of(cell["model"]),
            f"Blocks [{unit}]": cell.get("reason")
            or three_digits(float(np.exp(np.log(cell["blocks"]).mean()))),
        }
        for cell in report["cells"]
    )
    default = from_files([]).model_dump(mode="json")["models"] == settings["models"]
    own = "the paper's" if default else "the paper's, except for those given"
    lines = [
        f"# Is P_o worth a second sensor in {names}?",
        f"**{verdict}**:{rest}",
        *(f"- Doubtful: {line}" for one in recorded.values() for line in one.found.doubts),
        f"Map: `{map_file}`. Data: {SOURCES[report['source']]}. Predicted is the "
        f"{_TARGETS[report['target']]} P_exp.",
        "## What the answer rests on",
        f"- Ratio of the errors, with P_o over without: {found['ratio']:.3f} "
        f"({found['low']:.3f} to {found['high']:.3f}, 95 %). Worth a second sensor is what lies "
        f"below {1.0 / MARGIN:.3f}.",
        f"- P_o of another time, in {len(shifts)} trials: the error is "
        f"{three_digits(min(shifts))} to {three_digits(max(shifts))}; P_o beats {beaten} of them."
        if shifts
        else f"- The motion repeats so often that fewer than {SHIFTS} shifts of P_o are controls.",
        f"- The motion repeats every {period:.3g} s."
        if period
        else "- The motion does not repeat.",
        f"- Without P_o, {100.0 * found['explained']:.3g} % of P_exp's variance are explained.",
        markdown(sides, note),
        "## What P_o remembers",
        *(f"- {line}" for line in memory_in_words(report["memory"])),
        "![memory and capacity of P_o](readout/memory.png)",
        "## The paper's models",
        f"Settings are {own}; those that count samples are scaled to {rate_hz:g} Hz, the rate of "
        "the models. Taps keep their number.",
        *(f"- {line}" for line in sentences(report["claims"])),
        "Each ratio is the geometric mean over blocks; below 1 it favours FPRC. The chance that "
        "any of these verdicts is wrong is kept at 5 % (Holm).",
        markdown(paper, f"{of_each}."),
        "Every number: [readout/answer.json](readout/answer.json).",
    ]
    files = zip(recorded.items(), report["recordings"], strict=True)
    for number, ((path, one), digest) in enumerate(files, 1):
        lines += [f"## `{path}`", f"SHA-256 `{digest[:16]}`."]
        lines += [f"- {word}" for word in (*one.found.words, *one.recording.notes)]
        lines += [f"![it](raw/recording_{number}.png)"]
    return "\n\n".join(lines) + "\n"
