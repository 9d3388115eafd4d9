"""`fprc readout`: report how much P_o of a recording improves FPRC, and how others compare."""

import logging
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from joblib import effective_n_jobs
from threadpoolctl import threadpool_limits

from fprc.artifacts import exclusive, refuse_unwritable, write_text
from fprc.config import from_files
from fprc.errors import ConfigError, FprcError, LogError
from fprc.fingerprint import fingerprint
from fprc.given import refuse_repeats
from fprc.logs import read_columns
from fprc.paper import EXPERIMENTS
from fprc.plan.arguments import judgement, paper_models
from fprc.provenance import sha256
from fprc.recordings.claims import answer, sentences
from fprc.recordings.compare import compare_competitors
from fprc.recordings.competitors import ON_RECORDINGS
from fprc.recordings.import_recording import import_mapped, own_rate
from fprc.recordings.importing import ImportMap, read_map
from fprc.recordings.rates import settings_at
from fprc.recordings.readout_page import (
    Parts,
    cautions,
    rates_in_words,
    report_page,
)
from fprc.registry import class_module
from fprc.stages.preprocess import preprocess

log = logging.getLogger(__name__)

#: Share of a recording that trains unless the map gives test_from_s.
_TRAINED = 2.0 / 3.0


def report_readout(
    source: str,
    *,
    map_: str,
    train: Sequence[str] = (),
    out: str | None = None,
    config: Sequence[str] = (),
    workers: int | None = None,
) -> None:
    """Measure how much the readout P_o of a recording improves FPRC."""
    if find_spec("tabulate") is None:  # which pandas imports only when it writes a table
        raise FprcError(
            "fprc readout needs tabulate to write its tables; install with: "
            "pip install 'fprc[readout]'"
        )
    settings = from_files(config).model_dump(mode="json")
    refuse_repeats([source, *train], "a test on training samples proves nothing")
    mapping = read_map(map_)
    if problems := _problems_of_map(map_, mapping, more=bool(train)):
        raise ConfigError("\n".join(problems))
    count = effective_n_jobs(workers or -1)
    folder = Path(out or Path("results", Path(source).stem))
    refuse_unwritable([folder])
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
    lock = folder / ".lock"
    with exclusive(lock), threadpool_limits(1):
        for name, (path, part) in parts.items():
            log.info("importing %s as %s.h5", path, name)
            import_mapped(part, path, str(folder / f"raw/{name}.h5"))
        data = {
            experiment: _prepare(experiment, parts, settings, folder, rate_hz)
            for experiment in EXPERIMENTS
        }
        report = _compete(data, folder / "readout", scaled, count)
        page = folder / "report.md"
        write_text(page, report_page(parts, map_, mapping, settings, folder, report, rates))
        verdicts = report["verdicts"]
        doubts = [f"Doubtful: {line}" for line in cautions(folder, settings)]
        lines = [answer(verdicts).replace("**", ""), *doubts, *sentences(verdicts), str(page)]
        print("\n".join(lines))
        lock.unlink()


def _parts(source: str, mapping: ImportMap, train: Sequence[str]) -> Parts:
    """Return the logs that train, ``sweep``, ``sweep_2``, ..., and the one that tests."""
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


def _compete(
    data: Mapping[str, str], folder: Path, settings: Mapping[str, Any], workers: int
) -> dict[str, Any]:
    """Compare FPRC with its competitors, write their table, and return errors and verdicts."""
    return compare_competitors(
        data["sweep"],
        data["complex"],
        folder,
        judgement=judgement({**settings, "models": paper_models(settings)}),
        workers=workers,
        version=fingerprint("fprc.recordings.compare", *map(class_module, ON_RECORDINGS)),
    )
