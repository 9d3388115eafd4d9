"""The moving picture of the README: both actuators, the loop as it is drawn, and the tracking."""

from collections.abc import Mapping
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.animation import FuncAnimation, PillowWriter
from matplotlib.axes import Axes
from PIL import Image

from fprc.artifacts import replacing
from fprc.figures import soft_bodies as soft
from fprc.figures import style
from fprc.figures.structure import boyle
from fprc.logs import Columns, read_columns

#: What is shown of the runs, s, and the frames per second.
SPAN_S, FRAMES_HZ = (10.0, 16.0), 12.0
_DPI, _SIZE_IN = 110, (7.4, 2.7)
_COLOURS = 64
_CHANNELS = ("time_s", "theta_d_deg", "theta_deg", "p_exp_kpa", "p_i_kpa", "p_o_kpa", "phi_deg")


def draw_moving_picture(run: str, alone: str, gif: str, png: str) -> Mapping[str, Any]:
    """Draw the run of FPRC+PD beside that of PD alone as an animation, and its last frame.

    Parameters
    ----------
    run, alone : str
        Raw logs of the two runs, of one reference.
    gif, png : str
        The animation, and the picture for print.
    """
    log, other = (read_columns(path, _CHANNELS) for path in (run, alone))
    time_s = log.channels["time_s"]
    picked = np.searchsorted(time_s, np.arange(*SPAN_S, 1.0 / FRAMES_HZ))
    plt.rcParams.update({"font.size": 9.0})
    fig, (bodies, loop, track) = style.figure(
        1, 3, *_SIZE_IN, gridspec_kw={"width_ratios": (1.5, 1.0, 1.6)}
    )
    fig.supxlabel("simulated rig, not hardware", x=0.99, ha="right", fontsize=style.MARK_PT,
                  color="0.45")  # fmt: skip
    shown = _shown(log, other, picked, loop, track)

    def draw(frame: int) -> list[Any]:
        end = picked[frame] + 1
        for line, x, y in shown:
            line.set_data(x[picked[0] : end], y[picked[0] : end])
        _draw_bodies(bodies, log, picked[frame])
        return []

    draw(len(picked) - 1)
    style.fix_layout(fig)
    with replacing(png) as temporary:
        fig.savefig(temporary, dpi=2 * _DPI, metadata={"Software": None})
    with replacing(gif) as temporary:
        moving = FuncAnimation(fig, draw, frames=len(picked), init_func=lambda: [])
        moving.save(temporary, writer=_OnePalette(fps=round(FRAMES_HZ)), dpi=_DPI)
    plt.close(fig)
    return log.attributes


class _OnePalette(PillowWriter):
    """All frames have the same few colours: without noise between them, the file is small."""

    _frames: list[Image.Image]

    def finish(self) -> None:
        """Write the file."""
        frames = [frame.convert("RGB") for frame in self._frames]
        some = Image.fromarray(np.vstack([np.asarray(frame) for frame in frames[::6]]))
        palette = some.quantize(_COLOURS, Image.Quantize.MAXCOVERAGE)
        self._frames = [
            frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames
        ]
        super().finish()


def _shown(
    log: Columns, other: Columns, picked: np.ndarray, loop: Axes, track: Axes
) -> list[tuple[Any, np.ndarray, np.ndarray]]:
    """Set up the two graphs; return their lines with the data of each."""
    one, two = log.channels, other.channels
    time_s, theta, p_exp = one["time_s"] - SPAN_S[0], one["theta_deg"], one["p_exp_kpa"]
    seen = slice(picked[0], picked[-1] + 1)
    loop.plot(p_exp[seen], theta[seen], color="0.88")
    (curve,) = loop.plot([], [], color=style.SIGNALS["theta"])
    loop.set(xlabel=r"$P_\mathrm{exp}$ [kPa]", ylabel=r"$\theta$ [deg]")
    track.plot(time_s[seen], one["theta_d_deg"][seen], color=style.SIGNALS["theta_d"],
               linewidth=2.5, alpha=0.6, label=r"wanted, $\theta_d$")  # fmt: skip
    (pd,) = track.plot([], [], color="0.6", label="PD alone")
    (fprc,) = track.plot([], [], color=style.SIGNALS["theta"], label="FPRC + PD")
    track.set(xlabel="Time [s]", ylabel=r"$\theta$ [deg]", xlim=(0.0, SPAN_S[1] - SPAN_S[0]))
    style.legend_above(track)
    return [
        (curve, p_exp, theta),
        (pd, two["time_s"] - SPAN_S[0], two["theta_deg"]),
        (fprc, time_s, theta),
    ]


def _draw_bodies(ax: Axes, log: Columns, at: int) -> None:
    """Draw actuator and reservoir as they are at one sample."""
    now = {name: float(values[at]) for name, values in log.channels.items()}
    most = {name: float(np.max(values)) for name, values in log.channels.items()}
    still = int(np.argmin(log.channels["p_i_kpa"]))
    p_i, p_o, phi = (log.channels[name] for name in ("p_i_kpa", "p_o_kpa", "phi_deg"))
    rest, squeezed = ((float(p_i[k]), float(p_o[k]), float(phi[k])) for k in (still, at))
    share = boyle(rest, squeezed)

    def air(name: str) -> np.ndarray:
        return soft.tint(style.SIGNALS[name], max(now[f"{name}_kpa"], 0.0) / most[f"{name}_kpa"])

    ax.clear()
    driven = soft.DIAMETER * soft.bulge(now["theta_deg"])
    soft.plot_body(ax, now["theta_deg"], [(1, driven, air("p_exp"))])
    active = soft.DIAMETER * soft.bulge(now["phi_deg"])
    sealed = soft.squeezed(now["phi_deg"], share)
    soft.plot_body(ax, now["phi_deg"], [(1, active, air("p_i")), (-1, sealed, air("p_o"))],
                   origin=(1.75, 0.0))  # fmt: skip
    for x, text in ((0.0, "actuator"), (1.75, "reservoir")):
        ax.text(x, 0.3, text, ha="center")
    ax.text(1.75, -1.55, f"$P_o$ = {now['p_o_kpa']:.0f} kPa", ha="center",
            color=style.SIGNALS["p_o"])  # fmt: skip
    ax.text(0.0, -1.55, rf"$\theta$ = {now['theta_deg']:.0f} deg", ha="center",
            color=style.SIGNALS["theta"])  # fmt: skip
    ax.set(xlim=(-0.4, 2.55), ylim=(-1.65, 0.45), aspect="equal")
    ax.axis("off")
