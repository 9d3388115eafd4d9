import pandas as pd
import pytest

from fprc.artifacts import write_json
from fprc.stages.outcome import outcome

HELD, MISSED = "reproduced", "not reproduced"


@pytest.mark.parametrize("timed", [HELD, MISSED])
def test_line_counts_claims_that_do_not_rest_on_execution_times(tmp_path, timed):
    verdicts = [("fitted", HELD), ("predicted", MISSED), ("assumed", HELD), *[("timed", timed)] * 3]
    claims = [{"rig": rig, "verdict": verdict} for rig, verdict in verdicts]
    write_json(tmp_path / "claims.json", {"claims": claims})
    assert outcome(str(tmp_path)).startswith("2 of 3 claims reproduced; open ")


def test_line_of_a_folder_without_results_says_only_what_to_open(tmp_path):
    assert outcome(str(tmp_path)) == f"open {tmp_path / 'report.html'}"


def test_line_gives_the_median_deviation_of_both_tables(tmp_path):
    (tmp_path / "tables").mkdir()
    for number, means in ((2, (12.0, 11.0, 16.5)), (3, (9.0, 26.2, 20.0))):
        table = pd.DataFrame({
            "model": ["fprc", "esn", "fuzzy_linear"], "unit": "kPa", "mean": means,
            "metric": ["train_rmse", "test_rmse", "validation_rmse"],
            "published_mean": [10.0, 20.0, 20.0],
        })  # fmt: skip
        table.to_csv(tmp_path / f"tables/table{number}_seeds.csv", index=False)
    # +20, -45, -17.5, -10, +31 and 0 %
    assert outcome(str(tmp_path)).startswith("median deviation of Tables II and III 19 %; open ")
