"""`fprc readout`: say whether P_o of a recording is worth a second sensor."""

import logging
import sys
from collections.abc import Mapping, Sequence
from contextlib import redirect_stdout
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from fprc.artifacts import read_json, refuse_unwritable, write_json, write_text
from fprc.config import from_files
from fprc.errors import ConfigError, FprcError, LogError
from fprc.evaluation.rates import PAPER_HZ, settings_at
from fprc.evaluation.sides import SHIFTS, Recordings, progress
from fprc.experiments.data import Data, read_data
from fprc.given import refuse_repeats
from fprc.logs import read_columns
from fprc.paper import EXPERIMENTS
from fprc.plan.arguments import paper_models, pick
from fprc.provenance import sha256
from fprc.recordings.answer import answer_recordings
from fprc.recordings.import_recording import import_mapped, own_rate, read_recording
from fprc.recordings.importing import ImportMap, read_map
from fprc.recordings.memory import draw_memory, judge_memory
from fprc.recordings.paper_models import MODELS, judge_claims, judge_models, sentences
from fprc.recordings.readout_page import Parts, cautions, rates_in_words, report_page, write_tables
from fprc.recordings.stops import refuse_channels, refuse_units
from fprc.registry import SIDES
from fprc.stages.preprocess import preprocess

log = logging.getLogger(__name__)

_INPUTS = ("theta_deg", "p_o_kpa")
#: Share of a recording that becomes the training log of the workflow unless the map gives
#: test_from_s.
_TRAINED = 2.0 / 3.0


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
    settings = from_files(config).model_dump(mode="json")
    refuse_repeats([source, *train], "what is judged on its training samples proves nothing")
    mapping = read_map(map_)
    if problems := _problems_of_map(map_, mapping, more=bool(train)):
        raise ConfigError("\n".join(problems))
    folder = Path(out or Path("results", Path(source).stem))
    refuse_unwritable([folder])
    refuse_units(mapping, read_recording(mapping, source)[0])
    rate_hz, duration_s = own_rate(mapping, source)
    end_s = mapping.start_s + duration_s
    if mapping.test_from_s is not None and mapping.test_from_s >= end_s:
        raise LogError(
            f"{map_}: test_from_s = {mapping.test_from_s:g} lies beyond the end of {source}, "
            f"{end_s:.4g} s; give an earlier time"
        )
    recorded_hz = [rate_hz, *(own_rate(mapping.of_whole("sweep"), path)[0] for path in train)]
    highest_hz = settings["control"]["sample_rate_hz"]
    # that of the slowest recording, at least 1 Hz as in a map, at most the configuration's
    rate_hz = mapping.sample_rate_hz or min(highest_hz, max(1.0, min(recorded_hz)))
    mapping = mapping.model_copy(update={"sample_rate_hz": rate_hz})
    if mapping.experiment == "sweep":
        test_from_s = mapping.start_s + float(f"{_TRAINED * duration_s:.4g}")
        mapping = mapping.model_copy(update={"experiment": None, "test_from_s": test_from_s})
    scaled = settings_at(settings, rate_hz)
    rates = rates_in_words(recorded_hz, rate_hz, settings, scaled)
    log.info("%s", rates)
    parts = _parts(source, mapping, train)
    _refuse_leftovers(folder / "raw", parts)
    with threadpool_limits(1):
        for name, (path, part) in parts.items():
            log.info("importing %s as %s.h5", path, name)
            with redirect_stdout(sys.stderr):  # the answer is what is printed
                import_mapped(part, path, str(folder / f"raw/{name}.h5"))
        data = {
            experiment: _prepare(experiment, parts, settings, folder, rate_hz)
            for experiment in EXPERIMENTS
        }
        recordings, read = _gathered(data, source == parts["sweep"][0], rate_hz)
        records = [read_json(folder / f"quality/{name}.json") for name in EXPERIMENTS]
        quality = [one for record in records for one in record.get("recordings", [record])]
        units = dict(zip(("P_exp", "theta", "P_o"), read.units(_INPUTS), strict=True))
        refuse_channels(recordings.thinned(), units, quality)
        described = {"unit": read.unit, **pick(read.attributes, "source", "target")}
        report = described | _judge(recordings, settings, read.unit)
        write_json(folder / "readout/answer.json", report)
        write_tables(report, folder / "readout")
        draw_memory(report["memory"], str(folder / "readout/memory.png"))
        page = folder / "report.md"
        doubts = cautions(folder)
        write_text(page, report_page(parts, map_, settings, folder, report, rates, doubts))
        lines = [report["answer"]["words"], *(f"Doubtful: {line}" for line in doubts)]
        print("\n".join([*lines, *sentences(report["claims"]), str(page)]))


