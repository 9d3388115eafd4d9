from pathlib import Path

import matplotlib
import numpy as np
import pytest

from fprc.escape import figure
from fprc.figures import style
from fprc.figures.tracking import plot_fit
from fprc.logs import Columns, write_columns
from fprc.stages import draw
from fprc.tables.figure_data import mean_loops

pytestmark = pytest.mark.slow

SIMULATED = {"source": "sim", "seed": 7, "model": "fprc"}


@pytest.fixture
def log(tmp_path):
    def write(name, amplitude=1.0, speed=1.0, **attributes):
        time = np.arange(80) / 20.0
        channels = {
            "time_s": time,
            "p_target_kpa": 175.0 + 100.0 * amplitude * np.sin(speed * time),
            "theta_deg": 20.0 + 15.0 * amplitude * np.sin(speed * time - 0.3),
            "p_o_kpa": 100.0 + 5.0 * np.sin(time - 0.5),
            "p_ff_kpa": 177.0 + 100.0 * np.sin(time),
        }
        write_columns(tmp_path / name, channels, SIMULATED | attributes)
        return str(tmp_path / name)

    return write


@pytest.fixture
def files(tmp_path):
    """PDF, PNG and CSV of a figure."""
    return [str(tmp_path / f"f.{kind}") for kind in ("pdf", "png", "csv")]


@pytest.mark.parametrize(
    ("data", "mark"),
    [
        ({"source": "sim", "seed": 7}, "simulated rig, seed 7"),
        ({"source": "rig", "seed": 7}, "recorded on the rig"),
        ({"source": "rig"}, "recorded on the rig"),
        ({"source": "import"}, "imported recordings"),
    ],
)
def test_figure_is_marked_by_the_source_of_its_data_alone(axes, data, mark):
    style.save(axes.figure, data)
    assert [text.get_text() for text in axes.figure.texts] == [mark]


def test_figure_is_the_same_whatever_the_users_matplotlibrc_says(tmp_path):
    theirs = {"text.usetex": True, "savefig.bbox": "tight", "axes.facecolor": "black"}
    pictures = []
    for name, own in (("ours", {}), ("theirs", theirs)):
        matplotlib.rcParams.update(own)
        fig, ax = style.figure(1, 1, 2.0, 1.0)
        ax.plot([0, 1], label="a_b")
        style.save(fig, {"source": "rig"}, str(tmp_path / f"{name}.png"))
        pictures.append((tmp_path / f"{name}.png").read_bytes())
    assert pictures[0] == pictures[1]


def test_drawing_is_saved_with_the_source_and_the_seed_of_its_log(log, files, figures):
    logs = log("one.h5", seed=9), log("two.h5", seed=9)
    draw.draw_hysteresis(*logs, fig4=files[:2], fig5=files[:2])
    draw.draw_training(*logs, files)
    assert [(fig.data["source"], fig.data["seed"]) for fig in figures] == [("sim", 9)] * 3


def test_loops_show_the_start_until_the_command_turns(log, files, figures):
    logs = log("one.h5", speed=3.0), log("two.h5", speed=4.0)
    draw.draw_hysteresis(*logs, fig4=files[:2], fig5=files[:2])
    for fig in figures:
        starts = [ax.lines[-1] for ax in fig.axes[:2]]
        # the command turns after a quarter of a period of 2 pi / 3 or 2 pi / 4 seconds
        lengths = [len(line.get_xdata()) for line in starts]
        assert lengths == pytest.approx([20 * np.pi / 6, 20 * np.pi / 8], abs=1.0)


@pytest.mark.parametrize("seed", range(3))
def test_mean_loops_of_each_band_are_those_without_noise(seed):
    time_s = np.arange(0.0, 90.0, 0.005)
    f_hz = np.where(time_s < 50.0, 0.15, 0.55)
    phase = np.cumsum(2.0 * np.pi * f_hz) * 0.005
    noise = np.random.default_rng(seed).normal(scale=0.5, size=len(time_s))
    width = np.where(f_hz < 0.5, 1.0, 2.0)
    loops = mean_loops(
        {"time_s": time_s, "p_target_kpa": np.sin(phase), "y": width * np.cos(phase) + noise}
    )
    for edge, size in ((0.1, 1.0), (0.5, 2.0)):
        loop = loops[np.isclose(loops["f_hz"], edge)]
        assert loop["y"].iloc[0] == loop["y"].iloc[-1]
        assert np.ptp(loop["y"]) == pytest.approx(2.0 * size, abs=0.4)
        radius = np.hypot(loop["p_target_kpa"], loop["y"] / size)
        np.testing.assert_allclose(radius, 1.0, atol=0.25)


def test_a_recording_that_never_turns_is_one_loop():
    time_s = np.arange(300) / 100.0
    loops = mean_loops({"time_s": time_s, "p_target_kpa": time_s, "theta_deg": 2.0 * time_s})
    assert loops["f_hz"].unique() == pytest.approx([0.3])
    assert loops["theta_deg"].max() == pytest.approx(6.0, abs=0.05)


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("FPRC on low-passed theta_d", r"FPRC on low-passed $\theta_{d}$"),
        ("P_o's n_c", "$P_{o}$'s $n_{c}$"),
        ("P_ff over P_fb", r"$P_\mathrm{ff}$ over $P_\mathrm{fb}$"),
        ("fuzzy_linear costs $5", r"fuzzy_linear costs \$5"),
    ],
)
def test_symbols_of_the_paper_are_typeset(text, shown):
    assert style.symbols(text) == shown


@pytest.mark.parametrize("unit", [r"$\frac{$", "$x$", "\x1b[31mN"])
def test_unit_from_a_file_is_drawn_as_text(axes, unit):
    """A pair of dollars would be a formula, and a wrong one an error."""
    time = np.linspace(0.0, 4.0, 5)
    plot_fit(time, time, time, axes, axes.figure.add_subplot(), unit)
    axes.figure.canvas.draw()
    assert axes.get_ylabel() == rf"$P_\mathrm{{exp}}$ [{figure(unit)}]"
    log = Columns(Path("x.h5"), {}, {"p_target_unit": unit})
    axes.set_xlabel(draw._label("p_target_kpa", log))
