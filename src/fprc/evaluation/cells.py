"""Many cross-validations at once, with a checkpoint for each."""

import hashlib
import json
import logging
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from joblib import Parallel, delayed, parallel_config

from fprc.artifacts import appending, write_text

log = logging.getLogger(__name__)

Cell = Mapping[str, Any]


def checkpoint_key(settings: Any, paths: Sequence[str] = ()) -> str:
    """Return a hash of settings, in any form that JSON can hold, and of the content of files."""
    digest = hashlib.sha256(json.dumps(settings, sort_keys=True).encode())
    for path in paths:
        digest.update(Path(path).read_bytes())
    return digest.hexdigest()


def log_progress(done: int, total: int) -> None:
    """Log a bar of the finished cells."""
    width = 30
    bar = "#" * (width * done // total)
    log.info("[%-*s] %d of %d cells", width, bar, done, total)


@contextmanager
def judged_cells(
    judge: Callable[[Cell], Mapping[str, Any]],
    cells: Sequence[Cell],
    *,
    workers: int,
    checkpoint: Path | str,
    version: str,
    settings: Any,
    files: Sequence[str] = (),
    progress: Callable[[int, int], None] = log_progress,
) -> Iterator[list[dict[str, Any]]]:
    """Judge every cell as ``run_cells`` does; the ``with`` block then saves the results.

    After the block the checkpoint is deleted, unless the block failed.

    Parameters
    ----------
    version, settings, files
        Fingerprint of the code, and everything else that the results depend on: a checkpoint is
        used only if all are the same.
    """
    key = checkpoint_key([settings, version], files)
    yield run_cells(
        judge, cells, workers=workers, checkpoint=checkpoint, key=key, progress=progress
    )
    Path(checkpoint).unlink()


def run_cells(
    judge: Callable[[Cell], Mapping[str, Any]],
    cells: Sequence[Cell],
    *,
    workers: int,
    checkpoint: Path | str,
    key: str,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> list[dict[str, Any]]:
    """Judge every cell in a pool of processes, each on one thread.

    Each finished cell is written to the checkpoint at once; after a kill, the
    next call computes only the cells that are missing there.

    Parameters
    ----------
    judge : callable
        Picklable; takes a cell and returns a JSON mapping.
    checkpoint : path
        JSON lines: first ``key``, then one cell each. A file with another key or
        none is overwritten; an incomplete last line is dropped.
    key : str
        Identifies everything else that the results depend on; see ``checkpoint_key``.

    Returns
    -------
    list of dict
        Cell and result merged, in the order of ``cells``.
    """
    checkpoint = Path(checkpoint)
    finished = _resume(checkpoint, key)
    pending = [cell for cell in cells if _name(cell) not in finished]
    with appending(checkpoint) as append:
        for cell, result in _results(judge, pending, workers):
            finished[_name(cell)] = result
            append(json.dumps({"cell": cell, "result": result}, allow_nan=False))
            progress(sum(_name(cell) in finished for cell in cells), len(cells))
    return [{**cell, **finished[_name(cell)]} for cell in cells]


def _results(
    judge: Callable[[Cell], Mapping[str, Any]], cells: Sequence[Cell], workers: int
) -> Iterator[tuple[Cell, dict[str, Any]]]:
    with parallel_config("loky", inner_max_num_threads=1):
        pool = Parallel(n_jobs=workers, return_as="generator_unordered")
        yield from pool(delayed(_judged)(judge, cell) for cell in cells)


def _judged(judge: Callable[[Cell], Mapping[str, Any]], cell: Cell) -> tuple[Cell, dict[str, Any]]:
    return cell, dict(judge(cell))


def _name(cell: Cell) -> str:
    return json.dumps(cell, sort_keys=True)


def _resume(checkpoint: Path, key: str) -> dict[str, dict[str, Any]]:
    """Return the finished cells, and rewrite the file with them, so that others can be appended."""
    text = checkpoint.read_text(encoding="utf-8", errors="replace") if checkpoint.exists() else ""
    lines = text.splitlines()
    finished = {}
    if lines and lines[0] == json.dumps({"key": key}):
        for line in lines[1:]:
            try:
                entry = json.loads(line)
            except json.JSONDecodeError:
                break
            finished[_name(entry["cell"])] = entry["result"]
    entries = [{"key": key}] + [
        {"cell": json.loads(name), "result": result} for name, result in finished.items()
    ]
    write_text(checkpoint, "".join(json.dumps(entry) + "\n" for entry in entries))
    return finished
