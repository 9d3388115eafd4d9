"""`fprc readout`: report how much the readout P_o of one recording improves FPRC."""

import logging
import sys
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from joblib import cpu_count
from threadpoolctl import threadpool_limits

from fprc import tables
from fprc.artifacts import read_json, write_json, write_text
from fprc.commands.import_recording import checked_map, import_mapped
from fprc.commands.models import refuse_repeats
from fprc.config import from_files
from fprc.config.importing import ImportMap
from fprc.errors import ConfigError, FprcError, LogError
from fprc.escape import TerminalFormatter, code
from fprc.fingerprint import fingerprint
from fprc.logs import read_columns
from fprc.paper import SOURCES
from fprc.plan.arguments import judgement
from fprc.provenance import describe, sha256
from fprc.registry import class_module
from fprc.stages.draw import draw_readout
from fprc.stages.preprocess import preprocess
from fprc.stages.readout import measure_readout
from fprc.stages.reservoir import add_reservoir
from fprc.stages.tabulate import tabulate_readout

log = logging.getLogger(__name__)

#: Modules that pandas imports only when it writes a table.
TABLE_WRITERS = {"jinja2": "Jinja2", "tabulate": "tabulate"}
#: Recordings of one role, training or test: each is a file and its map.
Recordings = Sequence[tuple[str, ImportMap]]
PREDICTED = {"command": "commanded", "measured": "measured"}


def report_readout(
    source: str,
    map_file: str,
    out: str | None = None,
    *,
    train: Sequence[str] = (),
    config: Sequence[str] = (),
    workers: int | None = None,
) -> None:
    """Import a recording, evaluate FPRC with and without its P_o, and write a report.

    Writes ``report.md``, ``readout/`` (table, figure, cells), ``raw/`` (the
    logs with their diagnoses), ``data/`` and ``quality/`` into ``out``, in the
    workflow's formats.

    Parameters
    ----------
    source, map_file : str
        Recording and its map; the map's ``test_from_s`` is where the test part begins.
    train : sequence of str
        Further recordings with the same columns, which train as a whole. The map may then have
        ``experiment: complex`` instead of ``test_from_s``: all of ``source`` tests.
    out : str, optional
        Folder; by default ``results/`` and the recording's name.
    config : sequence of str
        Configuration files that override the defaults.
    workers : int, optional
        Processes; by default one per processor.

    Raises
    ------
    ConfigError
        The map or the configuration is wrong.
    LogError
        The recording cannot be used with this map.
    FprcError
        A library that writes the tables is not installed.
    """
    absent = [name for module, name in TABLE_WRITERS.items() if find_spec(module) is None]
    if absent:
        raise FprcError(
            f"fprc readout needs {' and '.join(absent)} to write its tables; install with: "
            "pip install 'fprc[readout]'"
        )
    settings = from_files(config).model_dump(mode="json")
    simulated = settings["evaluation"]["reservoir"] == "simulated"
    refuse_repeats([source, *train], "a test on samples that train says nothing")
    mapping = checked_map(
        map_file,
        source,
        partial(_problems_of_map, map_file, simulated=simulated, more=bool(train)),
    )
    if workers is not None and workers < 1:
        raise ConfigError(f"--workers {workers}: must be 1 or more; omit it to use all processors")
    folder = Path(out or Path("results", Path(source).stem))
    parts = _parts(source, mapping, train)
    _refuse_leftovers(folder / "raw", len(parts["sweep"]))
    _log_to_terminal()
    data = {name: _prepare(name, parts[name], settings, folder) for name in parts}
    words = ("the first part", "the second part")
    if train:
        words = ("the training logs", "the test log")
    results = _judge(data, folder / "readout", settings, workers or cpu_count(), words)
    page = folder / "report.md"
    write_text(page, _page(parts, map_file, mapping, settings, folder, results))
    log.info("%s", page)


def _refuse_leftovers(raw: Path, trained: int) -> None:
    """Refuse a folder with more training logs: the workflow would train on all of them."""
    names = _log_names("sweep", trained)
    left = sorted(str(path) for path in raw.glob("sweep_*.h5") if path.stem not in names)
    if left:
        raise LogError(
            f"{', '.join(left)}: from an earlier run with more training logs; delete it or choose "
            "another --out"
        )


def _parts(source: str, mapping: ImportMap, train: Sequence[str]) -> dict[str, Recordings]:
    """Return the recordings that train, and the one that tests."""
    further = [(path, mapping.of_whole("sweep")) for path in train]
    if mapping.test_from_s is None:
        return {"sweep": further, "complex": [(source, mapping)]}
    return {
        "sweep": [(source, mapping.part("sweep")), *further],
        "complex": [(source, mapping.part("complex"))],
    }


def _log_names(experiment: str, count: int) -> list[str]:
    """Return the names of an experiment's raw logs: ``sweep``, ``sweep_2``, ``sweep_3``, ..."""
    return [experiment, *(f"{experiment}_{number}" for number in range(2, count + 1))]


