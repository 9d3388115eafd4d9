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
