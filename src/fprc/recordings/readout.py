"""`fprc readout`: say whether P_o of a recording is worth a second sensor."""

import sys
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from fprc.artifacts import (
    is_json_with,
    read_json,
    refuse_output,
    write_json,
    write_text,
)
from fprc.channels import TARGETS
from fprc.config import from_files
from fprc.errors import ConfigError, FprcError, LogError
from fprc.evaluation.rates import PAPER_HZ, settings_at
from fprc.evaluation.sides import PURGE_S, PURGES, SHIFTS, WARM_UP_S, Recordings, progress
from fprc.given import refuse_repeats
from fprc.logs.quality import noted_unit
from fprc.plan.arguments import paper_models
from fprc.provenance import sha256
from fprc.recordings.answer import answer_recordings
from fprc.recordings.clock import rate_of
from fprc.recordings.gather import gather
from fprc.recordings.import_recording import is_imported, write_log
from fprc.recordings.importing import read_map
from fprc.recordings.judge import judge
from fprc.recordings.memory import draw_memory, judge_memory
from fprc.recordings.paper_models import MODELS, judge_claims, judge_models, sentences
from fprc.recordings.picture import draw_recording
from fprc.recordings.readout_page import Recorded, report_page
from fprc.recordings.resample import resample
from fprc.recordings.table import read_table
from fprc.registry import SIDES

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
    """Say whether P_o of a recording is worth a second sensor."""
    if find_spec("tabulate") is None:  # which pandas imports only when it writes a table
        raise FprcError(
            "fprc readout needs tabulate to write its tables; install with: "
            "pip install 'fprc[readout]'"
        )
    given = from_files(config)
    settings = given.model_dump(mode="json")
    refuse_repeats([source, *train], "what is judged on its training samples proves nothing")
    mapping = read_map(map_)
    if "p_o_kpa" not in mapping.columns:
        raise ConfigError(f"{map_}: channels.p_o_kpa is missing: it is the sensor in question")
    folder = Path(out or Path("results", Path(source).stem))
    page, answered = folder / "report.md", folder / "readout/answer.json"
    layout = mapping.csv.model_dump()
    tables = {path: read_table(path, **layout) for path in (source, *train)}
    hashes = [sha256(path) for path in tables]

    def is_ours(old: Path) -> bool:
        known = is_json_with(answered, "recordings")
        return known and read_json(answered)["recordings"] == hashes

    refuse_output(page, ".md", ours=is_ours)
    target = mapping.target(settings["evaluation"]["target"])
    whole = mapping.changed(start_s=0.0, end_s=None)
    recorded: dict[str, Recorded] = {}
    for path, table in tables.items():
        recording = gather(table, mapping if path == source else whole)
        recorded[path] = Recorded(
            recording, judge(recording, mapping, table, given.quality, target)
        )
    if stops := [f"{path}: {line}" for path, one in recorded.items() for line in one.found.stops]:
        raise LogError("\n".join(stops))
    recorded_hz = [rate_of(one.recording.time_s) for one in recorded.values()]
    # that of the slowest recording, at least 1 Hz as in a map, at most the configuration's
    highest_hz = settings["control"]["sample_rate_hz"]
    rate_hz = mapping.sample_rate_hz or min(highest_hz, max(1.0, min(recorded_hz)))
    duration_s = float(recorded[source].recording.time_s[-1])
    border_s = mapping.test_from_s or mapping.start_s + float(f"{_TRAINED * duration_s:.4g}")
    train_map = mapping.changed(experiment="sweep", sample_rate_hz=rate_hz)
    # the sample at the border belongs to the test
    parts = {
        "sweep": (source, train_map.changed(end_s=border_s - 0.5 / rate_hz)),
        "complex": (source, train_map.changed(experiment="complex", start_s=border_s)),
    } | {
        f"sweep_{k}": (path, train_map.changed(start_s=0.0, end_s=None))
        for k, path in enumerate(train, 2)
    }
    gathered = {name: gather(tables[path], part) for name, (path, part) in parts.items()}
    logs = {
        name: resample(one.time_s, one.channels, rate_hz, parts[name][0])
        for name, one in gathered.items()
    }
    lengths = [len(time_s) for time_s, _ in logs.values()]
    theta, p_o, p_exp = (
        np.concatenate([channels[name] for _, channels in logs.values()])
        for name in ("theta_deg", "p_o_kpa", TARGETS[target])
    )
    lengths = [sum(lengths[:2]), *lengths[2:]]
    recordings = Recordings(theta, p_o, p_exp, lengths, rate_hz)
    if len(recordings.thinned().folds()) < LEAST_BLOCKS:
        raise LogError(
            f"{source}: {sum(lengths) / rate_hz:.3g} s are too short to judge anything; at least "
            f"{WARM_UP_S + LEAST_BLOCKS * PURGES * PURGE_S:g} s are needed"
        )
    raw = {name: folder / f"raw/{name}.h5" for name in parts}
    for log in raw.values():
        refuse_output(log, ".h5", ours=is_imported)
    with threadpool_limits(1):
        for name, (path, part) in parts.items():
            write_log(gathered[name], logs[name], part, path, raw[name])
        for number, one in enumerate(recorded.values(), 1):
            draw_recording(one.recording, mapping, str(folder / f"raw/recording_{number}.png"))
        unit = noted_unit(TARGETS[target], {"notes": mapping.notes})
        described = {"recordings": hashes, "unit": unit, "source": "import", "target": target}
        report = described | _judge(recordings, settings, unit)
        write_json(answered, report)
        draw_memory(report["memory"], str(folder / "readout/memory.png"))
        write_text(page, report_page(recorded, map_, settings, report, rate_hz))
        doubts = [f"Doubtful: {line}" for one in recorded.values() for line in one.found.doubts]
        lines = [report["answer"]["words"], *doubts, *sentences(report["claims"]), str(page)]
        print("\n".join(lines))


def _judge(recordings: Recordings, settings: Mapping[str, Any], unit: str) -> dict[str, Any]:
    """Return the answer, the errors of the paper's models and the claims on them."""
    models, own = (paper_models(settings_at(settings, hz)) for hz in (PAPER_HZ, recordings.rate_hz))
    seed = settings["seed"]

    def show(line: str) -> None:
        print(f"\r{line:<78}", end="", file=sys.stderr, flush=True)

    step = progress(2 * len(SIDES) + SHIFTS + len(MODELS) + 1, show)
    answer = answer_recordings(recordings, models, seed, step, unit)
    memory = judge_memory(recordings.thinned(), models, seed, answer["period_s"])
    step("memory of P_o")
    cells = judge_models(recordings, own, seed, step)
    print(file=sys.stderr)
    overlap = float(np.mean([len(block) / len(rows) for rows, block in recordings.folds()]))
    claims = judge_claims(cells, overlap)
    return {"answer": answer, "memory": memory, "cells": cells, "claims": claims}
