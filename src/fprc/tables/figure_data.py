"""The statistics in the figures, as tidy tables that are written next to each figure."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from fprc.paper import GRID_SETTINGS
from fprc.signals import mean_and_std, rms, settled, turning_points

_PHASES = ("train", "validation", "test")
#: Width of a band of frequency, Hz, and phases of a cycle, of mean loops.
BAND_HZ, _PHASES_OF_CYCLE = 0.1, 100
#: Length of the mean that takes the noise from a path, s: a tenth of the shortest period.
_SMOOTHED_S = 0.1


def mean_loops(channels: Mapping[str, np.ndarray]) -> pd.DataFrame:
    """Mean over the cycles of each band of frequency, by phase (Figs. 4b and 5a).

    A cycle goes from one upper turn of ``p_target_kpa`` to the next; without one, the whole counts.

    Returns
    -------
    DataFrame
        ``f_hz``, the lower edge of the band, and the mean of each channel at each phase.
    """
    turns = turning_points(channels["p_target_kpa"])[::2]
    if len(turns) < 2:
        turns = np.array([0, len(channels["time_s"]) - 1])
    lengths = np.diff(turns)
    table = pd.DataFrame(channels)[turns[0] : turns[-1]]
    f_hz = 1.0 / np.diff(channels["time_s"][turns])
    table["f_hz"] = np.repeat(BAND_HZ * np.floor(f_hz / BAND_HZ + 1e-6), lengths)
    samples = np.arange(len(table)) - np.repeat(turns[:-1] - turns[0], lengths)
    table["phase"] = samples * _PHASES_OF_CYCLE // np.repeat(lengths, lengths)
    loops = table.groupby(["f_hz", "phase"]).mean().reset_index()
    # the first point again, which closes each loop
    return pd.concat([loops, loops.groupby("f_hz", as_index=False).first()])


def smoothed(channels: Mapping[str, np.ndarray], name: str) -> np.ndarray:
    """Mean of a channel over ``_SMOOTHED_S`` around each sample."""
    time_s = channels["time_s"]
    samples = max(round(_SMOOTHED_S / (time_s[1] - time_s[0])), 1)
    return pd.Series(channels[name]).rolling(samples, center=True, min_periods=1).mean().to_numpy()


def fit_errors(parts: Mapping[str, Any]) -> pd.DataFrame:
    """RMSE of a model on the logs of Fig. 8.

    Parameters
    ----------
    parts : Mapping
        By phase: a log with ``p_target_kpa`` and ``p_ff_kpa``.
    """
    return pd.DataFrame(
        {
            "phase": phase,
            "model": log.attributes["model"],
            "rmse": rms(log.channels["p_ff_kpa"] - log.channels["p_target_kpa"]),
            "unit": log.attributes.get("p_target_unit", "kPa"),
            "source": log.attributes["source"],
        }
        for phase, log in parts.items()
    )


def error_summary(runs: Sequence[Any]) -> pd.DataFrame:
    """RMSE and largest error of closed-loop runs after the settling time.

    Parameters
    ----------
    runs : sequence
        Logs with ``time_s``, ``theta_d_deg`` and ``theta_deg``.

    Returns
    -------
    DataFrame
        ``reference``, ``controller``, ``rmse_deg``, ``max_abs_error_deg``, ``source``.
    """
    rows = []
    for log in runs:
        named = log.attributes
        judged = settled(log.channels, named["settle_s"])
        error = judged["theta_d_deg"] - judged["theta_deg"]
        rows.append(
            {
                **{key: named[key] for key in ("reference", "controller")},
                "rmse_deg": rms(error),
                "max_abs_error_deg": np.abs(error).max(),
                "source": named["source"],
            }
        )
    return pd.DataFrame(rows)


def weight_shares(report: Mapping[str, Any], published: Mapping[str, Any]) -> pd.DataFrame:
    """Share of each weight in its rule, and each feature's mean over rules, ours and the paper's.

    Of Fig. 9. The paper prints no mean for the bias; it is 1 minus the two printed means.
    """
    printed = {
        name: percent / 100
        for name, percent in published["fig_portion_mean_weight_share_percent"].items()
    }
    printed["bias"] = 1.0 - sum(printed.values())
    return pd.DataFrame(
        {
            "rule": rule,
            "feature": feature,
            "lag": lag,
            "share": share,
            "mean_of_feature": report["mean_share"].get(feature),
            "published_mean_of_feature": printed[feature],
            "source": report["source"],
        }
        for feature, rules in report["shares"].items()
        for rule, lags in enumerate(rules, start=1)
        for lag, share in enumerate(lags)
    )


def grid_errors(reports: Sequence[Mapping[str, Any]], grid: str) -> pd.DataFrame:
    """Mean and standard deviation of each phase's RMSE, over folds or seeds (Figs. 10a, 10b, 11).

    Parameters
    ----------
    reports : sequence of mapping
        ``source`` and cells by grid: of further seeds, each with the errors of one fold, or one
        report with those of all folds and their ``unit``.

    Returns
    -------
    DataFrame
        ``model``, name and value of the ``setting`` or the values of several, ``phase``, ``mean``,
        ``std`` (sample; NaN for a single value), ``values`` (their number), ``unit``, ``source``.
    """
    return pd.DataFrame(
        {
            "model": cells[0]["model"],
            **_settings_of(cells[0], grid),
            "phase": phase,
            **_spread([cell[f"{phase}_rmse_kpa"] for cell in cells]),
            "unit": reports[0].get("unit", "kPa"),
            "source": reports[0]["source"],
        }
        for cells in zip(*(report[grid] for report in reports), strict=True)
        for phase in _PHASES
    )


def _settings_of(cell: Mapping[str, Any], grid: str) -> dict[str, Any]:
    names = GRID_SETTINGS[grid]
    if len(names) == 1:
        return {"setting": grid, "value": cell[grid]}
    return {name: cell[name] for name in names}


def times_over_n_c(report: Mapping[str, Any]) -> pd.DataFrame:
    """Mean and standard deviation over repeats of the batch execution times (Fig. 10c)."""
    return pd.DataFrame(
        {
            "model": entry["model"],
            "setting": "n_c",
            "value": entry["n_c"],
            "phase": entry["phase"],
            **_spread(entry["seconds"]),
            "unit": "s",
            "source": report["source"],
        }
        for entry in report["times"]
        if entry["mode"] == "batch"
    )


def _spread(values: Sequence[Any]) -> dict[str, float | int]:
    mean, std = mean_and_std(values)
    return {"mean": mean, "std": std, "values": np.size(values)}
