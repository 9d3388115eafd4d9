"""`snakemake check` on the results of a run, with and without files that no rule makes."""

import pytest

pytestmark = pytest.mark.slow


def lines(printed):
    return [line for line in printed.splitlines() if line.startswith("  results/")]


def test_file_that_no_rule_makes_is_reported_and_nothing_else(smoked_copy):
    results = smoked_copy.folder / "results/smoke"
    # what a run that was killed, a search that was begun anew and other settings leave
    for name in ("grids/taps.partial.jsonl", "calibration/search.partial.jsonl.old",
                 "calibration/search.partial.jsonl.1", "blocked/logs/record_sweep.log",
                 "blocked/tables/table2.md"):  # fmt: skip
        (results / name).parent.mkdir(parents=True, exist_ok=True)
        (results / name).write_text("x")
    # the verdicts of so small a run are not the paper's
    done = smoked_copy.smoke("check")
    assert "verdicts differ from config/verdicts.yaml" in done.stdout
    assert lines(done.stdout) == []
    (results / "tables/table9.md").write_text("x")
    (results / "grids/.taps.4194305.part.json").write_text("half")
    (results / "ensemble").mkdir(exist_ok=True)
    (results / "ensemble/rigs_1.json").write_text("of a chunk of another size")
    done = smoked_copy.smoke("check")
    assert done.returncode != 0
    assert "files that no rule makes" in done.stdout
    assert sorted(lines(done.stdout)) == [
        "  results/smoke/ensemble/rigs_1.json",
        "  results/smoke/grids/.taps.4194305.part.json",
        "  results/smoke/tables/table9.md",
    ]
