"""Many cross-validations at once, each of them with a checkpoint."""

import hashlib
import json
import logging
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from joblib import Parallel, delayed, parallel_config
from joblib.externals.loky.process_executor import TerminatedWorkerError

from fprc.artifacts import resuming
from fprc.errors import FprcError

log = logging.getLogger(__name__)

Cell = Mapping[str, Any]


def checkpoint_key(settings: Any, paths: Sequence[str] = ()) -> str:
    """Return a hash of settings, in any form that JSON can hold, and of the content of files."""
    digest = hashlib.sha256(json.dumps(settings, sort_keys=True).encode())
    for path in paths:
        digest.update(Path(path).read_bytes())
    return digest.hexdigest()


def log_progress(done: int, total: int) -> None:
    """Log a bar of the finished cells whenever it grows."""
    width = 30
    length = width * done // total
    if length > width * (done - 1) // total:
        log.info("[%-*s] %d of %d cells", width, "#" * length, done, total)


@contextmanager
def run_cells(
    judge: Callable[[Cell], Mapping[str, Any]],
    cells: Sequence[Cell],
    *,
    workers: int,
    checkpoint: Path | str,
    version: str,
    settings: Any,
    files: Sequence[str] = (),
) -> Iterator[list[dict[str, Any]]]:
    """Judge cells in a pool of processes, each on one thread; the ``with`` block saves the results.

    Each finished cell is written to the checkpoint at once; after a kill only the cells that are
    missing there are computed. After the block the checkpoint is deleted, unless the block failed.

    Parameters
    ----------
    judge : callable
        Takes a cell and returns a JSON mapping; picklable.
    checkpoint : path
        See ``artifacts.resuming``; the entries are cells with their results.
    version, settings, files
        Fingerprint of the code, and everything else that the results depend on: a checkpoint is
        used only if all are the same.

    Raises
    ------
    FprcError
        A worker was killed.

    Yields
    ------
    list of dict
        One per cell, cell and result merged, in the order of cells.
    """
    key = checkpoint_key([settings, version], files)
    names = [_name(cell) for cell in cells]
    with resuming(checkpoint, {"key": key}) as (kept, append):
        finished = {_name(entry["cell"]): entry["result"] for entry in kept}
        pending = [cell for cell, name in zip(cells, names, strict=True) if name not in finished]
        with parallel_config("loky", inner_max_num_threads=1):
            pool = Parallel(n_jobs=workers, return_as="generator_unordered")
            results = pool(delayed(_judged)(judge, cell) for cell in pending)
            try:
                for done, (cell, result) in enumerate(results, len(cells) - len(pending) + 1):
                    append({"cell": cell, "result": result})
                    finished[_name(cell)] = result
                    log_progress(done, len(cells))
            except TerminatedWorkerError as error:
                raise FprcError(
                    "a worker process was killed, probably because memory was short: repeat the "
                    "command with fewer workers; finished cells are kept"
                ) from error
        yield [{**cell, **finished[name]} for cell, name in zip(cells, names, strict=True)]
        Path(checkpoint).unlink()


def _judged(judge: Callable[[Cell], Mapping[str, Any]], cell: Cell) -> tuple[Cell, dict[str, Any]]:
    return cell, dict(judge(cell))


def _name(cell: Cell) -> str:
    return json.dumps(cell, sort_keys=True)
