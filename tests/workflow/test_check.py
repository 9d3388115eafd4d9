"""`make check` on the results of a run, some of them damaged."""

import os

import pytest

pytestmark = pytest.mark.slow


def lines(printed):
    return [line for line in printed.splitlines() if line.startswith("  results/")]


def damaged(path, content):
    """Replace a file without a trace in its time."""
    status = path.stat()
    assert path.read_bytes() != content
    path.write_bytes(content)
    os.utime(path, ns=(status.st_atime_ns, status.st_mtime_ns))


def test_damaged_results_are_named_and_no_other(smoked_copy):
    folder = smoked_copy.folder
    names = [
        f"results/smoke/{name}"
        for name in (
            "crossval/sweep_esn.json",
            "figures/fig09_weights.png",
            "tables/table2.csv",
            "tables/table2_seeds.csv",
        )
    ]
    crossval, figure, table, seeds = [folder / name for name in names]
    damaged(crossval, crossval.read_bytes().replace(b'_kpa": 1', b'_kpa": NaN, "": 1'))
    damaged(figure, figure.read_bytes()[:1000])
    damaged(table, table.read_bytes()[:100])
    damaged(seeds, seeds.read_bytes().replace(b"1", b"2", 1))
    assert lines(smoked_copy.studies("check").stdout) == [f"  {name}" for name in names]