def _log_to_terminal() -> None:
    # only fprc's messages: Matplotlib logs a lot at this level
    ours = logging.getLogger("fprc")
    if not ours.handlers:
        handler = logging.StreamHandler()
        handler.setFormatter(TerminalFormatter())
        ours.addHandler(handler)
    ours.setLevel(logging.INFO)


def _prepare(
    experiment: str, recordings: Recordings, settings: Mapping[str, Any], folder: Path
) -> str:
    """Import the recordings of one role and preprocess them; return the path of their data."""
    sample_rate_hz = recordings[0][1].sample_rate_hz
    logs = []
    names = _log_names(experiment, len(recordings))
    for name, (source, mapping) in zip(names, recordings, strict=True):
        raw = folder / "raw" / f"{name}.h5"
        raw.parent.mkdir(parents=True, exist_ok=True)
        import_mapped(mapping, source, str(raw))
        if settings["evaluation"]["reservoir"] == "simulated":
            driven = folder / "reservoir" / raw.name
            add_reservoir(
                str(raw),
                str(driven),
                experiment=experiment,
                sample_rate_hz=sample_rate_hz,
                rate_tolerance=settings["quality"]["rate_tolerance"],
                zero_deg=settings["evaluation"]["reservoir_zero_deg"],
                control=settings["control"],
                rig=settings["rig"],
                seed=settings["seed"],
            )
            raw = driven
        logs.append(str(raw))
    data = str(folder / "data" / f"{experiment}.h5")
    preprocess(
        logs,
        data,
        str(folder / "quality" / f"{experiment}.json"),
        experiment=experiment,
        target=settings["evaluation"]["target"],
        sample_rate_hz=sample_rate_hz,
        limits=settings["quality"],
    )
    return data


def _problems_of_map(path: str, mapping: ImportMap, *, simulated: bool, more: bool) -> list[str]:
    problems = []
    if mapping.experiment == "complex" and more:
        pass  # all of the recording tests
    elif mapping.test_from_s is None:
        problems.append(
            f"{path}: test_from_s is missing: the time in s at which the test part begins, counted "
            "from the first sample; give it instead of experiment"
        )
    if mapping.channels.p_o_kpa is None and not simulated:
        problems.append(
            f"{path}: channels.p_o_kpa is missing: it is the readout to evaluate; add it, or set "
            "evaluation.reservoir: simulated"
        )
    return problems


def _judge(
    data: Mapping[str, str],
    folder: Path,
    settings: Mapping[str, Any],
    workers: int,
    parts: tuple[str, str],
) -> dict[str, Any]:
    """Run the grid's cells, write table and figure, and return the cells' results."""
    folder.mkdir(parents=True, exist_ok=True)
    cells, png, pdf = (str(folder / name) for name in ("cells.json", "readout.png", "readout.pdf"))
    grids = settings["grids"]
    with threadpool_limits(1):
        measure_readout(
            data["sweep"],
            data["complex"],
            cells,
            judgement=judgement(settings, "fprc", without="split"),
            epsilon=grids["epsilon"],
            n_u=grids["readout_taps"],
            workers=workers,
            checkpoint=str(folder / "cells.partial.jsonl"),
            version=fingerprint(
                "fprc.stages.readout", *map(class_module, ("fprc", "fuzzy_linear"))
            ),
            progress=progress_bar(),
        )
    csv, md, tex = (str(folder / f"readout.{kind}") for kind in ("csv", "md", "tex"))
    tabulate_readout(cells, csv, md, tex, parts=parts)
    drawn = draw_readout(cells, pdf, png)
    origin = describe(drawn, inputs=[cells], outputs=[pdf, png], settings=settings)
    write_json(folder / "readout.json", origin)
    return read_json(cells)


