"""Figures 1 and 2: parts and motion of actuator and reservoir."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Arc

from fprc.figures import soft_bodies as soft
from fprc.figures.blocks import Point, box, dot, hand_valve, panel, wire, write
from fprc.figures.style import SIGNALS

#: Length of a plate as drawn, inches.
_SCALE = 1.2
_AXIS = soft.HALF_PLATE + soft.DIAMETER / 2
_OUTER = soft.HALF_PLATE + soft.DIAMETER
#: Standard atmosphere (pressures of logs are gauge), and largest zero error of a sensor, kPa.
ATMOSPHERE_KPA, _ZERO_KPA = 101.3, 5.0

#: P_i and P_o in kPa, phi in deg.
Squeeze = tuple[float, float, float]


class Body(NamedTuple):
    """A drawn body: where its plate starts, inches, and how far it is bent."""

    x: float
    y: float
    angle_deg: float = 0.0

    def at(self, along: float, beside: float) -> Point:
        """Return the position at which a point of the body is drawn."""
        x, y = soft.bend(np.array([along]), np.array([beside]), self.angle_deg)[0]
        return self.x + _SCALE * x, self.y + _SCALE * y


def plot_actuator(
    bent: tuple[float, float], straight: tuple[float, float], ax: Axes, *, limit_kpa: float
) -> None:
    """Draw structure, bent and straight state of the actuator, in inches.

    Parameters
    ----------
    bent, straight : (float, float)
        P_exp in kPa, theta in deg.
    limit_kpa : float
        Pressure at which the colour of air is full.
    """
    structure, *states = (Body(x, 1.48, state[1]) for x, state in
                          ((0.14, (0.0, 0.0)), (1.44, bent), (2.62, straight)))  # fmt: skip
    _plot_driven(ax, structure, 0.0)
    panel(ax, (0.0, 2.1), "(a) Structure")
    parts = {
        "Air port": (-soft.BASE - soft.PORT / 2, _AXIS + soft.BORE),
        "Metallic base": (-0.06, _OUTER),
        "Inextensible\nfabric shield": (0.17, _OUTER + soft.GAP / 2),
        "Rubber bladder": (0.42, _OUTER - soft.WALL / 2),
        "Linking\nmetal plate": (0.68, 0.0),
        "Metal end": (1.04, _OUTER),
    }
    _name_parts(ax, structure, parts, 0.58)
    titles = "(b) Pressurised", "(c) Depressurised"
    for body, (p_exp, _), title in zip(states, (bent, straight), titles, strict=True):
        _plot_driven(ax, body, max(p_exp, 0.0) / limit_kpa)
        panel(ax, (body.x - 0.13, 2.1), title)
        tip = _air(ax, body, "p_exp", into=title == titles[0])
        text = rf"$P_\mathrm{{exp}}$ = {round(p_exp)} kPa"
        write(ax, (tip[0] + 0.06, tip[1] + 0.04), text, ha="left")
        _mark_angle(ax, body, r"$\theta$", soft.DIAMETER / 2)


def plot_reservoir(rest: Squeeze, driven: Squeeze, ax: Axes, *, limit_kpa: float) -> None:
    """Draw structure, state at rest and driven state of the reservoir, in inches.

    PAM B is drawn as wide as its air fills it, by Boyle's law from its pressure.

    Parameters
    ----------
    rest, driven : (float, float, float)
        P_i and P_o in kPa, phi in deg.
    limit_kpa : float
        Pressure at which the colour of air is full.
    """
    structure = Body(0.38, 2.95)
    _plot_dual(ax, structure, (0.0, 0.0))
    panel(ax, (0.0, 3.84), "(a) Structure")
    for side, text in ((1, "PAM A: active"), (-1, "PAM B: passive")):
        write(ax, structure.at(0.41, side * _AXIS), text, rotation=90)
    mouth = structure.at(-soft.BASE - soft.PORT, -_AXIS)
    write(ax, (mouth[0] + 0.08, mouth[1] + 0.12), "Hand valve", ha="left")
    parts = {
        "Air port of A": (-soft.BASE - soft.PORT / 2, _AXIS + soft.BORE),
        "Metallic base": (-0.06, _OUTER),
        "Inextensible\nfabric shield": (0.2, _OUTER + soft.GAP / 2),
        "Central\nmetal plate": (0.82, 0.0),
        "Metal end": (1.04, _OUTER),
    }
    _name_parts(ax, structure, parts, 0.8)

    first, second = Body(1.81, 2.95, rest[2]), Body(2.63, 2.95, driven[2])
    for body, state, title in ((first, rest, "(b) At rest"), (second, driven, "(c) A driven")):
        full = [max(kpa, 0.0) / limit_kpa for kpa in state[:2]]
        widths = _plot_dual(ax, body, full, boyle(rest, state))
        panel(ax, (body.x - 0.35, 3.84), title)
        for side, width, letter in zip((1, -1), widths, "AB", strict=True):
            write(ax, body.at(0.5, side * (soft.HALF_PLATE + width / 2)), letter)
        vented = abs(state[0]) < _ZERO_KPA
        active = "atmospheric" if vented else f"$P_i$ = {round(state[0])} kPa"
        write(ax, (body.x - 0.35, 3.69), f"A: {active}\nB: $P_o$ = {round(state[1])} kPa",
              ha="left", va="top")  # fmt: skip
    _air(ax, second, "p_i", into=True)
    _mark_angle(ax, second, r"$\phi$", 0.0)


def boyle(rest: Squeeze, now: Squeeze) -> float:
    """Return the volume of the sealed air as a fraction of that at rest, by Boyle's law."""
    return (rest[1] + ATMOSPHERE_KPA) / (now[1] + ATMOSPHERE_KPA)


