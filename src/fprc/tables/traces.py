"""Traces of long logs for the report: few enough values for a page, with every peak."""

import base64
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from fprc.channels import unit_of
from fprc.signals import repeat_cycle

#: Stretches of time that a trace is divided into; of each, the lowest and the highest value are
#: kept. A wide screen has fewer pixels, and the report's 43 traces take 0.7 MB.
STRETCHES = 3000
#: Greatest code of a value, and the code of a stretch without samples.
_TOP, _GAP = 65534, 65535

#: Title and symbol of the reservoir's channels.
RESERVOIR = {
    "p_i_kpa": ("Input of the reservoir", "P_i"),
    "phi_deg": ("Bending of the reservoir", "bending"),
    "p_o_kpa": ("Output of the reservoir", "P_o"),
}

#: A channel to draw: symbol, look (of ``page.css``), times in s, values.
Signal = tuple[str, str, np.ndarray, np.ndarray]


class Trace(NamedTuple):
    """A decimated signal: code c of ``codes`` (base64, uint16) is low + c (high - low) / 65534."""

    name: str
    look: str
    low: float
    high: float
    codes: str


class Panel(NamedTuple):
    """Traces over one axis."""

    title: str
    unit: str
    traces: list[Trace]


class Plot(NamedTuple):
    """Panels over the same time, from ``begin_s`` to ``end_s``."""

    title: str
    begin_s: float
    end_s: float
    panels: list[Panel]


def decimate(time_s: np.ndarray, values: np.ndarray, edges_s: np.ndarray) -> np.ndarray:
    """Return the least and the greatest of the values between each two edges, all in one row.

    The least comes first if the values rise between the edges, else the greatest. Both are NaN
    where there is no sample. A sample at or after the last edge counts as before it.
    """
    first = np.searchsorted(time_s, edges_s[:-1])
    last = np.append(first[1:], len(time_s))
    some = last > first
    ends = np.full((len(first), 2), np.nan)
    if some.any():
        first, last = first[some], last[some]
        ends[some, 0] = np.minimum.reduceat(values, first)
        ends[some, 1] = np.maximum.reduceat(values, first)
        falls = np.zeros(len(some), dtype=bool)
        falls[some] = values[last - 1] < values[first]
        ends[falls] = ends[falls, ::-1]
    return ends.ravel()


def pack(values: np.ndarray) -> tuple[float, float, str]:
    """Return the least and the greatest value, and the codes of all, as in ``Trace``."""
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    shares = (values - low) / ((high - low) or 1.0)
    codes = np.where(np.isnan(values), _GAP, np.rint(_TOP * np.nan_to_num(shares)))
    return low, high, base64.b64encode(codes.astype("<u2").tobytes()).decode()


def plot_of(title: str, panels: Mapping[tuple[str, str], Sequence[Signal]]) -> Plot:
    """Return a plot of panels, given by title and unit."""
    times = [time_s for signals in panels.values() for _, _, time_s, _ in signals]
    begin_s, end_s = (float(edge(list(map(edge, times)))) for edge in (min, max))
    # two samples or more in each stretch, so that only a real gap leaves one empty
    stretches = max(1, min(STRETCHES, min(map(len, times)) // 2))
    edges_s = np.linspace(begin_s, end_s, stretches + 1)
    drawn = [
        Panel(
            heading,
            unit,
            [
                Trace(name, look, *pack(decimate(time_s, values, edges_s)))
                for name, look, time_s, values in signals
            ],
        )
        for (heading, unit), signals in panels.items()
    ]
    return Plot(title, begin_s, end_s, drawn)


def fit_plots(logs: Mapping[str, Any]) -> list[Plot]:
    """Return plots of a model's P_ff and its error, as in Fig. 8; ``logs`` by title."""
    plots = []
    for title, log in logs.items():
        time_s, target, model = (
            log.channels[name] for name in ("time_s", "p_target_kpa", "p_ff_kpa")
        )
        unit = log.attributes.get("p_target_unit", "kPa")
        panels = {
            ("Pressure", unit): [
                ("P_exp", "p_exp", time_s, target), ("P_ff", "p_ff", time_s, model)
            ],
            ("Error", unit): [("P_ff - P_exp", "error", time_s, model - target)],
        }  # fmt: skip
        plots.append(plot_of(title, panels))
    return plots


def _following(log: Any) -> list[Signal]:
    time_s, theta_d, theta = (log.channels[name] for name in ("time_s", "theta_d_deg", "theta_deg"))
    return [("theta_d", "theta_d", time_s, theta_d), ("theta", "theta", time_s, theta)]


def _error(name: str, look: str, log: Any) -> Signal:
    (*_, time_s, theta_d), (*_, theta) = _following(log)
    return name, look, time_s, theta_d - theta


def tracking_plots(opened: Any, closed: Any) -> list[Plot]:
    """Return the plot of an open-loop and a closed-loop run, as in Figs. 12 to 15."""
    time_s, efforts = closed.channels["time_s"], ("p_ff", "p_fb")
    panels = {
        ("FPRC", "deg"): _following(opened),
        ("FPRC+PD", "deg"): _following(closed),
        ("Errors, theta_d - theta", "deg"): [
            _error("FPRC", "other", opened), _error("FPRC+PD", "error", closed)
        ],
        ("Outputs of FPRC+PD", "kPa"): [
            (name.replace("p", "P"), name, time_s, closed.channels[f"{name}_kpa"])
            for name in efforts
        ],
    }  # fmt: skip
    return [plot_of("Open and closed loop", panels)]


def disturbance_plots(log: Any, quiet_s: float) -> list[Plot]:
    """Return the plot of a run whose reservoir is pushed from ``quiet_s`` on, as in Fig. 17."""
    time_s, theta_d = log.channels["time_s"], log.channels["theta_d_deg"]
    panels: dict[tuple[str, str], list[Signal]] = {
        ("FPRC+PD", "deg"): _following(log),
        ("Error, theta_d - theta", "deg"): [_error("FPRC+PD", "error", log)],
    }
    for channel, (title, name) in RESERVOIR.items():
        look = channel.rpartition("_")[0]
        values = log.channels[channel]
        cycle = repeat_cycle(time_s, theta_d, values, quiet_s)
        undisturbed = [] if cycle is None else [("undisturbed cycle", "other", time_s, cycle)]
        panels[title, unit_of(channel)] = [*undisturbed, (name, look, time_s, values)]
    return [plot_of("While the reservoir is pushed", panels)]
