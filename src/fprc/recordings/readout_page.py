"""Page of `fprc readout`: what P_o and the other models contribute on a recording, in words."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from fprc.artifacts import read_json
from fprc.config import from_files
from fprc.escape import code
from fprc.logs import read_columns
from fprc.paper import SOURCES
from fprc.provenance import sha256
from fprc.recordings.claims import answer, sentences
from fprc.recordings.importing import ImportMap
from fprc.stages.tabulate import failed_checks

#: File and map of each raw log: those that train, ``sweep``, ``sweep_2``, ..., and ``complex``.
Parts = Mapping[str, tuple[str, ImportMap]]
_TARGETS = {"command": "commanded", "measured": "measured"}

#: Share of the variance of another channel that P_o explains only if it is a copy. A pressure loop
#: follows its command to 0.999.
_COPIES = {"p_target_kpa": ("P_exp, the target", 0.99), "theta_deg": ("theta", 0.9999)}


def report_page(
    parts: Parts,
    map_file: str,
    mapping: ImportMap,
    settings: Mapping[str, Any],
    folder: Path,
    report: Mapping[str, Any],
    rates: str,
) -> str:
    """Return the report as Markdown, with links to the pictures of the recording."""
    source = parts["complex"][0]
    further = [path for path, _ in parts.values() if path != source]
    default = from_files([]).model_dump(mode="json")["models"]
    lines = [
        f"# Value of the readout in {code(Path(source).name)}",
        "",
        f"Does P_o help the model on this recording? {answer(report['verdicts'])}",
        *(f"\n- Doubtful: {line}" for line in cautions(folder, settings)),
        "",
        f"Recording: {_with_hash(source)}; map: {code(map_file)}.",
        *([f"Training logs: {', '.join(map(_with_hash, further))}."] if further else []),
        f"Data: {SOURCES[report['source']]}.",
        rates,
        f"{what_trained(mapping, further)}; models as in the paper"
        f"{'' if settings['models'] == default else ', except for the settings given'}. "
        f"The models predict the {_TARGETS[report['target']]} P_exp.",
        "",
        "## The models",
        "",
        *(f"- {line}" for line in sentences(report["verdicts"])),
        "",
        "Each ratio is the geometric mean over blocks; below 1 it favours FPRC. The chance that "
        "any verdict is wrong is kept at 5 % (Holm), so an interval is wider than a 95 % interval. "
        "It is wider still because the models of all blocks share training data; this correction "
        "(Nadeau and Bengio 2003) is an approximation. A verdict holds for this recording and "
        "these settings, not for the rig on another day. Test errors have no interval and enter no "
        "verdict.",
        "",
        "Low-passed theta and P_o shifted in time are controls: P_o helps as a memory only if it "
        "beats both. Fuzzy-linear has no P_o.",
        "",
        (folder / "readout/competitors.md").read_text(encoding="utf-8"),
        "Every number: [readout/competitors.csv](readout/competitors.csv), errors of each block: "
        "[readout/competitors.json](readout/competitors.json).",
        "",
        "## The recording",
    ]
    for log, (path, _) in parts.items():
        part = "test part" if log == "complex" else "training part"
        if path != source:
            part = f"training log {code(Path(path).name)}"
        words = read_json(folder / f"raw/{log}.diagnosis.json")["words"]
        lines += ["", f"### {part[0].upper()}{part[1:]}", "", *(f"- {word}" for word in words)]
        lines += ["", f"![{part}](raw/{log}.diagnosis.png)"]
    return "\n".join(lines) + "\n"


def _with_hash(path: str) -> str:
    return f"{code(path)}, SHA-256 `{sha256(path)[:16]}`"


def rates_in_words(
    recorded_hz: Sequence[float],
    rate_hz: float,
    given: Mapping[str, Any],
    scaled: Mapping[str, Any],
) -> str:
    """Return the rates of the recordings, the rate that the models use, and what was scaled.

    ``given`` is the configuration, ``scaled`` that for the rate of the models.
    """
    recorded = ", ".join(f"{hz:g}" for hz in dict.fromkeys(recorded_hz))
    line = f"Sample rates: recorded at {recorded} Hz; the models use {rate_hz:g} Hz."
    before, after = given["models"], scaled["models"]
    reference_hz = given["control"]["sample_rate_hz"]
    if before == after:
        return f"{line} Settings in samples are for that rate: none was scaled."
    changes = [
        f"{section}.{key} {before[section][key]:g} to {after[section][key]:.4g}"
        for section, key in (("fprc", "epsilon"), ("esn", "gamma"), ("esn", "washout"))
    ]
    return (
        f"{line} Settings in samples were scaled from {reference_hz:g} Hz to the same time: "
        f"{', '.join(changes)}; the other low-passes and NVAR's spacing alike. "
        f"Taps keep their number (n_y = {after['n_y']}, n_u = {after['fprc']['n_u']}), so "
        f"they span {reference_hz / rate_hz:.3g} times the time."
    )


def what_trained(mapping: ImportMap, further: Sequence[str]) -> str:
    """Return in words which part of which recordings trains, and which tests."""
    logs = f"{len(further)} training log{'s' if len(further) > 1 else ''}"
    if mapping.test_from_s is None:
        return f"Trained on {logs}, tested on the whole recording"
    also = f" and on {logs}" if further else ""
    return f"Trained before {mapping.test_from_s:g} s{also}, tested after"


def cautions(folder: Path, settings: Mapping[str, Any]) -> list[str]:
    """Return what makes the answer doubtful: failed checks, a narrow theta, P_o as a copy."""
    quality = [str(folder / f"quality/{part}.json") for part in ("sweep", "complex")]
    lines = failed_checks(quality)
    channels = read_columns(
        folder / "data/sweep.h5", ("theta_deg", "p_target_kpa"), optional=("p_o_kpa",)
    ).channels
    theta, p_o = channels["theta_deg"], channels.get("p_o_kpa")
    for other, (name, most) in _COPIES.items():
        if p_o is not None and np.ptp(p_o) > 0.0 and np.ptp(channels[other]) > 0.0:
            explained = np.corrcoef(p_o, channels[other])[0, 1] ** 2
            if explained > most:
                lines.append(
                    f"a straight line of P_o explains {100.0 * explained:.4g} % of {name}: is its "
                    "column that of another signal, such as the actuator's own pressure?"
                )
    sigma = settings["models"]["fprc"]["sigma"]
    if (spread := np.std(theta)) < sigma:
        lines.append(
            f"theta_deg has a standard deviation of {spread:.2g}, and the rules' memberships a "
            f"width of sigma = {sigma:g}: they hardly depend on theta. If it is in rad, say so in "
            "the map; else scale it, or change models.fprc.sigma"
        )
    return lines
