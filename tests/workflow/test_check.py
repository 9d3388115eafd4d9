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


def test_damaged_results_are_named_and_reach_no_other_result(smoked_copy):
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
    crossval, figure, table, seeds = damaged_files = [folder / name for name in names]
    before = smoked_copy.untimed()
    damaged(crossval, crossval.read_bytes().replace(b'_kpa": 1', b'_kpa": NaN, "": 1'))
    damaged(figure, figure.read_bytes()[:1000])
    damaged(table, table.read_bytes()[:100])
    damaged(seeds, seeds.read_bytes().replace(b"1", b"2", 1))
    assert lines(smoked_copy.studies("check").stdout) == [f"  {name}" for name in names]

    # what is asked for again refuses what it is made of
    for path, target, refused in ((seeds, "report", [figure, seeds, table]),
                                  (crossval, "table2", [crossval])):  # fmt: skip
        os.utime(path)
        done = smoked_copy.smoke(target)
        assert done.returncode != 0
        assert "Traceback" not in done.stdout
        named = {name for name in names if f"{name}: " in done.stdout}
        assert named == {str(path.relative_to(folder)) for path in refused}

    for path in damaged_files:
        path.unlink(missing_ok=True)
    done = smoked_copy.smoke("all")
    assert done.returncode == 0, done.stdout
    assert smoked_copy.untimed() == before
    assert lines(smoked_copy.studies("check").stdout) == []
