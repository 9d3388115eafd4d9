import copy
import math
from typing import get_args

import numpy as np
import pytest
import yaml

from fprc.config import PUBLISHED
from fprc.config.calibration import Calibration, Term
from fprc.paper import REFERENCES
from fprc.studies.calibration.objective import misses, numbers_of, printed_errors, targets

PRINTED = yaml.safe_load(PUBLISHED.read_text(encoding="utf-8"))
TERMS = get_args(Term)
TABLE = PRINTED["table_4_tracking_rmse_deg"]
LOOPS = ("swing", "width_quarter", "width_half", "width_three_quarters", "slope")


def ideal():
    """Numbers of a rig on which all is as the paper prints or claims it."""
    errors = printed_errors(PRINTED)
    errors["sweep/esn/train"] *= 0.99  # C1b with its margin
    return {
        "errors": errors,
        "shares": {"p_o_over_theta_d": 56.1 / 43.8},
        "properties": {
            "angle_deg": 60.0, "loop_kpa": 60.0, "p_o_swing_kpa": 60.0, "p_o_loop": 0.3,
            **{f"{loop} {key}": 1.0 for loop in ("actuator", "reservoir") for key in LOOPS},
        },
        "epsilon": [8.0, 9.0, 10.0, 11.0, 12.0],
        "open_loop": dict(TABLE["fprc"]),
        "closed_loop": dict(TABLE["fprc_pd"]),
        "firm_loop": dict(TABLE["fprc_pd"]),
    }  # fmt: skip


def missed(*seeds, terms=TERMS):
    of = targets(PRINTED, terms)
    off = misses(numbers_of(seeds, of), of)
    return {target.term for target, miss in zip(of, off, strict=True) if abs(miss) > 0.34}


def test_every_term_has_targets_and_what_the_paper_prints_misses_none_of_them():
    assert {target.term for target in targets(PRINTED, get_args(Term))} == set(get_args(Term))
    assert set(Calibration().fit) == set(get_args(Term))
    assert missed(ideal()) == set()


@pytest.mark.parametrize(
    ("path", "factor", "terms"),
    [
        ("errors/complex/fuzzy_linear/test", 1.1, "tables"),
        ("errors/sweep/fprc/train", 0.9, "tables C1b"),
        ("errors/sweep/fprc/test", 1.6, "tables orders"),
        ("errors/sweep/esn/train", 1.015, "C1b"),
        ("shares/p_o_over_theta_d", 1.3, "C8"),
        ("properties/angle_deg", 0.9, "plausible"),
        ("properties/p_o_loop", 2.0, "plausible"),
        *((f"properties/{loop} {key}", 0.8, "C18")
          for loop in ("actuator", "reservoir") for key in LOOPS),
        ("epsilon/1", 1.15, "C9a"),
        ("open_loop/complex", 1.2, "open_loop"),
        ("open_loop/complex", 0.4, "open_loop closed_loop"),
        ("closed_loop/sweep", 1.3, "closed_sweep closed_loop"),
        ("closed_loop/sine_0p2", 2.5, "closed_loop"),
        ("closed_loop/sine_0p2", 0.3, ""),  # printed, and not asked for
        ("firm_loop/sine_0p5", 2.5, "margin"),
    ],
)  # fmt: skip
def test_number_beyond_its_range_misses_its_terms_and_no_other(path, factor, terms):
    changed = ideal()
    *keys, last = path.split("/")
    if path.startswith("errors/"):
        keys, last = ["errors"], path.removeprefix("errors/")
    holder = changed
    for key in keys:
        holder = holder[key]
    last = int(last) if isinstance(holder, list) else last
    holder[last] *= factor
    assert missed(changed) == set(terms.split())


def test_numbers_are_means_over_seeds_and_what_was_not_measured_misses_nothing():
    low, high = ideal(), ideal()
    low["errors"]["sweep/fprc/train"] *= 0.8
    high["errors"]["sweep/fprc/train"] /= 0.8
    assert missed(low, high, terms=["tables"]) == set()
    bare = {"errors": copy.deepcopy(ideal()["errors"])}
    assert missed(bare) == set()
    of = targets(PRINTED, ["open_loop"])
    assert all(map(math.isnan, numbers_of([bare], of)))
    assert {target.of for target in of} == {("open_loop", name) for name in REFERENCES}


@pytest.mark.parametrize(("share", "count"), [(1.1, 1), (1.3, 2), (0.7, 2)])
def test_an_error_far_from_print_misses_twice(share, count):
    judged = ideal()
    judged["errors"]["complex/esn/test"] *= share
    of = [t for t in targets(PRINTED, ["tables"]) if t.of == ("errors", "complex/esn/test")]
    assert np.count_nonzero(misses(numbers_of([judged], of), of)) == count
