import pytest

from fprc.experiments.grids import chunk_of


@pytest.mark.parametrize("chunks", [1, 2, 3, 7, 10, 23])
def test_every_cell_is_in_one_chunk_in_order(chunks):
    cells = list(range(10))
    parts = [chunk_of(cells, k, chunks) for k in range(chunks)]
    assert sum(parts, []) == cells
    assert max(map(len, parts)) - min(map(len, parts)) <= 1
