"""Figures 6 and 7: the control system with ESN and with FPRC as feedforward model."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, FancyArrowPatch

from fprc.figures.blocks import BODY, PALE, box, dot, frame, node, wire, write
from fprc.figures.style import SIGNALS, line_of

#: Positions at which theta_d branches and P_ff and P_fb are added, and the height of the loop.
_BRANCH, _SUM, _LOOP = 0.26, 1.8, 0.5


def _plot_loop(ax: Axes, up_to: float) -> float:
    """Draw the closed loop, and theta_d up to the height ``up_to``, in inches.

    Return the height at which P_ff's arrow must end, above ``_SUM``.
    """
    y, reference = _LOOP, SIGNALS["theta_d"]
    error, total = node(ax, (0.5, y)), node(ax, (_SUM, y))
    pd = box(ax, (1.0, y), (0.3, 0.26), "PD")
    pressure = box(ax, (2.33, y), (0.54, 0.44), "PI\npressure\ncontroller")
    actuator = box(ax, (2.95, y), (0.46, 0.4), "Soft\nactuator", facecolor=BODY)
    write(ax, (0.06, y), r"$\theta_d$")
    wire(ax, (0.13, y), (error.x0, y), colour=reference)
    wire(ax, (_BRANCH, y), (_BRANCH, up_to), colour=reference, head=0)
    dot(ax, (_BRANCH, y), reference)
    wire(ax, (error.x1, y), (pd.x0, y), text=r"$e_\theta$")
    wire(ax, (pd.x1, y), (total.x0, y), text=r"$P_\mathrm{fb}$", colour=SIGNALS["p_fb"])
    wire(ax, (total.x1, y), (pressure.x0, y), text="$P_d$")
    wire(ax, (pressure.x1, y), (actuator.x0, y))
    wire(ax, (actuator.x1, y), (3.41, y), text=r"$\theta$", colour=SIGNALS["theta"])
    wire(ax, (3.29, y), (3.29, 0.1), (0.5, 0.1), (0.5, error.y0), colour=SIGNALS["theta"])
    dot(ax, (3.29, y), SIGNALS["theta"])
    write(ax, (0.43, error.y0 - 0.03), "\N{MINUS SIGN}")
    return total.y1


def plot_esn_system(models: Mapping[str, Any], ax: Axes) -> None:
    """Draw the control system with the echo state network, in inches.

    Parameters
    ----------
    models : Mapping
        ``n_y``, and of ``esn``: ``r``, ``gamma``, ``rho``, ``f_input``.
    """
    esn, reference = models["esn"], SIGNALS["theta_d"]
    y, above = 1.38, 1.82
    frame(ax, (0.42, 0.95), (2.98, 1.23), "ESN feedforward model")
    arrival = _plot_loop(ax, above)
    w_in = box(ax, (0.72, y), (0.26, 0.26), r"$\mathbf{w}_\mathrm{in}$")
    reservoir = _network(ax, (1.26, y), 0.27)
    w_out = box(ax, (_SUM, y), (0.32, 0.5), r"$\mathbf{w}_\mathrm{out}$")
    taps = box(ax, (1.0, above), (0.62, 0.2), f"$n_y$ = {models['n_y']} taps")
    wire(ax, (_BRANCH, y), (w_in.x0, y), colour=reference)
    dot(ax, (_BRANCH, y), reference)
    wire(ax, (w_in.x1, y), (reservoir[0], y))
    wire(ax, (reservoir[1], y), (w_out.x0, y), text=r"$\mathbf{x}$")
    wire(ax, (_BRANCH, above), (taps.x0, above), colour=reference)
    wire(ax, (taps.x1, above), (_SUM, above), (_SUM, w_out.y1), text=r"$1, \boldsymbol{\theta}$")
    wire(ax, (_SUM, w_out.y0), (_SUM, arrival), text=r"$P_\mathrm{ff}$", colour=SIGNALS["p_ff"])
    write(ax, (1.26, y - 0.34), rf"$\mathbf{{W}}_r$, $r$ = {esn['r']}")
    _write_equations(ax, esn)


def _write_equations(ax: Axes, esn: Mapping[str, Any]) -> None:
    """Write state update, readout and settings of the network beside it."""
    lines = (
        r"$\mathbf{x}(k{+}1) = \gamma\,\mathbf{x}(k) + (1 - \gamma)\,\cdot$",
        r"$\quad\tanh(\mathbf{w}_\mathrm{in}\theta_d(k) + \mathbf{W}_r\mathbf{x}(k))$",
        r"$P_\mathrm{ff} = \mathbf{w}_\mathrm{out}\,[1; \boldsymbol{\theta}; \mathbf{x}]$",
        rf"$\gamma$ = {esn['gamma']:g}, $\rho$ = {esn['rho']:g},",
        rf"$f_\mathrm{{input}}$ = {esn['f_input']:g}",
    )
    for row, line in enumerate(lines):
        write(ax, (2.04, 1.93 - 0.17 * row), line, ha="left")


def _network(ax: Axes, centre: tuple[float, float], radius: float) -> tuple[float, float]:
    """Draw a network of a few nodes, joined at random; return its left and right edge."""
    rng = np.random.default_rng(3)
    ax.add_patch(Circle(centre, radius, facecolor=PALE, edgecolor="black", linewidth=0.7))
    angles = 2.0 * np.pi * np.arange(9) / 9
    points = np.array(centre) + 0.74 * radius * np.column_stack([np.cos(angles), np.sin(angles)])
    for source in range(9):
        for target in rng.choice(np.delete(np.arange(9), source), 2, replace=False):
            ax.add_patch(
                FancyArrowPatch(points[source], points[target], color="0.35", linewidth=0.4,
                                connectionstyle="arc3,rad=0.25", shrinkA=1.6, shrinkB=1.6,
                                arrowstyle="-|>,head_width=0.8,head_length=1.6", mutation_scale=1)
            )  # fmt: skip
    ax.plot(*points.T, "o", color=line_of("esn")["color"], markersize=3.2, markeredgecolor="black",
            markeredgewidth=0.4)  # fmt: skip
    return centre[0] - radius, centre[0] + radius


def plot_fprc_system(models: Mapping[str, Any], control: Mapping[str, Any], ax: Axes) -> None:
    """Draw the control system with the fuzzy pneumatic reservoir, in inches.

    Parameters
    ----------
    models : Mapping
        ``n_y``, and of ``fprc``: ``epsilon``, ``n_u``, ``n_c``.
    control : Mapping
        ``k_in_kpa_per_deg``.
    """
    fprc, reference, p_o = models["fprc"], SIGNALS["theta_d"], SIGNALS["p_o"]
    y, middle, low = 2.46, 1.74, 1.12
    frame(ax, (0.36, 0.94), (3.04, 1.86), "FPRC feedforward model")
    frame(ax, (1.08, 1.0), (1.44, 1.08), "T-S fuzzy readout")
    arrival = _plot_loop(ax, y)

    gain = box(ax, (0.7, y), (0.3, 0.26), r"$K_\mathrm{in}$")
    write(ax, (0.48, y - 0.21), f"{control['k_in_kpa_per_deg']:g} kPa/deg", ha="left")
    pressure = box(ax, (1.2, y), (0.26, 0.26), "PI")
    reservoir = box(ax, (_SUM, y), (0.54, 0.3), "Physical\nreservoir", facecolor=BODY)
    low_pass = box(ax, (2.58, y), (0.6, 0.3), f"Low-pass\n$\\epsilon$ = {fprc['epsilon']:g}")
    wire(ax, (_BRANCH, y), (gain.x0, y), colour=reference)
    wire(ax, (gain.x1, y), (pressure.x0, y), text="$P_i$", colour=SIGNALS["p_i"])
    wire(ax, (pressure.x1, y), (reservoir.x0, y), colour=SIGNALS["p_i"])
    wire(ax, (reservoir.x1, y), (low_pass.x0, y), text="$P_o$", colour=p_o)

    state = box(ax, (_SUM, middle), (0.3, 0.2), r"$\mathbf{x}^\dagger$")
    taps = box(ax, (0.73, middle), (0.62, 0.2), f"$n_y$ = {models['n_y']} taps")
    delays = box(ax, (2.98, middle), (0.62, 0.2), f"$n_u$ = {fprc['n_u']} taps")
    wire(ax, (_BRANCH, middle), (taps.x0, middle), colour=reference)
    dot(ax, (_BRANCH, middle), reference)
    wire(ax, (low_pass.x1, y), (2.98, y), colour=p_o, head=0)
    wire(ax, (2.98, y), (2.98, delays.y1), text=r"$\tilde{P}_o$", colour=p_o)
    wire(ax, (taps.x1, middle), (state.x0, middle), text=r"$\boldsymbol{\theta}$", colour=reference)
    wire(ax, (delays.x0, middle), (state.x1, middle), text=r"$\mathbf{p}$", colour=p_o)

    rules = box(ax, (_SUM - 0.35, 1.38), (0.69, 0.32),
                "Memberships\n" rf"$\bar{{\beta}}$, $n_c$ = {fprc['n_c']}")  # fmt: skip
    weights = box(ax, (_SUM + 0.36, 1.38), (0.66, 0.32),
                  r"$\mathbf{W}_\mathrm{out}\,[1, \mathbf{x}^\dagger]$")  # fmt: skip
    product = node(ax, (_SUM, low), "x")
    fork = (state.y0 + rules.y1) / 2
    for part, edge in ((rules, product.x0), (weights, product.x1)):
        x = (part.x0 + part.x1) / 2
        wire(ax, (_SUM, state.y0), (_SUM, fork), (x, fork), (x, part.y1))
        wire(ax, (x, part.y0), (x, low), (edge, low))
    wire(ax, (_SUM, product.y0), (_SUM, arrival), text=r"$P_\mathrm{ff}$", colour=SIGNALS["p_ff"])