def _gathered(data: Mapping[str, str], one_file: bool, rate_hz: float) -> tuple[Recordings, Data]:
    """Return all recordings, the one of the two parts first and whole, and one of their logs."""
    train, test = (read_data(data[name]) for name in EXPERIMENTS)
    first = train.lengths[0]

    def joined(channel: str) -> np.ndarray:
        values = train.channels[channel]
        return np.concatenate([values[:first], test.channels[channel], values[first:]])

    theta, p_o, target = map(joined, (*_INPUTS, "p_target_kpa"))
    lengths = [first, *test.lengths, *train.lengths[1:]]
    if one_file:
        lengths[:2] = [sum(lengths[:2])]
    return Recordings(theta, p_o, target, lengths, rate_hz), train


def _judge(recordings: Recordings, settings: Mapping[str, Any], unit: str) -> dict[str, Any]:
    """Return the answer, the errors of the paper's models and the claims on them."""
    models, own = (paper_models(settings_at(settings, hz)) for hz in (PAPER_HZ, recordings.rate_hz))
    seed = settings["seed"]
    total = 2 * len(SIDES) + SHIFTS + len(MODELS) + 1

    def show(line: str) -> None:
        print(f"\r{line:<78}", end="", file=sys.stderr, flush=True)

    step = progress(total, show)
    answer = answer_recordings(recordings, models, seed, step, unit)
    memory = judge_memory(recordings.thinned(), models, seed, answer["period_s"])
    step("memory of P_o")
    cells = judge_models(recordings, own, seed, step)
    print(file=sys.stderr)
    folds = recordings.folds()
    overlap = float(np.mean([len(block) / len(rows) for rows, block in folds]))
    claims = judge_claims(cells, overlap)
    return {"answer": answer, "memory": memory, "cells": cells, "claims": claims}


def _parts(source: str, mapping: ImportMap, train: Sequence[str]) -> Parts:
    """Return the workflow's logs: ``sweep``, ``sweep_2``, ..., which train, and ``complex``."""
    training = [(path, mapping.of_whole("sweep")) for path in train]
    if mapping.test_from_s is not None:
        training.insert(0, (source, mapping.part("sweep")))
        mapping = mapping.part("complex")
    names = ["sweep", *(f"sweep_{number}" for number in range(2, len(training) + 1))]
    return {**dict(zip(names, training, strict=True)), "complex": (source, mapping)}


def _refuse_leftovers(raw: Path, parts: Parts) -> None:
    """Refuse a folder with logs of other recordings, or with more of them to train on."""
    left = [
        str(path)
        for path in sorted(raw.glob("*.h5"))
        if path.stem.partition("_")[0] in EXPERIMENTS
        and (
            path.stem not in parts
            or read_columns(path, ()).attributes.get("imported_sha256")
            != sha256(parts[path.stem][0])
        )
    ]
    if left:
        raise LogError(
            f"{', '.join(left)}: from an earlier run with other recordings; delete them or choose "
            "another --out"
        )


def _prepare(
    experiment: str, parts: Parts, settings: Mapping[str, Any], folder: Path, rate_hz: float
) -> str:
    """Preprocess the logs of one experiment; return the path of their data."""
    data = str(folder / "data" / f"{experiment}.h5")
    preprocess(
        [str(folder / f"raw/{name}.h5") for name in parts if name.startswith(experiment)],
        data,
        str(folder / "quality" / f"{experiment}.json"),
        experiment=experiment,
        target=settings["evaluation"]["target"],
        sample_rate_hz=rate_hz,
        limits=settings["quality"],
    )
    return data


def _problems_of_map(path: str, mapping: ImportMap, *, more: bool) -> list[str]:
    problems = []
    if mapping.experiment == "complex" and not more:
        problems.append(
            f"{path}: experiment: complex makes all of the recording a test, and nothing is left "
            "to train on; give --train, or in the map test_from_s, the time in s at which the test "
            "part begins, instead of experiment"
        )
    if mapping.channels.model_dump()["p_o_kpa"] is None:
        problems.append(
            f"{path}: channels.p_o_kpa is missing: it is the readout to evaluate; add it"
        )
    return problems
