import inspect
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from fprc.escape import figure
from fprc.figures import style
from fprc.figures.grids import plot_grid
from fprc.figures.hysteresis import plot_loop
from fprc.figures.tracking import plot_fit
from fprc.logs import Columns, write_columns
from fprc.stages import draw

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


def written(drawing, pdf, png):
    """Return the files that a drawing writes, its table first if it has one."""
    tables = [pdf.with_suffix(".csv")] if "csv" in inspect.signature(drawing).parameters else []
    return [str(path) for path in (*tables, pdf, png)]


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


@pytest.mark.parametrize(
    "drawing",
    [draw.draw_actuator_hysteresis, draw.draw_reservoir_hysteresis, draw.draw_training],
    ids=lambda drawing: drawing.__name__,
)
def test_drawing_is_saved_with_the_source_and_the_seed_of_its_log(drawing, log, tmp_path, figures):
    logs = log("one.h5", seed=9), log("two.h5", seed=9)
    drawing(*logs, *written(drawing, tmp_path / "f.pdf", tmp_path / "f.png"))
    assert (figures[0].data["source"], figures[0].data["seed"]) == ("sim", 9)


def test_loops_of_the_sweep_alone_are_coloured_and_both_show_the_start(log, tmp_path, figures):
    logs = log("one.h5", speed=3.0), log("two.h5", speed=4.0)
    for drawing in (draw.draw_actuator_hysteresis, draw.draw_reservoir_hysteresis):
        drawing(*logs, *written(drawing, tmp_path / "f.pdf", tmp_path / "f.png"))
    for fig, first, last in zip(figures, (1, 0), (3, 1), strict=True):
        sweep, other = fig.axes[first], fig.axes[last]
        assert len(sweep.collections[0].get_array()) == 79
        assert other.collections[0].get_array() is None
        # the command turns after a quarter of a period of 2 pi / 3 or 2 pi / 4 seconds
        lengths = [len(ax.lines[0].get_xdata()) for ax in (sweep, other)]
        assert lengths == pytest.approx([20 * np.pi / 6, 20 * np.pi / 8], abs=1.0)


def test_training_is_shown_by_its_first_and_its_last_tenth_and_the_test_is_whole(
    log, tmp_path, figures
):
    logs = log("one.h5"), log("two.h5")
    draw.draw_training(*logs, *written(draw.draw_training, tmp_path / "f.pdf", tmp_path / "f.png"))
    spans = [ax.get_xlim() for ax in figures[0].axes]
    assert np.ravel(spans) == pytest.approx([0.0, 0.395, 3.555, 3.95, 0.0, 3.95])
    for ax in figures[0].axes:
        truth, model = (line.get_ydata() for line in ax.lines)
        assert len(truth) == len(model) == 80


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
    plot_fit(time, time, time, axes, unit)
    axes.figure.canvas.draw()
    assert axes.get_ylabel() == rf"$P_\mathrm{{exp}}$ [{figure(unit)}]"
    log = Columns(Path("x.h5"), {}, {"p_target_unit": unit})
    table = pd.DataFrame(
        {"n_y": [1, 1], "n_u": [1, 2], "mean": [1.0, 2.0], "unit": unit, "phase": "train"}
    )
    plot_grid(table, "train", axes, (3, 5))
    axes.set_xlabel(draw._label("p_target_kpa", log))


def test_loop_joins_neighbouring_samples_and_is_coloured_by_frequency(axes):
    x, y, f_hz = np.array([0.0, 1.0, 1.0]), np.array([0.0, 0.0, 5.0]), np.array([0.3, 0.7, 0.9])
    plot_loop(x, y, axes, ("x [kPa]", "y [deg]"), f_hz)
    (lines,) = axes.collections
    drawn = zip(lines.get_array().tolist(), map(np.ndarray.tolist, lines.get_segments()),
                strict=True)  # fmt: skip
    assert sorted(drawn) == [(0.3, [[0.0, 0.0], [1.0, 0.0]]), (0.7, [[1.0, 0.0], [1.0, 5.0]])]
    assert lines.get_clim() == (0.3, 0.9)
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x [kPa]", "y [deg]")
    assert axes.get_ylim()[1] >= 5.0
