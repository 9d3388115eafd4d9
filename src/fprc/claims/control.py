"""Claims C13-C18, about the control and the loops (Secs. II, IV)."""

from collections.abc import Callable, Mapping
from functools import partial, reduce
from operator import getitem
from typing import Any

import numpy as np

from fprc.claims.finding import Finding, Results, Statement, over_seeds
from fprc.paper import LOOPS, REFERENCE_NAMES, REFERENCES

#: Factor within which the loop's width may change over the sweep if frequency does not matter.
_GROWTH = 1.2

#: Factor within which the feedback's cut of an error agrees with the printed one.
_CUT = 1.5


def _values(results: Results, *keys: str) -> np.ndarray:
    """Return one measured number per further seed."""
    return np.array([reduce(getitem, keys, report) for report in results.controls])


def _errors(results: Results, controller: str) -> dict[str, np.ndarray]:
    return {r: _values(results, "rmse_deg", f"{r}/{controller}") for r in REFERENCES}


def _follows(results: Results, published: Mapping[str, Any]) -> Finding:
    opened = _errors(results, "fprc")
    closed = _errors(results, "fprc_pd")
    printed = published["table_4_tracking_rmse_deg"]["fprc"].values()
    return Finding(
        f"open loop {min(printed):.2f}-{max(printed):.2f} deg; less with feedback",
        [
            Statement(f"FPRC, {REFERENCE_NAMES[r]} [deg]", opened[r], high=5.0, ratio=False)
            for r in REFERENCES
        ]
        + [
            Statement(f"FPRC+PD / FPRC, {REFERENCE_NAMES[r]}", closed[r] / opened[r], high=1)
            for r in REFERENCES
        ],
        over_seeds(results.controls),
    )


def _cut(results: Results, published: Mapping[str, Any]) -> Finding:
    table = published["table_4_tracking_rmse_deg"]
    opened, closed = _errors(results, "fprc"), _errors(results, "fprc_pd")
    theirs = {r: table["fprc_pd"][r] / table["fprc"][r] for r in REFERENCES}
    return Finding(
        f"FPRC+PD / FPRC: {', '.join(f'{ratio:.2f}' for ratio in theirs.values())}",
        [
            Statement(
                f"FPRC+PD / FPRC over the printed ratio, {REFERENCE_NAMES[r]}",
                closed[r] / opened[r] / theirs[r], 1 / _CUT, _CUT,
            )
            for r in REFERENCES
        ],
        over_seeds(results.controls),
    )  # fmt: skip


def _feedforward_predominates(results: Results, published: Mapping[str, Any]) -> Finding:
    efforts = {r: _values(results, "effort", r) for r in REFERENCES}
    return Finding(
        "P_ff predominates",
        [
            Statement(f"P_fb / P_ff (rms), {REFERENCE_NAMES[r]}", effort, high=0.25)
            for r, effort in efforts.items()
        ],
        over_seeds(results.controls),
    )


def _sweep_error(results: Results, published: Mapping[str, Any]) -> Finding:
    keys = ("largest_error_deg", "lag_ms", "first_third_deg", "last_third_deg")
    largest, lag_ms, first, last = (_values(results, "sweep", key) for key in keys)
    limit = float(published["fig_sweep_max_abs_error_deg"]["fprc_pd"])
    return Finding(
        f"within {limit:g} deg, no lag, error grows",
        [
            Statement("largest error [deg]", largest, high=limit, ratio=False),
            # 30 ms are 10 deg of phase at 0.95 Hz
            Statement("lag in the last 10 s [ms]", lag_ms, -30.0, 30.0, ratio=False),
            Statement("error in the last / first third", last / first, low=1.0),
        ],
        over_seeds(results.controls),
    )


def _loops_removed(results: Results, published: Mapping[str, Any]) -> Finding:
    statements = []
    for reference in LOOPS:
        pd, both = (
            _values(results, "loops", f"{reference}/{controller}", "width_over_span")
            for controller in ("pd", "fprc_pd")
        )
        name = REFERENCE_NAMES[reference]
        statements += [
            Statement(
                f"width of the loop of PD, {name} [% of its span]", 100 * pd, low=5, ratio=False
            ),
            Statement(f"width of the loop, FPRC+PD / PD, {name}", both / pd, high=0.5, ratio=False),
        ]
    return Finding(
        "marked loops of PD, largely removed by FPRC+PD", statements, over_seeds(results.controls)
    )


def _disturbance(results: Results, published: Mapping[str, Any]) -> Finding:
    bending, p_o, errors = (
        _values(results, "disturbance", key).T for key in ("bending", "p_o", "rmse_deg")
    )
    return Finding(
        "bending distorted, P_o and tracking not",
        [
            Statement("unexplained bending, pushed / quiet", bending[1] / bending[0], low=2.0),
            Statement(
                "unexplained bending, pushed [% of swing]", 100 * bending[1], low=10.0, ratio=False
            ),
            Statement(
                "unexplained P_o, pushed - quiet [% of swing]", 100 * (p_o[1] - p_o[0]),
                high=3.0, ratio=False,
            ),
            Statement("tracking error, pushed / quiet", errors[1] / errors[0], high=1.5),
        ],
        over_seeds(results.controls),
    )  # fmt: skip


def _frequency_independent(
    pressure: str, results: Results, published: Mapping[str, Any]
) -> Finding:
    growth = {
        f"actuator over the {pressure} P_exp": _values(results, "hysteresis", pressure),
        "reservoir": _values(results, "hysteresis", "reservoir"),
    }
    return Finding(
        "no dependence on frequency",
        [
            Statement(f"growth of the loop, {name}", values, 1 / _GROWTH, _GROWTH)
            for name, values in growth.items()
        ],
        f"{over_seeds(results.controls)}; last / first quarter of the sweep",
    )


CONTROL_TESTS: dict[str, Callable[..., Finding]] = {
    "C13a": _follows,
    "C13b": _cut,
    "C14": _feedforward_predominates,
    "C15": _sweep_error,
    "C16": _loops_removed,
    "C17": _disturbance,
    "C18a": partial(_frequency_independent, "measured"),
    "C18b": partial(_frequency_independent, "commanded"),
}