def _plot_dual(
    ax: Axes, body: Body, fullness: Sequence[float], share: float = 1.0
) -> tuple[float, float]:
    """Draw the reservoir with PAM B squeezed to a share of its area; return both PAMs' widths."""
    widths = soft.DIAMETER * soft.bulge(body.angle_deg), soft.squeezed(body.angle_deg, share)
    sides = zip((1, -1), widths, ("p_i", "p_o"), fullness, strict=True)
    bladders = [(side, width, soft.tint(SIGNALS[name], full)) for side, width, name, full in sides]
    soft.plot_body(ax, body.angle_deg, bladders, origin=body[:2], scale=_SCALE)
    mouth = body.at(-soft.BASE - soft.PORT, -_AXIS)
    hand_valve(ax, (mouth[0], mouth[1] + 0.06))
    return widths


def plot_mapping(
    p_i_kpa: np.ndarray,
    p_o_kpa: np.ndarray,
    states: Mapping[str, Squeeze],
    ax: Axes,
    *,
    k_in_kpa_per_deg: float,
) -> None:
    """Draw the reservoir as a mapping with memory, and P_o over P_i as logged.

    Parameters
    ----------
    states : Mapping
        States to mark in the plot, by the letters of their panels.
    """
    panel(ax, (0.0, 1.3), "(d) Mapping with memory")
    y, out, low = 0.83, 1.5, 0.4
    gain = box(ax, (0.43, y), (0.3, 0.22), r"$K_\mathrm{in}$")
    mapping = box(ax, (1.07, y), (0.34, 0.34), r"$\mathcal{F}_r$")
    delay = box(ax, (1.07, low), (0.3, 0.2), "$z^{-1}$")
    write(ax, (0.06, y), r"$\theta_d$")
    wire(ax, (0.13, y), (gain.x0, y), colour=SIGNALS["theta_d"])
    wire(ax, (gain.x1, y), (mapping.x0, y), text="$P_i$", colour=SIGNALS["p_i"])
    wire(ax, (mapping.x1, y), (out, y), text="$P_o$", colour=SIGNALS["p_o"], head=0)
    wire(ax, (out, y), (out + 0.18, y), colour=SIGNALS["p_o"])
    wire(ax, (out, y), (out, low), (delay.x1, low), colour=SIGNALS["p_o"])
    wire(ax, (delay.x0, low), (0.78, low), (0.78, y - 0.11), (mapping.x0, y - 0.11),
         colour=SIGNALS["p_o"])  # fmt: skip
    dot(ax, (out, y), SIGNALS["p_o"])
    write(ax, (0.43, y - 0.2), f"{k_in_kpa_per_deg:g} kPa/deg")
    loop = ax.inset_axes((2.22, 0.34, 1.18, 0.74), transform=ax.transData)
    loop.plot(p_i_kpa, p_o_kpa, color=SIGNALS["p_o"], linewidth=0.25, rasterized=True)
    loop.margins(0.2, 0.18)
    loop.set(xlabel="$P_i$ [kPa]", ylabel="$P_o$ [kPa]")
    for letter, (p_i, p_o, _) in states.items():
        loop.plot(p_i, p_o, "o", color="black", markersize=2.5)
        # beside the loops: on the left of their lower end, on the right of their upper one
        at, ha = ((-1, 4), "right") if letter == "b" else ((3, 0), "left")
        loop.annotate(f"({letter})", (p_i, p_o), at, textcoords="offset points", ha=ha, va="center")


