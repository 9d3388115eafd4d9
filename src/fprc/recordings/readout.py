"""`fprc readout`: say whether P_o of a recording is worth a second sensor, on one page."""

from collections.abc import Mapping, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from threadpoolctl import threadpool_limits

from fprc.artifacts import refuse_output, sha256, write_json, write_text
from fprc.channels import TARGETS
from fprc.config import check, from_files
from fprc.errors import ConfigError, LogError
from fprc.evaluation import sides
from fprc.evaluation.capacity import least_samples
from fprc.given import read_json
from fprc.logs.quality import noted_unit
from fprc.paper import SOURCES
from fprc.plan import paper_models
from fprc.recordings import answer
from fprc.recordings.clock import rate_of
from fprc.recordings.import_recording import draw, judge, unfit
from fprc.recordings.importing import gather, is_imported, read_map, resample, write_log
from fprc.recordings.table import read_table
from fprc.registry import title_of
from fprc.tables.text import markdown, three_digits

#: Share of a recording that becomes the workflow's training log, without test_from_s in the map.
_TRAINED = 2.0 / 3.0
#: Fewest blocks that can be predicted: one is left to train when two are out.
LEAST_BLOCKS = 3


def report_readout(
    source: str, *, map_: str, out: str | None = None, config: Sequence[str] = ()
) -> None:
    """Say whether P_o of a recording is worth a second sensor.

    It is resampled whole. The logs for the workflow are parts of that, so that no sample between
    training and test is lost.
    """
    import_module("tabulate")  # pandas imports it at the end, when it writes a table
    given = from_files(config) if config else check({})
    settings, mapping = given.model_dump(mode="json"), read_map(map_)
    if "p_o_kpa" not in mapping.columns:
        raise ConfigError(f"{map_}: channels.p_o_kpa is missing: it is the sensor in question")
    folder = Path(out or Path("results", Path(source).stem))
    page, answered = folder / "report.md", folder / "readout/answer.json"
    table, digest = read_table(source, **mapping.csv.model_dump()), sha256(source)
    again = answered.exists() and read_json(answered).get("sha256") == digest
    for path in (page, answered):
        refuse_output(path, path.suffix, ours=lambda old: again)
    raw = {name: folder / f"raw/{name}.h5" for name in ("sweep", "complex")}
    for log in raw.values():
        refuse_output(log, ".h5", ours=is_imported)
    recording, target = gather(table, mapping), mapping.target(settings["evaluation"]["target"])
    words, doubts, stops = judge(recording, mapping, table, given.quality, target)
    if stops:
        raise LogError("\n".join(f"{source}: {line}" for line in stops))
    # its own, at least 1 Hz as in a map, at most the configuration's
    control_hz, own_hz = settings["control"]["sample_rate_hz"], max(1.0, rate_of(recording.time_s))
    rate_hz = mapping.sample_rate_hz or min(control_hz, own_hz)
    time_s, channels = resample(recording, rate_hz)
    theta, p_o, p_exp = (channels[name] for name in ("theta_deg", "p_o_kpa", TARGETS[target]))
    recordings = sides.Recordings(theta, p_o, p_exp, [len(time_s)], rate_hz)
    thin = recordings.thinned()
    least, needed_s = least_samples(thin.rate_hz), sides.seconds_of(LEAST_BLOCKS)
    long_enough = time_s[-1] >= 0.9 * needed_s and len(thin.theta) >= least
    if not long_enough or len(thin.folds()) < LEAST_BLOCKS:
        needed_s = max(needed_s, least / thin.rate_hz)
        short = f"{time_s[-1]:.3g} s at {rate_hz:.3g} Hz are too short"
        raise LogError(f"{source}: {short}; it takes {needed_s:.3g} s")
    if stops := unfit(recording, target):
        raise LogError("\n".join(f"{source}: {line}" for line in stops))
    border_s = float(f"{_TRAINED * time_s[-1]:.4g}")
    if mapping.test_from_s is not None:
        border_s = mapping.test_from_s - recording.since_s
    border = int(np.searchsorted(time_s, border_s - 1e-9))  # it belongs to the test
    if not 2 <= border <= len(time_s) - 2:
        raise ConfigError(f"{map_}: test_from_s lies outside of the recording; correct it")
    with threadpool_limits(1):
        for name, rows in {"sweep": slice(border), "complex": slice(border, None)}.items():
            part = mapping.changed(experiment=name, sample_rate_hz=rate_hz)
            rest = {channel: values[rows] for channel, values in channels.items()}
            write_log(raw[name], recording, time_s[rows], rest, part)
        draw(recording, mapping.notes, folder / "raw/recording.png")
        unit = noted_unit(TARGETS[target], {"notes": mapping.notes})
        models = sides.models_at(paper_models(settings), sides.PAPER_HZ / control_hz)
        seed = settings["seed"]
        found = answer.answer_recordings(recordings, models, seed)
        found["words"] = answer.first_line(found, unit)
        errors = answer.judge_models(recordings, models, seed)
        report: dict[str, Any] = {
            "sha256": digest, "map": map_, "unit": unit, "source": "import", "target": target,
            "rate_hz": rate_hz, "recording": [*words, *recording.notes],
            "doubts": doubts, "answer": found, "models": errors,
            "memory": answer.judge_memory(thin, models, seed),
            "claims": answer.judge_claims(errors, answer.overlap_of(recordings)),
        }  # fmt: skip
        write_json(answered, report)
        answer.draw_memory(report["memory"], str(folder / "readout/memory.png"))
        write_text(page, _page(source, report))
    doubts = [f"Doubtful: {line}" for line in doubts]
    print("\n".join([found["words"], *doubts, *answer.sentences(report["claims"]), str(page)]))


