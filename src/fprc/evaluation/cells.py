"""Work on many cells at once, each of them kept in a checkpoint."""

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


@contextmanager
def run_cells(
    work: Callable[[Cell], Mapping[str, Any]],
    cells: Sequence[Cell],
    *,
    workers: int,
    checkpoint: Path | str,
    version: str,
    settings: Any,
    files: Sequence[str] = (),
) -> Iterator[list[dict[str, Any]]]:
    """Work on cells in a pool of processes, each on one thread; the ``with`` block saves results.

    Each finished cell is written to the checkpoint at once; after a kill only the cells that are
    missing there are computed. After the block the checkpoint is deleted, unless the block failed.

    Parameters
    ----------
    work : callable
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
    digest = hashlib.sha256(_text([settings, version]).encode())
    for path in files:
        digest.update(Path(path).read_bytes())
    with resuming(checkpoint, {"key": digest.hexdigest()}) as (kept, append):
        finished = {_text(entry["cell"]): entry["result"] for entry in kept}
        pending = [cell for cell in cells if _text(cell) not in finished]
        with parallel_config("loky", inner_max_num_threads=1):
            pool = Parallel(n_jobs=workers, return_as="generator_unordered")
            results = pool(delayed(_with_cell)(work, cell) for cell in pending)
            try:
                for done, (cell, result) in enumerate(results, len(cells) - len(pending) + 1):
                    append({"cell": cell, "result": result})
                    finished[_text(cell)] = result
                    log.info("%d of %d cells", done, len(cells))
            except TerminatedWorkerError as error:
                raise FprcError(
                    "a worker process was killed, probably because memory was short: repeat the "
                    "command with fewer workers; finished cells are kept"
                ) from error
        yield [{**cell, **finished[_text(cell)]} for cell in cells]
        Path(checkpoint).unlink()


def _with_cell(work: Callable[[Cell], Mapping[str, Any]], cell: Cell) -> tuple[Cell, Any]:
    return cell, work(cell)


def _text(value: Any) -> str:
    return json.dumps(value, sort_keys=True)