def _plot_driven(ax: Axes, body: Body, fullness: float) -> None:
    """Draw the actuator with the bladder's width that follows from its braid."""
    width = soft.DIAMETER * soft.bulge(body.angle_deg)
    air = soft.tint(SIGNALS["p_exp"], fullness)
    soft.plot_body(ax, body.angle_deg, [(1, width, air)], origin=body[:2], scale=_SCALE)


def _name_parts(ax: Axes, body: Body, parts: dict[str, Point], x: float) -> None:
    """Write names in a column, each beside its part (along, beside), with a line to it."""
    for text, part in parts.items():
        tip = body.at(*part)
        line = {"arrowstyle": "-", "linewidth": 0.5, "shrinkA": 1.0, "shrinkB": 0.0,
                "relpos": (0.0, 0.5)}  # fmt: skip
        ax.annotate(text, tip, (x, tip[1]), va="center", linespacing=0.95, arrowprops=line)
        ax.plot(*tip, "o", markersize=1.6, color="black", zorder=4)


def _air(ax: Axes, body: Body, quantity: str, *, into: bool) -> Point:
    """Draw an arrow for the air flow through the port; return the position of the port."""
    x, y = body.at(-soft.BASE - soft.PORT, _AXIS)
    ends = ((x, y + 0.18), (x, y + 0.02))
    wire(ax, *(ends if into else ends[::-1]), colour=SIGNALS[quantity], width=1.4, head=1.6)
    return x, y


def _mark_angle(ax: Axes, body: Body, symbol: str, beside: float) -> None:
    """Mark the angle between the axes of end and base, below the end."""
    text = f"{symbol} = {round(body.angle_deg)}°"
    x, y = body.at(1.0 + soft.END, beside)
    if abs(body.angle_deg) < 2.0:
        write(ax, (x, y - 0.1), text)
        return
    turn, length = np.radians(body.angle_deg), 0.28
    for angle in (0.0, turn):
        tip = x + length * np.sin(angle), y - length * np.cos(angle)
        ax.plot([x, tip[0]], [y, tip[1]], color="0.3", linewidth=0.5, linestyle=(0, (4, 2)))
    ax.add_patch(Arc((x, y), 1.6 * length, 1.6 * length, theta1=-90.0,
                     theta2=body.angle_deg - 90.0, linewidth=0.6))  # fmt: skip
    write(ax, (x + 0.06, y - length - 0.07), text)
