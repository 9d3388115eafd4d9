"""`fprc readout`: say whether P_o of a recording is worth a second sensor, on one page."""

from collections.abc import Mapping, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from threadpoolctl import threadpool_limits

from fprc.artifacts import refuse_output, write_json, write_text
from fprc.channels import TARGETS
from fprc.config import check, from_files
from fprc.errors import ConfigError, LogError
from fprc.evaluation.rates import PAPER_HZ, settings_at
from fprc.evaluation.sides import PURGE_S, PURGES, SHIFTS, WARM_UP_S, Recordings
from fprc.given import read_json, refuse_repeats
from fprc.logs.quality import noted_unit
from fprc.paper import SOURCES
from fprc.plan import paper_models
from fprc.provenance import sha256
from fprc.recordings import answer
from fprc.recordings.clock import rate_of
from fprc.recordings.gather import Recording, gather, resample
from fprc.recordings.import_recording import draw_recording, is_imported, write_log
from fprc.recordings.importing import read_map
from fprc.recordings.judge import Judgement, judge, unexplained
from fprc.recordings.table import read_table
from fprc.tables.text import markdown, three_digits

#: Share of a recording that becomes the training log of the workflow unless the map gives
#: test_from_s.
_TRAINED = 2.0 / 3.0
#: Fewest blocks that can be predicted: one is left to train when two are out.
LEAST_BLOCKS = 3


def report_readout(
    source: str,
    *,
    map_: str,
    train: Sequence[str] = (),
    out: str | None = None,
    config: Sequence[str] = (),
) -> None:
    """Say whether P_o of a recording is worth a second sensor.

    All recordings are resampled whole. The logs for the workflow are parts of them, so that no
    sample between training and test is lost.
    """
    import_module("tabulate")  # pandas imports it at the end, when it writes a table
    given = from_files(config) if config else check({})
    settings = given.model_dump(mode="json")
    refuse_repeats([source, *train], "what is judged on its training samples proves nothing")
    mapping = read_map(map_)
    if "p_o_kpa" not in mapping.columns:
        raise ConfigError(f"{map_}: channels.p_o_kpa is missing: it is the sensor in question")
    folder = Path(out or Path("results", Path(source).stem))
    page, answered = folder / "report.md", folder / "readout/answer.json"
    tables = {path: read_table(path, **mapping.csv.model_dump()) for path in (source, *train)}
    hashes = [sha256(path) for path in tables]

    def is_ours(old: Path) -> bool:
        return answered.exists() and bool(read_json(answered).get("recordings") == hashes)

    refuse_output(page, ".md", ours=is_ours)
    target = mapping.target(settings["evaluation"]["target"])
    whole = mapping.changed(start_s=0.0, end_s=None)
    recorded: dict[str, tuple[Recording, Judgement]] = {}
    for path, table in tables.items():
        recording = gather(table, mapping if path == source else whole)
        recorded[path] = recording, judge(recording, mapping, table, given.quality, target)
    stops = [
        f"{path}: {line}"
        for path, (recording, found) in recorded.items()
        for line in found.stops or unexplained(recording, target)
    ]
    if stops:
        raise LogError("\n".join(stops))
    # that of the slowest recording, at least 1 Hz as in a map, at most the configuration's
    slowest_hz = max(1.0, min(rate_of(recording.time_s) for recording, _ in recorded.values()))
    rate_hz = mapping.sample_rate_hz or min(settings["control"]["sample_rate_hz"], slowest_hz)
    samples = [
        resample(recording.time_s, recording.channels, rate_hz, path)
        for path, (recording, _) in recorded.items()
    ]
    theta, p_o, p_exp = (
        np.concatenate([channels[name] for _, channels in samples])
        for name in ("theta_deg", "p_o_kpa", TARGETS[target])
    )
    recordings = Recordings(theta, p_o, p_exp, [len(time_s) for time_s, _ in samples], rate_hz)
    given_s, needed_s = len(theta) / rate_hz, WARM_UP_S + LEAST_BLOCKS * PURGES * PURGE_S
    if given_s < 0.9 * needed_s or len(recordings.thinned().folds()) < LEAST_BLOCKS:
        raise LogError(
            f"{source}: {given_s:.3g} s are too short to judge anything; at least {needed_s:g} s "
            "are needed"
        )
    time_s, begin_s = samples[0][0], recorded[source][0].since_s
    border_s = (mapping.test_from_s or 0.0) - begin_s
    if mapping.test_from_s is None:
        border_s = float(f"{_TRAINED * time_s[-1]:.4g}")
    border = int(np.searchsorted(time_s, border_s - 1e-9))  # it belongs to the test
    if not 2 <= border <= len(time_s) - 2:
        raise ConfigError(f"{map_}: test_from_s lies outside of the recording; correct it")
    parts = {
        "sweep": (0, slice(border), {"end_s": begin_s + float(time_s[border - 1])}),
        "complex": (0, slice(border, None), {"start_s": begin_s + float(time_s[border])}),
    } | {f"sweep_{k + 1}": (k, slice(None), {}) for k in range(1, len(samples))}
    raw = {name: folder / f"raw/{name}.h5" for name in parts}
    for log in raw.values():
        refuse_output(log, ".h5", ours=is_imported)
    with threadpool_limits(1):
        for name, (k, rows, changed) in parts.items():
            path, (recording, _) = list(recorded.items())[k]
            part = (mapping if k == 0 else whole).changed(
                experiment=name.partition("_")[0], sample_rate_hz=rate_hz, **changed
            )
            channels = {channel: values[rows] for channel, values in samples[k][1].items()}
            write_log(raw[name], recording, samples[k][0][rows], channels, part, path)
        for number, (recording, _) in enumerate(recorded.values(), 1):
            draw_recording(recording, mapping, str(folder / f"raw/recording_{number}.png"))
        unit = noted_unit(TARGETS[target], {"notes": mapping.notes})
        models, own = (paper_models(settings_at(settings, hz)) for hz in (PAPER_HZ, rate_hz))
        seed, thin = settings["seed"], recordings.thinned()
        found = answer.answer_recordings(recordings, models, seed, unit)
        cells = answer.judge_models(recordings, own, seed)
        report: dict[str, Any] = {
            "recordings": hashes, "unit": unit, "source": "import", "target": target,
            "answer": found, "memory": answer.judge_memory(thin, models, seed, found["period_s"]),
            "cells": cells, "claims": answer.judge_claims(cells, answer.overlap_of(recordings)),
        }  # fmt: skip
        write_json(answered, report)
        answer.draw_memory(report["memory"], str(folder / "readout/memory.png"))
        write_text(page, _page(recorded, map_, report, rate_hz))
    doubts = [f"Doubtful: {line}" for _, judged in recorded.values() for line in judged.doubts]
    print("\n".join([found["words"], *doubts, *answer.sentences(report["claims"]), str(page)]))