def progress_bar() -> Callable[[int, int], None]:
    """Return a function that shows progress: a bar on a terminal, else a line every tenth."""
    terminal = sys.stderr.isatty()
    width = 30

    def draw(done: int, total: int) -> None:
        bar = "#" * (width * done // total)
        line = f"[{bar:{width}}] {done} of {total} cells"
        if terminal:
            print(f"\r{line}", end="\n" if done == total else "", file=sys.stderr, flush=True)
        elif done == total or done % max(total // 10, 1) == 0:
            print(line, file=sys.stderr, flush=True)

    return draw


def _page(
    parts: Mapping[str, Recordings],
    map_file: str,
    mapping: ImportMap,
    settings: Mapping[str, Any],
    folder: Path,
    results: Mapping[str, Any],
) -> str:
    """Return the report as Markdown, with links to the figures."""
    table = tables.readout(results)
    note, grid = (folder / "readout/readout.md").read_text(encoding="utf-8").split("\n\n", 1)
    ((source, tested),) = parts["complex"]
    further = [path for path, _ in parts["sweep"] if path != source]
    rate_hz = tested.sample_rate_hz
    lines = [
        f"# Value of the readout in {code(Path(source).name)}",
        "",
        f"Recording: {_with_hash(source)}; map: {code(map_file)}.",
        *([f"Training logs: {', '.join(map(_with_hash, further))}."] if further else []),
        f"Data: {SOURCES[results['source']]}; {rate_hz:g} samples per second; epsilon "
        "and taps are in samples.",
        f"{_what_trained(mapping, further)}; models as in the paper"
        f"{'' if _has_default_models(settings) else ', except for the settings given'}. "
        f"The models predict the {PREDICTED[results['target']]} P_exp.",
        "",
        "## Finding",
        "",
        *(f"- {line}" for line in findings(table, results["own"])),
        f"- {compare_scales(folder / 'data/sweep.h5', settings['models']['fprc']['sigma'])}",
        "",
        "Low-passed theta and P_o shuffled in time are controls: P_o helps as a memory only if it "
        "beats both. One test does not show the spread of the test error.",
        "",
        "## Table",
        "",
        note,
        "",
        grid.strip(),
        "",
        "Every setting: [readout/readout.csv](readout/readout.csv).",
        "",
        "![Errors over epsilon and taps](readout/readout.png)",
        "",
        "## The recording",
    ]
    for experiment, role in (("sweep", "training part"), ("complex", "test part")):
        recordings = parts[experiment]
        for log, (path, _) in zip(_log_names(experiment, len(recordings)), recordings, strict=True):
            part = role if path == source else f"training log {code(Path(path).name)}"
            words = read_json(folder / f"raw/{log}.diagnosis.json")["words"]
            lines += ["", f"### {part[0].upper()}{part[1:]}", "", *(f"- {word}" for word in words)]
            lines += ["", f"![{part}](raw/{log}.diagnosis.png)"]
    return "\n".join(lines) + "\n"


def _with_hash(path: str) -> str:
    return f"{code(path)}, SHA-256 `{sha256(path)[:16]}`"


def _what_trained(mapping: ImportMap, further: Sequence[str]) -> str:
    logs = f"{len(further)} training log{'s' if len(further) > 1 else ''}"
    if mapping.test_from_s is None:
        return f"Trained on {logs}, tested on the whole recording"
    also = f" and on {logs}" if further else ""
    return f"Trained before {mapping.test_from_s:g} s{also}, tested after"


def _has_default_models(settings: Mapping[str, Any]) -> bool:
    return settings["models"] == from_files([]).model_dump(mode="json")["models"]


def findings(table: pd.DataFrame, own: Mapping[str, float]) -> list[str]:
    """Describe the effect of P_o on the error: at the models' settings, and at the best ones.

    Parameters
    ----------
    table : DataFrame
        As ``fprc.tables.readout`` gives it.
    own : Mapping
        ``epsilon`` and ``n_u`` of the models.
    """
    held_out = tables.held_out(table)
    rows = table[table["split"] == held_out]
    at_own = rows[(rows["epsilon"] == own["epsilon"]) & (rows["n_u"] == own["n_u"])]
    at_own = at_own.set_index("readout")
    folds = "On blocked folds" if held_out == "blocked" else "On recordings left out of training"
    lines = []
    for phase, what in (("validation", folds), ("test", "On the test part")):
        errors = at_own[f"{phase}_rmse"]
        changes = ", ".join(
            f"{_change(errors['p_o'], errors[other])} {name}"
            for other, name in (
                ("none", "than without a readout"),
                ("theta", "than with theta low-passed"),
                ("shuffled", "than with P_o shuffled"),
            )
        )
        lines.append(f"{what} FPRC's error is {changes}.")
    best = rows[rows["readout"] == "p_o"].sort_values("test_rmse").iloc[0]
    change = _change(best["test_rmse"], at_own["test_rmse"]["none"])
    lines.append(
        f"Of the settings tried, epsilon = {best['epsilon']:g} and n_u = {best['n_u']} test best: "
        f"{change} than without a readout. This is optimistic: the test selected them."
    )
    return lines


def compare_scales(log: Path, sigma: float) -> str:
    """Return sentences that compare the spread of the inputs with the memberships' width."""
    names = ("theta_deg", "p_o_kpa")
    theta, p_o = (np.std(values) for values in read_columns(log, names).channels.values())
    return (
        f"The rules' memberships use distances of unscaled inputs: the standard deviation of theta "
        f"is {theta:.3g}, of P_o {p_o:.3g} (training), and sigma = {sigma:g}. Results depend on "
        "the scale of theta; try several."
    )


def _change(ours: float, other: float) -> str:
    percent = 100.0 * (ours / other - 1.0)
    return f"{abs(percent):.1f} % {'higher' if percent > 0.0 else 'lower'}"
