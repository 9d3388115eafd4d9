import json
import uuid
from contextlib import suppress

import pytest

from fprc.errors import FprcError, OutputError
from fprc.evaluation import cells
from fprc.evaluation.cells import checkpoint_key, judged_cells

CELLS = [{"model": "fprc", "n_c": n_c} for n_c in (4, 1, 3, 2)]


def make_judge(folder, fails_at=()):
    """Return a judge that leaves a file per call; local, so it is pickled by value."""

    def judge(cell):
        import pathlib
        import uuid

        if cell["n_c"] in fails_at:
            raise ArithmeticError(f"n_c = {cell['n_c']}")
        pathlib.Path(folder, f"{cell['n_c']}-{uuid.uuid4().hex}").touch()
        return {"rmse": 0.1 * cell["n_c"], "folds": [cell["n_c"], 1e-17 / 3.0]}

    return judge


@pytest.fixture
def sweep(tmp_path, monkeypatch):
    """Run cells and return what was found, and which n_c were judged; the checkpoint stays."""

    def go(asked=CELLS, *, key="k", workers=1, fails_at=(), progress=None):
        if progress:
            monkeypatch.setattr(cells, "log_progress", progress)
        trace = tmp_path / uuid.uuid4().hex
        trace.mkdir()
        go.trace = trace
        judge = make_judge(str(trace), fails_at)
        with (
            suppress(InterruptedError),
            judged_cells(judge, asked, checkpoint=go.checkpoint, **how(key, workers)) as found,
        ):
            raise InterruptedError
        return found, sorted(int(path.name.split("-")[0]) for path in trace.iterdir())

    go.checkpoint = tmp_path / "sub" / "sweep.jsonl"
    return go


def how(key="k", workers=1):
    return {"settings": key, "version": "v", "workers": workers}


def head(key="k"):
    """The first line of a checkpoint."""
    return {"key": checkpoint_key([key, "v"])}


def lines(path):
    return path.read_text(encoding="utf-8").splitlines()


def entries(path):
    """Entries of a checkpoint."""
    return [json.loads(line) for line in lines(path)]


def expected(asked=CELLS):
    return [
        {**cell, "rmse": 0.1 * cell["n_c"], "folds": [cell["n_c"], 1e-17 / 3.0]} for cell in asked
    ]