def _page(
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
    note = (
        f"Geometric mean of the RMSE over {blocks} blocks of {np.mean(found['block_s']):.3g} s. "
        "Each block is predicted by models that the other blocks trained, without 2 s on each side "
        "of it; families and settings are chosen by these other blocks alone."
    )
    lines = [
        f"# Is P_o worth a second sensor in {names}?",
        f"**{verdict}**:{rest}",
        *(f"- Doubtful: {line}" for _, judged in recorded.values() for line in judged.doubts),
        f"Map: `{map_file}`. Data: {SOURCES[report['source']]}. Predicted is P_exp "
        f"({report['target']}).",
        "## What the answer rests on",
        f"- Ratio of the errors, with P_o over without: {found['ratio']:.3f} "
        f"({found['low']:.3f} to {found['high']:.3f}, 95 %). Worth a second sensor is what lies "
        f"below {1.0 / answer.MARGIN:.3f}.",
        f"- P_o of another time, in {len(shifts)} trials: the error is "
        f"{three_digits(min(shifts))} to {three_digits(max(shifts))}; P_o beats {beaten} of them."
        if shifts
        else f"- The motion repeats so often that fewer than {SHIFTS} shifts of P_o are controls.",
        f"- The motion {f'repeats every {period:.3g} s' if period else 'does not repeat'}.",
        f"- Without P_o, {100.0 * found['explained']:.3g} % of P_exp's variance are explained.",
        markdown(sides, note),
        "## What P_o remembers",
        *(f"- {line}" for line in answer.memory_in_words(report["memory"])),
        "![memory and capacity of P_o](readout/memory.png)",
        "## The paper's models",
        "Settings are the paper's, unless `--config` gave others; those that count samples are "
        f"scaled to {rate_hz:g} Hz, the rate of the models. Taps keep their number.",
        *(f"- {line}" for line in answer.sentences(report["claims"])),
        "Each ratio is the geometric mean over blocks; below 1 it favours FPRC. The chance that "
        "any of these verdicts is wrong is kept at 5 % (Holm).",
        "Every number: [readout/answer.json](readout/answer.json).",
    ]
    files = zip(recorded.items(), report["recordings"], strict=True)
    for number, ((path, (recording, judged)), digest) in enumerate(files, 1):
        lines += [f"## `{path}`", f"SHA-256 `{digest[:16]}`."]
        lines += [f"- {word}" for word in (*judged.words, *recording.notes)]
        lines += [f"![it](raw/recording_{number}.png)"]
    return "\n\n".join(lines) + "\n"
