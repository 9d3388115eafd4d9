"""Claims C13-C18, about the control and the loops (Secs. II, IV)."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from fprc.claims.finding import ROUNDING, Finding, Results, over_seeds, pm
from fprc.paper import GAINS, REFERENCES


def _values(results: Results, *keys: str) -> np.ndarray:
    """Return one measured number per further seed."""
    values = []
    for value in results.controls:
        for key in keys:
            value = value[key]
        values.append(value)
    return np.array(values)


def _percent(values: np.ndarray, digits: int = 0) -> str:
    mean = 100 * np.mean(values)
    if np.size(values) == 1:
        return f"{mean:.{digits}f} %"
    deviation = 100 * np.std(values, ddof=1)
    return f"{mean:.{digits}f} ± {deviation:.{digits}f} %"


def _tracking(results: Results, published: Mapping[str, Any]) -> Finding:
    table = published["table_4_tracking_rmse_deg"]
    opened = np.array([_values(results, "rmse_deg", f"{r}/fprc/none") for r in REFERENCES])
    closed = {
        gain: np.array([_values(results, "rmse_deg", f"{r}/fprc_pd/{gain}") for r in REFERENCES])
        for gain in GAINS
    }
    cut = {gain: 1 - np.mean(closed[gain] / opened, axis=0) for gain in GAINS}
    theirs = 1 - np.mean([table["fprc_pd"][r] / table["fprc"][r] for r in REFERENCES])
    printed = table["fprc"].values()
    means = opened.mean(axis=1)
    return Finding(
        f"open loop {min(printed):.2f}-{max(printed):.2f} deg; feedback cuts {100 * theirs:.0f} %",
        f"open loop {means.min():.2f}-{means.max():.2f} deg; feedback cuts "
        f"{_percent(cut['printed'])} at the printed gain, {_percent(cut['identified'])} at the "
        "identified",
        "open loop below 5 deg, and feedback lower on each reference at both gains, on every seed",
        bool(opened.max() < 5.0 and all((closed[gain] < opened).all() for gain in GAINS)),
        over_seeds(results.controls),
    )


def _feedforward_predominates(results: Results, published: Mapping[str, Any]) -> Finding:
    largest = np.max([_values(results, "effort", r) for r in REFERENCES], axis=0)
    return Finding(
        "P_ff predominates",
        f"P_fb / P_ff (rms) at most {pm(largest)}",
        "rms of P_fb below a quarter of that of P_ff on each reference and seed, identified gain",
        bool((largest < 0.25).all()),
        over_seeds(results.controls),
    )


def _sweep_error(results: Results, published: Mapping[str, Any]) -> Finding:
    keys = ("largest_error_deg", "lag_ms", "first_third_deg", "last_third_deg")
    largest, lag_ms, first, last = (_values(results, "sweep", key) for key in keys)
    limit = published["fig_sweep_max_abs_error_deg"]["fprc_pd"]
    return Finding(
        f"within {limit} deg, no lag, error grows",
        f"largest error {pm(largest)} deg, lag {lag_ms.mean():+.0f} ms in the last 10 s, "
        f"rms {pm(first)} deg in the first and {pm(last)} in the last third",
        f"mean largest error within {limit} deg; mean lag within 30 ms (10 deg of phase); error "
        "grows on every seed",
        bool(
            largest.mean() <= limit
            and abs(lag_ms.mean()) <= 30.0 + ROUNDING
            and (last > first).all()
        ),
        f"{over_seeds(results.controls)}, identified gain",
    )


def _loops_removed(results: Results, published: Mapping[str, Any]) -> Finding:
    pd, both = (
        _values(results, "loops", f"{controller}/identified", "width_over_span")
        for controller in ("pd", "fprc_pd")
    )
    reached = _values(results, "loops", "pd/printed", "span_over_reference")
    return Finding(
        "marked loops of PD, largely removed by FPRC+PD",
        f"at the printed gain PD spans {_percent(reached)} of the reference; at the identified "
        f"one the loop is {_percent(pd, 1)} of its span with PD, {_percent(both, 1)} with FPRC+PD",
        "FPRC+PD's mean relative loop width below half of PD's; contradicted if PD at the printed "
        "gain spans less than a tenth of the reference",
        None if reached.mean() < 0.1 else bool(both.mean() < 0.5 * pd.mean()),
        f"{over_seeds(results.controls)}, sine 0.5 Hz",
    )


def _disturbance(results: Results, published: Mapping[str, Any]) -> Finding:
    bending, p_o, errors = (
        _values(results, "disturbance", key).T for key in ("bending", "p_o", "rmse_deg")
    )
    return Finding(
        "bending distorted, P_o and tracking not",
        f"unexplained part of the swing, quiet to pushed: bending {_percent(bending[0])} to "
        f"{_percent(bending[1])}, P_o {_percent(p_o[0], 1)} to {_percent(p_o[1], 1)}; tracking "
        f"{pm(errors[0])} to {pm(errors[1])} deg",
        "in the mean, bending's part at least doubles to over 10 %, P_o's grows by less than 3 % "
        "of the swing, the tracking error by less than 50 %",
        bool(
            bending[1].mean() > max(2.0 * bending[0].mean(), 0.1)
            and (p_o[1] - p_o[0]).mean() < 0.03
            and errors[1].mean() < 1.5 * errors[0].mean()
        ),
        f"{over_seeds(results.controls)}, identified gain",
    )


def _frequency_independent(results: Results, published: Mapping[str, Any]) -> Finding:
    changes = {name: _values(results, "hysteresis", name) for name in ("actuator", "reservoir")}
    return Finding(
        "no dependence on frequency",
        ", ".join(f"{name} x {pm(values)}" for name, values in changes.items()),
        "mean width of both loops at mid-angle changes by less than 20 % from the first to the "
        "last quarter of the sweep",
        all(1 / 1.2 < values.mean() < 1.2 for values in changes.values()),
        over_seeds(results.controls),
    )


CONTROL_TESTS = {
    "C13": _tracking,
    "C14": _feedforward_predominates,
    "C15": _sweep_error,
    "C16": _loops_removed,
    "C17": _disturbance,
    "C18": _frequency_independent,
}
