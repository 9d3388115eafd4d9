import pytest

from fprc.config import Settings
from fprc.evaluation.cells import judged_cells
from fprc.logs import write_columns
from fprc.stages import grid as stage
from fprc.stages.grid import join_grid, judge_grid

VALUES = {"n_u": [1, 2], "n_y": [1, 3, 2]}


@pytest.fixture(scope="module")
def logs(seen, tmp_path_factory):
    """Training and test data, 500 samples each."""
    folder = tmp_path_factory.mktemp("data")
    for name in ("sweep", "complex"):
        channels = {channel: values[:500] for channel, values in seen[name].items()}
        attributes = {"experiment": name, "source": "sim", "seed": 1, "target": "measured"}
        write_columns(folder / f"{name}.h5", channels, attributes)
    return str(folder / "sweep.h5"), str(folder / "complex.h5")


@pytest.fixture(scope="module")
def judgement():
    models = Settings().models.model_dump(mode="json")
    models["fprc"] |= {"n_c": 2}
    return {"models": models, "folds": 2, "split": "shuffled", "seed": 1, "purge_s": 0.1}


@pytest.fixture
def grid(logs, judgement, tmp_path):
    """Make one grid over the taps and return its file's name."""

    def call(name, **others):
        path = str(tmp_path / f"{name}.json")
        judge_grid(
            *logs,
            path,
            grid="taps",
            values=VALUES,
            judgement=judgement,
            checkpoint=str(tmp_path / f"{name}.jsonl"),
            version="v",
            **{"workers": 1} | others,
        )
        return path

    return call


def read(path):
    with open(path, "rb") as file:
        return file.read()


@pytest.mark.parametrize("chunks", [4, 8])
def test_sweep_in_chunks_is_the_same_file(grid, tmp_path, chunks):
    parts = [grid(f"part{k}", chunk=k, chunks=chunks) for k in range(chunks)]
    join_grid(parts, str(tmp_path / "joined.json"))
    assert read(tmp_path / "joined.json") == read(grid("whole"))


@pytest.mark.slow
def test_two_processes_write_what_one_does(grid):
    assert read(grid("two", workers=2)) == read(grid("one"))


def test_chunk_that_was_killed_goes_on_at_its_next_cell(grid, monkeypatch):
    expected = read(grid("whole", chunk=1, chunks=2))
    judge = stage.judge_cell
    judged = []

    def judge_two(cell, **settings):
        if len(judged) == 2:
            raise KeyboardInterrupt
        judged.append(cell)
        return judge(cell, **settings)

    monkeypatch.setattr(stage, "judge_cell", judge_two)
    with pytest.raises(KeyboardInterrupt):
        grid("killed", chunk=1, chunks=2)
    asked = []

    def count(judge, cells, **settings):
        def told(cell):
            asked.append(cell)
            return judge(cell)

        return judged_cells(told, cells, **settings)

    monkeypatch.setattr(stage, "judge_cell", judge)
    monkeypatch.setattr(stage, "judged_cells", count)
    assert read(grid("killed", chunk=1, chunks=2)) == expected
    assert len(judged) == 2
    assert len(asked) == 1
    assert asked[0] not in judged
