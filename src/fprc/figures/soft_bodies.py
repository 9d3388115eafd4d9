"""Bending actuators in section, seen from the side: their shape and their parts.

Lengths are in lengths of the metal plate. A body hangs from its base: the plate
starts at the origin and, when straight, ends at (0, -1). ``along`` runs down the
plate, ``beside`` away from it, positive towards the inner side of the bend.
Proportions are ours, since the paper prints none; the bend is that of the data.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb

#: Half of the plate's thickness, bladder at rest, its wall, gap to the shield.
HALF_PLATE, DIAMETER, WALL, GAP = 0.02, 0.19, 0.016, 0.016
#: Base and end: their extent along and beside the plate.
BASE, END, MARGIN = 0.12, 0.08, 0.045
#: The tube through which a bladder gets its air.
PORT, BORE = 0.07, 0.02
#: Angle between the threads of a braided bladder and its axis, at rest.
BRAID = np.radians(25.0)

METAL, RUBBER, FABRIC, SEAM = "#b8bcc2", "#4d4d4d", "#f0e2bf", "#a98741"
_ALONG = np.linspace(0.0, 1.0, 61)


def bend(along: np.ndarray, beside: np.ndarray, angle_deg: float) -> np.ndarray:
    """Map points of the straight body to the body bent by ``angle_deg``.

    The plate is the neutral line, an arc of length 1. Points beyond its two ends
    move rigidly. Rows of the result are x, towards the inner side, and y, up.
    """
    on_plate = np.clip(along, 0.0, 1.0)
    turn = np.radians(angle_deg) * on_plate
    # (1 - cos a) / a and sin a / a, without a division by zero
    arc = np.stack(
        [on_plate * np.sin(turn / 2) * np.sinc(turn / 2 / np.pi), -on_plate * np.sinc(turn / np.pi)]
    )
    down = np.stack([np.sin(turn), -np.cos(turn)])
    inwards = np.stack([np.cos(turn), np.sin(turn)])
    return (arc + (along - on_plate) * down + beside * inwards).T


def bulge(angle_deg: float) -> float:
    """Diameter of a driven bladder at ``angle_deg``, over its diameter at rest.

    The bend shortens the bladder's axis; the threads of its braid keep their
    length b, so that axis = b cos(a) and diameter ~ b sin(a) (Chou, Hannaford).
    """
    axis = 1.0 - np.radians(angle_deg) * (HALF_PLATE + DIAMETER / 2)
    return float(np.sqrt(1.0 - (axis * np.cos(BRAID)) ** 2) / np.sin(BRAID))


def bladder(angle_deg: float, width: float, side: int = 1, inset: float = 0.0) -> np.ndarray:
    """Outline of a bladder between its ends.

    Parameters
    ----------
    width : float
        Diameter in the middle; at its ends a bladder is always ``DIAMETER`` wide.
    side : {1, -1}
        Inner or outer side of the plate.
    inset : float
        Distance inside the outline: the wall, for the air within.
    """
    along = inset + (1.0 - 2.0 * inset) * _ALONG
    near = np.full_like(along, HALF_PLATE + inset)
    far = HALF_PLATE + _width(along, width) - inset
    return np.concatenate(
        [bend(along, side * near, angle_deg), bend(along[::-1], side * far[::-1], angle_deg)]
    )


def _width(along: np.ndarray, middle: float) -> np.ndarray:
    """Width of a bladder along it: a barrel between two fittings."""
    return DIAMETER + (middle - DIAMETER) * (1.0 - (2.0 * along - 1.0) ** 4)


def area(outline: np.ndarray) -> float:
    """Area of a closed outline."""
    x, y = outline.T
    return float(abs(x @ np.roll(y, 1) - y @ np.roll(x, 1)) / 2.0)


def squeezed(angle_deg: float, share: float) -> float:
    """Width of the outer bladder if its air fills the fraction ``share`` of its area at rest."""
    rest = area(bladder(0.0, DIAMETER, -1, WALL))
    # the outline is linear in the width, so its area is quadratic; this root also exists for a = 0
    widths = DIAMETER * np.arange(3.0)
    excess = [area(bladder(angle_deg, width, -1, WALL)) - share * rest for width in widths]
    a, b, c = np.polyfit(widths, excess, 2)
    return float(-2.0 * c / (b + np.sqrt(b * b - 4.0 * a * c)))


def tint(colour: str, share: float) -> np.ndarray:
    """Mix a colour with white: 0 is nearly white, 1 strong."""
    return 1.0 - (0.1 + 0.75 * share) * (1.0 - np.array(to_rgb(colour)))


def plot_body(
    ax: Axes,
    angle_deg: float,
    bladders: Sequence[tuple[int, float, np.ndarray]],
    *,
    origin: tuple[float, float] = (0.0, 0.0),
    scale: float = 1.0,
    mirrored: bool = False,
) -> None:
    """Draw a body: shield, bladders and their air, plate, base and end.

    Parameters
    ----------
    bladders : sequence of (side, width, colour of the air)
        One for the actuator, two for the reservoir.
    mirrored : bool
        Whether the inner side is to the left.
    """
    across = -scale if mirrored else scale

    def fill(outline: np.ndarray, face: Any, edge: Any = "none", **more: Any) -> None:
        # line widths are those of a plate of one inch
        ax.fill(*(outline * (across, scale) + origin).T, facecolor=face, edgecolor=edge,
                linewidth=0.6 * min(1.0, 1.3 * scale), joinstyle="round", **more)  # fmt: skip

    reach = {side: HALF_PLATE + _width(_ALONG, width) + GAP for side, width, _ in bladders}
    left, right = reach.get(-1, np.full_like(_ALONG, HALF_PLATE + GAP)), reach[1]
    shield = [bend(_ALONG, -left, angle_deg), bend(_ALONG[::-1], right[::-1], angle_deg)]
    fill(np.concatenate(shield), FABRIC, SEAM)
    for side, width, air in bladders:
        fill(bladder(angle_deg, width, side), RUBBER)
        fill(bladder(angle_deg, width, side, WALL), air)
        middle = side * (HALF_PLATE + DIAMETER / 2)
        port = (-BASE - PORT, -BASE), (BORE - middle, BORE + middle)
        fill(bar(*port, angle_deg), METAL, "black")
    sides = left[0] + MARGIN, right[0] + MARGIN
    fill(bar((0.0, 1.0), (HALF_PLATE, HALF_PLATE), angle_deg), METAL, "black")
    fill(bar((-BASE, 0.0), sides, angle_deg), METAL, "black")
    fill(bar((1.0, 1.0 + END), sides, angle_deg), METAL, "black")


def bar(along: tuple[float, float], sides: tuple[float, float], angle_deg: float) -> np.ndarray:
    """Outline of a part of constant width, from outer to inner side."""
    places = np.linspace(*along, len(_ALONG))
    left, right = np.full_like(places, -sides[0]), np.full_like(places, sides[1])
    return np.concatenate([bend(places, left, angle_deg), bend(places[::-1], right, angle_deg)])