@pytest.mark.parametrize("workers", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_results_come_in_the_order_of_the_cells_each_judged_once(sweep, workers):
    found, judged = sweep(workers=workers)
    assert found == expected()
    assert judged == [1, 2, 3, 4]


def cut(last):
    return last[: len(last) // 2]


#: What may happen to the last line of a checkpoint, which ends in a newline.
DAMAGE = {
    "cut": cut,
    "without its end": lambda last: last[:-1],
    "gone": lambda last: "",
    "no text": lambda last: "\x00\x00\xff\n",
}


@pytest.mark.parametrize("what", DAMAGE)
def test_line_that_was_cut_is_dropped_and_its_cell_judged_again(sweep, what):
    sweep()
    *whole, last = sweep.checkpoint.read_text(encoding="utf-8").splitlines(keepends=True)
    n_c = entries(sweep.checkpoint)[-1]["cell"]["n_c"]
    damaged = DAMAGE[what](last)
    assert damaged != last
    sweep.checkpoint.write_text("".join([*whole, damaged]), encoding="latin-1")
    assert sweep() == (expected(), [n_c])
    assert sorted(entry["cell"]["n_c"] for entry in entries(sweep.checkpoint)[1:]) == [1, 2, 3, 4]


def test_lines_after_one_that_was_cut_are_judged_again_too(sweep):
    sweep()
    order = [entry["cell"]["n_c"] for entry in entries(sweep.checkpoint)[1:]]
    head, first, second, *rest = sweep.checkpoint.read_text(encoding="utf-8").splitlines(True)
    sweep.checkpoint.write_text("".join([head, first, cut(second), *rest]), encoding="utf-8")
    assert sweep() == (expected(), sorted(order[1:]))


def test_second_process_at_the_same_checkpoint_is_refused_and_spoils_nothing(sweep):
    refused = []

    def progress(done, total):
        with pytest.raises(OutputError, match="another process"):
            sweep()
        refused.append(len(entries(sweep.checkpoint)) - 1)

    assert sweep(progress=progress)[0] == expected()
    assert refused == [1, 2, 3, 4]
    assert sweep() == (expected(), [])


@pytest.mark.parametrize("text", ["", "{", '{"key": "other"}\n', "[1, 2]\nnonsense\n"])
def test_file_without_the_key_is_begun_anew(sweep, text):
    sweep.checkpoint.parent.mkdir()
    sweep.checkpoint.write_text(text, encoding="utf-8")
    found, judged = sweep()
    assert (found, judged) == (expected(), [1, 2, 3, 4])


def test_another_key_forgets_what_was_finished(sweep):
    sweep(key="a")
    assert sweep(key="b")[1] == [1, 2, 3, 4]
    assert entries(sweep.checkpoint)[0] == head("b")
    assert sweep(key="a")[1] == [1, 2, 3, 4]


def test_cell_is_known_by_its_content_not_by_its_place(sweep):
    sweep()
    turned = [dict(reversed(cell.items())) for cell in reversed(CELLS)]
    found, judged = sweep([*turned, {"model": "fprc", "n_c": 9}])
    assert judged == [9]
    assert found == expected([*turned, {"model": "fprc", "n_c": 9}])


def test_work_of_the_checkpoint_is_in_proportion_to_the_cells(tmp_path, monkeypatch):
    named, name = [], cells._name
    monkeypatch.setattr(cells, "_name", lambda cell: named.append(cell) or name(cell))
    asked = [{"n_c": n_c} for n_c in range(50)]
    with judged_cells(lambda cell: {}, asked, checkpoint=tmp_path / "sweep.jsonl", **how()):
        pass
    assert len(named) <= 3 * 50


@pytest.mark.parametrize("workers", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_judge_that_raises_leaves_finished_cells_in_the_checkpoint(sweep, workers):
    sweep(CELLS[:2])
    with pytest.raises(ArithmeticError):
        sweep(workers=workers, fails_at=(3,))
    kept = {entry["cell"]["n_c"] for entry in entries(sweep.checkpoint)[1:]}
    assert {4, 1} <= kept <= {4, 1, 2}
    found, judged = sweep()
    assert found == expected()
    assert judged == sorted({1, 2, 3, 4} - kept)


def test_killed_worker_is_an_error_for_people_and_finished_cells_stay(sweep, tmp_path):
    def judge(cell):
        import os
        import signal

        if cell["n_c"] == 2:
            os.kill(os.getpid(), signal.SIGKILL)
        return {"rmse": 0.1}

    with pytest.raises(FprcError, match="worker process was killed"):  # noqa: SIM117
        with judged_cells(judge, CELLS, checkpoint=sweep.checkpoint, **how(workers=2)):
            pass
    kept = sweep.checkpoint.read_text(encoding="utf-8")
    assert '"n_c": 2' not in kept
    sweep(workers=2)
    assert len(sweep.checkpoint.read_text(encoding="utf-8").splitlines()) == 1 + len(CELLS)


def test_checkpoint_is_deleted_only_after_the_results_are_saved(tmp_path, monkeypatch):
    checkpoint, file, counted = tmp_path / "partial.jsonl", tmp_path / "log.h5", []
    file.write_bytes(b"log")
    options = how({"alpha": 0.1}) | {"files": [str(file)]}
    monkeypatch.setattr(cells, "log_progress", lambda *counts: counted.append(counts))

    def judged(judge):
        return judged_cells(judge, CELLS, checkpoint=checkpoint, **options)

    def disk_full():
        with judged(lambda cell: {"rmse": 0.1 * cell["n_c"]}):
            raise OSError("full")

    pytest.raises(OSError, disk_full)
    assert len(lines(checkpoint)) == 1 + len(CELLS)
    with judged(None) as again:  # no cell is judged a second time
        assert [cell["rmse"] for cell in again] == [0.1 * cell["n_c"] for cell in CELLS]
    assert not checkpoint.exists()
    assert counted[-1] == (4, 4)
    assert len(counted) == 4


def test_result_that_is_not_a_number_is_refused_and_not_kept(sweep):
    def judge(cell):
        return {"rmse": float("nan")}

    with (
        pytest.raises(ValueError, match="JSON"),
        judged_cells(judge, CELLS[:1], checkpoint=sweep.checkpoint, **how()),
    ):
        pass
    assert entries(sweep.checkpoint) == [head()]


def test_progress_counts_the_cells_of_this_sweep_that_the_checkpoint_holds(sweep):
    seen = []

    def progress(done, total):
        seen.append((done, total, len(lines(sweep.checkpoint)) - 1))

    sweep(progress=progress)
    assert seen == [(1, 4, 1), (2, 4, 2), (3, 4, 3), (4, 4, 4)]
    sweep([{"model": "fprc", "n_c": 8}], progress=progress)
    assert seen[4:] == [(1, 1, 5)]
