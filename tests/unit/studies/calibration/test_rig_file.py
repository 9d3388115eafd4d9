import copy

import numpy as np
import yaml
from hypothesis import assume, given
from hypothesis import strategies as st
from pydantic import ValidationError

from fprc.config import Settings, check
from fprc.config.rig import Rig
from fprc.studies.calibration.rig_file import parameter_file
from fprc.studies.calibration.space import decode, free_parameters

RIG = Rig().model_dump(mode="json")
PATHS = Settings().calibration.free
FREE = free_parameters(PATHS)
BEGAN = {"to": ["C8"], "start": ["C1b", "C8"], "seeds": [3, 41]}
NOT_FITTED = {"to": [], "start": [], "seeds": []}

points = st.lists(st.floats(0.0, 1.0), min_size=len(FREE), max_size=len(FREE)).map(np.array)


def summary(**changes):
    """Return what is known of a fit, as `fit_rig` returns it."""
    return {
        "date": "2030-01-02",
        "software": "fprc 9.8.7",
        "fit": ["tables", "C8"],
        "seeds": list(range(21, 31)),
        "full_seeds": [41, 42],
        "printed": {"errors": {"sweep/esn/train": 11.5}, "open_loop": {"sweep": 2.67}},
        "residuals": {"errors": {"sweep/esn/train": 0.0123}, "open_loop": {"sweep": -0.21}},
        "median_deviation": 0.0456,
        "largest_deviation": 0.21,
        "evaluations": 1120,
        "parameters": [
            {"path": path, "low": 0.0, "high": 1.0, "share": 0.5} for path in PATHS
        ],
    } | changes  # fmt: skip


def head_of(text):
    return [line for line in text.splitlines() if line.startswith("#")]


@given(points)
def test_file_gives_the_very_rig_back(point):
    rig = decode(point, RIG, FREE)
    try:
        expected = Rig.model_validate(rig)
    except ValidationError:
        assume(False)
    found = check(yaml.safe_load(parameter_file(rig, summary(), "mine", BEGAN)))
    assert found.rig == expected
    fitted = {"name": "mine", "to": ["tables", "C8"], "start": ["C8", "C1b"]}
    fitted["seeds"] = [3, *range(21, 31), 41, 42]
    assert found.fitted.model_dump(mode="json") == fitted
    same = Settings().model_dump(exclude={"rig", "fitted"})
    assert found.model_dump(exclude={"rig", "fitted"}) == same


def test_file_holds_only_what_differs_from_the_defaults():
    rig = copy.deepcopy(RIG)
    rig["bending"]["relaxation_time_s"][1] = 5.5
    rig["drift"]["sigma_kpa"] = 1e-5
    assert yaml.safe_load(parameter_file(rig, summary(), "mine", NOT_FITTED)) == {
        "fitted": {
            "name": "mine",
            "to": ["tables", "C8"],
            "start": [],
            "seeds": [*range(21, 31), 41, 42],
        },
        "rig": {"bending": {"relaxation_time_s": [0.25, 5.5]}, "drift": {"sigma_kpa": 1e-5}},
    }


def test_head_names_the_parameters_that_ended_near_an_end_and_no_others():
    shares = dict.fromkeys(PATHS, 0.5) | dict(
        zip(PATHS, (0.0, 0.0199, 0.0201, 0.9799, 0.9801, 1.0), strict=False)
    )
    parameters = [{"path": path, "share": share} for path, share in shares.items()]
    head = " ".join(head_of(parameter_file(RIG, summary(parameters=parameters), "mine", BEGAN)))
    assert "4.6 %" in head
    assert "errors/sweep/esn/train: 11.5, +1.2 %" in head
    assert "open_loop/sweep: 2.67, -21.0 %" in head
    edges = head.partition("an end of their range: ")[2].replace("# ", "").rstrip(".")
    assert edges.split(", ") == [PATHS[k] for k in (0, 1, 4, 5)]
