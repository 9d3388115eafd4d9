"""Drawings in inches: boxes, wires, valves."""

from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyArrowPatch, FancyBboxPatch
from matplotlib.path import Path
from matplotlib.transforms import Bbox

from fprc.figures import style

#: Width of a column inside the figure's margins, inches.
WIDTH = style.COLUMN_IN - 0.08
#: Colours of boxes: computation, and soft bodies.
PALE, BODY = "#eef1f4", "#f7ecd0"

Point = tuple[float, float]


def canvas(height: float) -> tuple[Figure, Axes]:
    """Return a figure of a column's width, and empty axes in inches."""
    fig, ax = style.figure(1, 1, style.COLUMN_IN, height + 0.2)
    ax.set_axis_off()
    ax.set(xlim=(0.0, WIDTH), ylim=(0.0, height), aspect="equal")
    return fig, ax


def write(ax: Axes, at: Point, text: str, **options: Any) -> None:
    """Write text, centred, in the size of names."""
    look: dict[str, Any] = {"ha": "center", "va": "center", "linespacing": 0.95}
    ax.text(*at, text, **look | options)


def panel(ax: Axes, corner: Point, title: str) -> None:
    """Write a panel's letter and title at its upper left corner."""
    write(ax, corner, title, ha="left", va="top")


def box(
    ax: Axes,
    centre: Point,
    size: Point,
    text: str = "",
    size_pt: float = style.TEXT_PT,
    **options: Any,
) -> Bbox:
    """Draw a box with text and return its place; ``options`` are the patch's, as ``facecolor``."""
    (x, y), (width, height) = centre, size
    corner = x - width / 2, y - height / 2
    look: dict[str, Any] = {"facecolor": PALE, "edgecolor": "black", "linewidth": 0.7}
    rounded = "round,pad=0,rounding_size=0.025"
    ax.add_patch(FancyBboxPatch(corner, width, height, boxstyle=rounded, **look | options))
    if text:
        write(ax, centre, text, fontsize=size_pt)
    return Bbox.from_bounds(*corner, width, height)


def frame(ax: Axes, corner: Point, size: Point, title: str) -> None:
    """Frame a part of the drawing by a dashed line, its title in the upper left corner."""
    centre = corner[0] + size[0] / 2, corner[1] + size[1] / 2
    box(ax, centre, size, facecolor="#fafafa", edgecolor="0.45", linestyle=(0, (4, 2)), zorder=0)
    write(ax, (corner[0] + 0.05, corner[1] + size[1] - 0.05), title, ha="left", va="top",
          color="0.25")  # fmt: skip


def wire(
    ax: Axes,
    *points: Point,
    text: str = "",
    colour: str = "black",
    head: float = 1.0,
    width: float = 0.8,
) -> None:
    """Draw a line through points, with an arrow's head at its end.

    Parameters
    ----------
    text : str
        Name of the signal, written above the middle of the first segment, or to
        the right of a vertical one.
    head : float
        Size of the head; 0 is none.
    """
    shape = f"-|>,head_width={1.5 * head},head_length={3.2 * head}" if head else "-"
    ax.add_patch(
        FancyArrowPatch(path=Path(points), arrowstyle=shape, mutation_scale=1.0, shrinkA=0,
                        shrinkB=0, color=colour, linewidth=width, joinstyle="miter",
                        capstyle="butt")
    )  # fmt: skip
    if text:
        (x0, y0), (x1, y1) = points[:2]
        middle = (x0 + x1) / 2, (y0 + y1) / 2
        if x0 == x1:
            write(ax, (x0 + 0.04, middle[1]), text, ha="left")
        else:
            write(ax, (middle[0], y0 + 0.035), text, va="bottom")


def dot(ax: Axes, at: Point, colour: str = "black") -> None:
    """Mark that a wire branches here."""
    ax.add_patch(Circle(at, 0.02, facecolor=colour, edgecolor="none", zorder=3))


def node(ax: Axes, centre: Point, sign: str = "+") -> Bbox:
    """Draw a circle that adds or multiplies, and return its place."""
    radius, (x, y) = 0.065, centre
    ax.add_patch(Circle(centre, radius, facecolor="white", edgecolor="black", linewidth=0.7))
    arm = 0.6 * radius if sign == "+" else 0.45 * radius
    for dx, dy in ((arm, 0.0), (0.0, arm)) if sign == "+" else ((arm, arm), (arm, -arm)):
        ax.plot([x - dx, x + dx], [y - dy, y + dy], color="black", linewidth=0.7)
    return Bbox.from_bounds(x - radius, y - radius, 2 * radius, 2 * radius)


def hand_valve(ax: Axes, at: Point, handle: int = -1) -> None:
    """Draw a closed hand valve in a vertical line, its handle to the left or, 1, the right."""
    x, y = at
    half, height, grip = 0.045, 0.06, x + 0.09 * handle
    for end in (y - height, y + height):
        ax.fill([x - half, x + half, x], [end, end, y], color="black", linewidth=0.6)
    ax.plot([x, grip], [y, y], color="black", linewidth=0.8)
    ax.plot([grip, grip], [y - 0.04, y + 0.04], color="black", linewidth=1.6)
