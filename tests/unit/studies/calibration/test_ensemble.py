import copy

import pytest
import yaml

from fprc.config import PUBLISHED
from fprc.studies.calibration.ensemble import fits
from fprc.studies.calibration.objective import printed_errors

PRINTED = yaml.safe_load(PUBLISHED.read_text(encoding="utf-8"))
TABLE = PRINTED["table_4_tracking_rmse_deg"]
JUDGED = {
    "errors": printed_errors(PRINTED),
    "open_loop": TABLE["fprc"],
    "closed_loop": TABLE["fprc_pd"],
}


def changed(measure, keys, factor):
    found = copy.deepcopy(JUDGED)
    for key in keys:
        found[measure][key] *= factor
    return found


@pytest.mark.parametrize(
    ("count", "factor", "kept"),
    [(12, 1.07, True), (12, 1.09, False), (12, 0.91, False), (5, 1.24, True), (1, 1.26, False)],
)
def test_rig_is_kept_whose_errors_are_near_print(count, factor, kept):
    keys = list(JUDGED["errors"])[:count]
    assert fits(changed("errors", keys, factor), PRINTED) is kept


def test_rig_on_which_feedback_does_not_help_everywhere_is_left_out():
    assert fits(JUDGED, PRINTED)
    assert not fits(changed("closed_loop", ["complex"], 3.0), PRINTED)
