"""Page of `fprc readout`: the answer, what it rests on, and the paper's models, in words."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from fprc.evaluation.sides import SHIFTS
from fprc.paper import SOURCES
from fprc.recordings.answer import MARGIN
from fprc.recordings.beside import memory_in_words, sentences
from fprc.recordings.gather import Recording
from fprc.recordings.judge import Judgement
from fprc.registry import title_of
from fprc.tables.text import markdown, three_digits

_TARGETS = {"command": "commanded", "measured": "measured"}


def report_page(
    recorded: Mapping[str, tuple[Recording, Judgement]],
    map_file: str,
    report: Mapping[str, Any],
    rate_hz: float,
) -> str:
    """Return the report as Markdown, with links to the pictures of each recording, by file."""
    found, unit = report["answer"], report["unit"]
    verdict, _, rest = found["words"].partition(":")
    blocks, shifts, period = len(found["block_s"]), found["shifts"], found["period_s"]
    beaten = sum(found["with"]["error"] < error for error in shifts)
    names = ", ".join(f"`{Path(path).name}`" for path in recorded)
    sides = pd.DataFrame(
        {
            "Family": "FPRC, without P_o on low-passed theta" if family == "fuzzy" else family,
            f"Without P_o [{unit}]": three_digits(found["without"]["families"][family]),
            f"With P_o [{unit}]": three_digits(error),
            "Chosen without": f"{found['without']['chosen'].count(family)} of {blocks}",
            "Chosen with": f"{found['with']['chosen'].count(family)} of {blocks}",
        }
        for family, error in found["with"]["families"].items()
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
    lines = [
        f"# Is P_o worth a second sensor in {names}?",
        f"**{verdict}**:{rest}",
        *(f"- Doubtful: {line}" for _, judged in recorded.values() for line in judged.doubts),
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
        f"- The motion {f'repeats every {period:.3g} s' if period else 'does not repeat'}.",
        f"- Without P_o, {100.0 * found['explained']:.3g} % of P_exp's variance are explained.",
        markdown(sides, note),
        "## What P_o remembers",
        *(f"- {line}" for line in memory_in_words(report["memory"])),
        "![memory and capacity of P_o](readout/memory.png)",
        "## The paper's models",
        "Settings are the paper's, unless `--config` gave others; those that count samples are "
        f"scaled to {rate_hz:g} Hz, the rate of the models. Taps keep their number.",
        *(f"- {line}" for line in sentences(report["claims"])),
        "Each ratio is the geometric mean over blocks; below 1 it favours FPRC. The chance that "
        "any of these verdicts is wrong is kept at 5 % (Holm).",
        markdown(paper, f"{of_each}."),
        "Every number: [readout/answer.json](readout/answer.json).",
    ]
    files = zip(recorded.items(), report["recordings"], strict=True)
    for number, ((path, (recording, judged)), digest) in enumerate(files, 1):
        lines += [f"## `{path}`", f"SHA-256 `{digest[:16]}`."]
        lines += [f"- {word}" for word in (*judged.words, *recording.notes)]
        lines += [f"![it](raw/recording_{number}.png)"]
    return "\n\n".join(lines) + "\n"