def _page(source: str, report: Mapping[str, Any]) -> str:
    """Return the report as Markdown."""
    found, unit = report["answer"], report["unit"]
    blocks, shifts, period = len(found["block_s"]), found["shifts"], found["period_s"]
    beaten = sum(found["with"]["error"] < error for error in shifts)
    table = pd.DataFrame(
        {
            "Family": "FPRC, without P_o on low-passed theta" if family == "fuzzy" else family,
            f"Without P_o [{unit}]": three_digits(found["without"]["families"][family]),
            f"With P_o [{unit}]": three_digits(error),
            "Chosen without": f"{found['without']['chosen'].count(family)} of {blocks}",
            "Chosen with": f"{found['with']['chosen'].count(family)} of {blocks}",
        }
        for family, error in found["with"]["families"].items()
    )
    left_out = ", ".join(title_of(name) for name in answer.MODELS if name not in report["models"])
    note = (
        f"Geometric mean of the RMSE over {blocks} blocks of {np.mean(found['block_s']):.3g} s, "
        "each predicted by models that the others trained and chose, without 2 s on each side."
    )
    lines = [
        f"# Is P_o worth a second sensor in `{Path(source).name}`?",
        f"**{found['words']}**",
        *(f"- Doubtful: {line}" for line in report["doubts"]),
        f"Map: `{report['map']}`. Data: {SOURCES['import']}. Target: P_exp ({report['target']}).",
        "## What the answer rests on",
        f"- Ratio of the errors, with P_o over without: {found['ratio']:.3f} "
        f"({found['low']:.3f} to {found['high']:.3f}, 95 %). Worth a second sensor is what lies "
        f"below {1.0 / answer.MARGIN:.3f}.",
        f"- The motion {f'repeats every {period:.3g} s' if period else 'does not repeat'}.",
        f"- P_o beats P_o of another time in {beaten} of {len(shifts)} trials.",
        f"- Without P_o, {100.0 * found['explained']:.3g} % of P_exp's variance are explained.",
        markdown(table, note),
        "## What P_o remembers",
        *(f"- {line}" for line in answer.memory_in_words(report["memory"], found["new"])),
        "![memory of P_o](readout/memory.png)",
        "## The paper's models",
        "Settings are the paper's, unless `--config` gave others; those that count samples are "
        f"scaled to {report['rate_hz']:g} Hz. Taps keep their number.",
        *(f"- {line}" for line in answer.sentences(report["claims"])),
        *([f"Left out, for too few samples or (ESN) too many: {left_out}."] if left_out else []),
        "Each ratio is the geometric mean over blocks; below 1 it favours FPRC. The chance that "
        "any of these verdicts is wrong is kept at 5 % (Holm).",
        "Every number: [readout/answer.json](readout/answer.json).",
        f"## `{source}`",
        f"SHA-256 `{report['sha256'][:16]}`.",
        *(f"- {line}" for line in report["recording"]),
        "![it](raw/recording.png)",
    ]
    return "\n\n".join(lines) + "\n"
