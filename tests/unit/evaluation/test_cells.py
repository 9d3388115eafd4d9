import json
import uuid
from contextlib import suppress

import pytest

from fprc.errors import FprcError
from fprc.evaluation.cells import run_cells

CELLS = [{"model": "fprc", "n_c": n_c} for n_c in (4, 1, 3, 2)]


def make_work(folder, fails_at=()):
    """Return work that leaves a file per call; local, so it is pickled by value."""

    def work(cell):
        import pathlib
        import uuid

        if cell["n_c"] in fails_at:
            raise ArithmeticError(f"n_c = {cell['n_c']}")
        pathlib.Path(folder, f"{cell['n_c']}-{uuid.uuid4().hex}").touch()
        return {"rmse": 0.1 * cell["n_c"], "folds": [cell["n_c"], 1e-17 / 3.0]}

    return work


@pytest.fixture
def sweep(tmp_path):
    """Run cells; return what was found, and of which n_c. The checkpoint stays."""

    def go(asked=CELLS, *, key="k", workers=1, **options):
        trace = tmp_path / uuid.uuid4().hex
        trace.mkdir()
        work = make_work(str(trace), **options)
        with (
            suppress(InterruptedError),
            run_cells(work, asked, checkpoint=go.checkpoint, **how(key, workers)) as found,
        ):
            raise InterruptedError
        return found, sorted(int(path.name.split("-")[0]) for path in trace.iterdir())

    go.checkpoint = tmp_path / "sub" / "sweep.jsonl"
    return go


def how(key="k", workers=1):
    return {"settings": key, "version": "v", "workers": workers}


def lines(path):
    return path.read_text(encoding="utf-8").splitlines(keepends=True)


def kept(path):
    """n_c of the finished cells of a checkpoint, in their order."""
    return [json.loads(line)["cell"]["n_c"] for line in lines(path)[1:]]


def expected(asked=CELLS):
    return [
        {**cell, "rmse": 0.1 * cell["n_c"], "folds": [cell["n_c"], 1e-17 / 3.0]} for cell in asked
    ]


@pytest.mark.parametrize("workers", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_results_come_in_the_order_of_the_cells_each_once(sweep, workers):
    assert sweep(workers=workers) == (expected(), [1, 2, 3, 4])
    turned = [dict(reversed(cell.items())) for cell in reversed(CELLS)]
    turned.append({"model": "fprc", "n_c": 9})
    assert sweep(turned) == (expected(turned), [9])
    assert sweep(key="another")[1] == [1, 2, 3, 4]


@pytest.mark.parametrize("line", [-1, 2])
@pytest.mark.parametrize(
    "damage",
    [lambda last: last[: len(last) // 2], lambda last: "", lambda last: "\x00\x00\xff\n"],
    ids=["cut", "gone", "no text"],
)
def test_damaged_line_is_dropped_and_its_cell_computed_again(sweep, line, damage):
    sweep()
    order, text = kept(sweep.checkpoint), lines(sweep.checkpoint)
    text[line] = damage(text[line])
    sweep.checkpoint.write_text("".join(text), encoding="latin-1")
    # what stands after a line that cannot be read is not trusted
    lost = order[-1:] if line == -1 else order[1:] if text[2] else order[1:2]
    assert sweep() == (expected(), sorted(lost))
    assert sorted(kept(sweep.checkpoint)) == [1, 2, 3, 4]


@pytest.mark.parametrize("text", ["", "{", '{"key": "other"}\n', "[1, 2]\nnonsense\n"])
def test_file_without_the_key_is_begun_anew(sweep, text):
    sweep.checkpoint.parent.mkdir()
    sweep.checkpoint.write_text(text, encoding="utf-8")
    assert sweep() == (expected(), [1, 2, 3, 4])


@pytest.mark.parametrize("workers", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_work_that_raises_leaves_finished_cells_in_the_checkpoint(sweep, workers):
    sweep(CELLS[:2])
    with pytest.raises(ArithmeticError):
        sweep(workers=workers, fails_at=(3,))
    finished = set(kept(sweep.checkpoint))
    assert {4, 1} <= finished <= {4, 1, 2}
    assert sweep() == (expected(), sorted({1, 2, 3, 4} - finished))


def test_killed_worker_is_an_error_for_people_and_finished_cells_stay(sweep):
    def work(cell):
        import os
        import signal

        if cell["n_c"] == 2:
            os.kill(os.getpid(), signal.SIGKILL)
        return {"rmse": 0.1}

    with pytest.raises(FprcError, match="worker"):  # noqa: SIM117
        with run_cells(work, CELLS, checkpoint=sweep.checkpoint, **how(workers=2)):
            pass
    assert 2 not in kept(sweep.checkpoint)
    sweep(workers=2)
    assert len(kept(sweep.checkpoint)) == len(CELLS)


def test_checkpoint_is_deleted_only_after_the_results_are_saved(tmp_path):
    checkpoint, file = tmp_path / "partial.jsonl", tmp_path / "log.h5"
    file.write_bytes(b"log")
    options = how({"alpha": 0.1}) | {"files": [str(file)], "checkpoint": checkpoint}

    def disk_full():
        with run_cells(lambda cell: {"rmse": 0.1 * cell["n_c"]}, CELLS, **options):
            raise OSError("full")

    pytest.raises(OSError, disk_full)
    assert len(kept(checkpoint)) == len(CELLS)
    with run_cells(None, CELLS, **options) as again:  # nothing is computed a second time
        assert [cell["rmse"] for cell in again] == [0.1 * cell["n_c"] for cell in CELLS]
    assert not checkpoint.exists()
