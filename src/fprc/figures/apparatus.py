"""Figure 3: the apparatus, its pneumatic and its electrical lines."""

from typing import Any

from matplotlib.axes import Axes
from matplotlib.transforms import Bbox

from fprc.figures import soft_bodies as soft
from fprc.figures.blocks import Point, box, dot, hand_valve, wire, write
from fprc.figures.style import MARK_PT, SIGNALS

_AIR: dict[str, Any] = {"colour": "#a0a0a0", "width": 2.0}
#: Heights of the air lines to actuator and reservoir, and where the plates start.
_UPPER, _LOWER = 2.9, 1.88
_ACTUATOR, _RESERVOIR = (2.86, 2.52), (2.76, 1.52)
#: Length of a plate as drawn, inches.
_SCALE = 0.56
_AXIS, _MOUTH = soft.HALF_PLATE + soft.DIAMETER / 2, soft.BASE + soft.PORT


def plot_apparatus(ax: Axes) -> None:
    """Draw computer, valves, sensors, actuator and reservoir, in inches."""
    box(ax, (0.43, 1.8), (0.84, 2.96), facecolor="white")
    write(ax, (0.43, 3.19), "Computer")
    output = box(
        ax, (0.43, 2.11), (0.76, 1.98), "Contec\nAO-1608L-LPE\nanalog output", size_pt=MARK_PT
    )
    inputs = box(
        ax, (0.43, 0.71), (0.76, 0.66), "Contec\nAI-1616L-LPE\nanalog input", size_pt=MARK_PT
    )
    supply = box(ax, (1.44, (_UPPER + _LOWER) / 2), (0.62, 0.24), "Air supply")
    for y, body in ((_UPPER, _ACTUATOR), (_LOWER, _RESERVOIR)):
        valve = box(ax, (1.44, y), (0.9, 0.46), "Proportional\nvalve, Festo\nMPYE-5-M5-010B",
                    size_pt=MARK_PT)  # fmt: skip
        wire(ax, (output.x1, y), (valve.x0, y))
        pair = (supply.y1, valve.y0) if y == _UPPER else (supply.y0, valve.y1)
        wire(ax, *((1.44, end) for end in pair), **_AIR)
        port = body[0] - _SCALE * _AXIS
        wire(ax, (valve.x1, y), (port, y), (port, body[1] + _SCALE * _MOUTH), **_AIR)
    _plot_sensors(ax, inputs, _plot_bodies(ax))
    _plot_key(ax)


def _plot_bodies(ax: Axes) -> Point:
    """Draw actuator and reservoir, bent away from the cables; return the bend sensor's middle."""
    bent_deg, phi_deg = 45.0, 25.0
    driven = soft.DIAMETER * soft.bulge(bent_deg)
    soft.plot_body(ax, bent_deg, [(1, driven, soft.tint(SIGNALS["p_exp"], 0.7))],
                   origin=_ACTUATOR, scale=_SCALE, mirrored=True)  # fmt: skip
    bladders = [
        (1, soft.DIAMETER * soft.bulge(phi_deg), soft.tint(SIGNALS["p_i"], 0.7)),
        (-1, 0.8 * soft.DIAMETER, soft.tint(SIGNALS["p_o"], 0.3)),
    ]
    soft.plot_body(ax, phi_deg, bladders, origin=_RESERVOIR, scale=_SCALE, mirrored=True)
    write(ax, (2.33, 2.4), "Soft\nactuator")
    write(ax, (2.34, 1.36), "Physical\nreservoir")
    # the bend sensor lies along the actuator's outer side
    back = soft.HALF_PLATE + soft.GAP + 0.01
    strip = soft.bar((0.05, 0.95), (back + 0.04, -back), bent_deg) * (-_SCALE, _SCALE) + _ACTUATOR
    ax.fill(*strip.T, color="black", linewidth=0)
    return tuple(strip[len(strip) // 4])


def _plot_sensors(ax: Axes, inputs: Bbox, bend_sensor: Point) -> None:
    """Draw the sensors and their cables; the cables do not cross."""
    tap = 2.08
    p_exp = _sensor(ax, (tap, 3.18), "p_exp", r"$P_\mathrm{exp}$", width=0.32)
    p_i = _sensor(ax, (tap, 1.6), "p_i", "$P_i$")
    for height, edge in ((_UPPER, p_exp.y0), (_LOWER, p_i.y1)):
        dot(ax, (tap, height), _AIR["colour"])
        wire(ax, (tap, height), (tap, edge), **_AIR)
    x, y = _RESERVOIR[0] + _SCALE * _AXIS, _RESERVOIR[1] + _SCALE * _MOUTH + 0.04
    p_o = _sensor(ax, (3.1, y), "p_o", "$P_o$")
    wire(ax, (x, y - 0.04), (x, y + 0.07), head=0, **_AIR)
    wire(ax, (x, y), (p_o.x0, y), **_AIR)
    hand_valve(ax, (x, y + 0.12), handle=1)
    write(ax, (x - 0.09, y + 0.25), "Hand valve", ha="left", fontsize=MARK_PT)
    theta = _sensor(ax, (3.23, bend_sensor[1]), "theta", r"$\theta$")
    wire(ax, bend_sensor, (theta.x0, bend_sensor[1]))
    wire(ax, (p_exp.x1, 3.18), (3.4, 3.18), (3.4, 0.46), (inputs.x1, 0.46))
    wire(ax, (3.3, theta.y0), (3.3, 0.58), (inputs.x1, 0.58))
    wire(ax, (3.1, p_o.y0), (3.1, 0.7), (inputs.x1, 0.7))
    wire(ax, (tap, p_i.y0), (tap, 0.82), (inputs.x1, 0.82))


def _sensor(ax: Axes, centre: Point, quantity: str, symbol: str, width: float = 0.24) -> Bbox:
    """Draw a sensor in the colour of its quantity."""
    colour = SIGNALS[quantity]
    place = box(ax, centre, (width, 0.2), facecolor=soft.tint(colour, 0.15), edgecolor=colour)
    write(ax, centre, symbol)
    return place


def _plot_key(ax: Axes) -> None:
    """Explain lines and sensors below the drawing."""
    sensors = "$P$: pressure sensor, SMC PSE540A-R06", r"$\theta$: bend sensor, Bend Labs 1-axis"
    for y, kind, look, sensor in zip(
        (0.2, 0.06), ("pneumatic", "electrical"), (_AIR, {}), sensors, strict=True
    ):
        wire(ax, (0.02, y), (0.3, y), **look)
        write(ax, (0.36, y), kind, ha="left")
        write(ax, (1.2, y), sensor, ha="left")
