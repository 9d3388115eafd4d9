"""Each figure draws the numbers of its CSV, and is marked by the source of its data."""

import statistics
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from fprc.config import Settings
from fprc.escape import figure
from fprc.experiments.comparison import CrossValidation
from fprc.figures import grids, hysteresis, style
from fprc.logs import Columns, write_columns
from fprc.paper import LOOPS, REFERENCES
from fprc.stages import draw

pytestmark = pytest.mark.slow

#: Nothing is saved to these.
PICTURES = ("f.pdf", "f.png")
HOW = CrossValidation(models={}, folds=5, split="shuffled", seed=1)
SIMULATED = {"source": "sim", "seed": 7, "model": "fprc"}
PHASES = ("train", "validation", "test")
FOLDS = {1: [10.0, 12.0, 11.0, 16.0], 2: [9.0, 9.5, 8.0, 8.5], 4: [7.0, 7.1, 7.2, 7.7]}


@pytest.fixture
def place(tmp_path):
    return lambda name: str(tmp_path / name)


@pytest.fixture
def log(tmp_path):
    def write(name, speed=1.0, offset=2.0, **attributes):
        time = np.arange(80) / 20.0
        channels = {
            "time_s": time,
            "p_target_kpa": 175.0 + 100.0 * np.sin(speed * time),
            "theta_deg": 20.0 + 15.0 * np.sin(speed * time - 0.3),
            "p_o_kpa": 100.0 + 5.0 * np.sin(time - 0.5),
        }
        channels["p_ff_kpa"] = channels["p_target_kpa"] + offset
        write_columns(tmp_path / name, channels, SIMULATED | attributes)
        return str(tmp_path / name)

    return write


# Style


@pytest.mark.parametrize(
    ("data", "mark"),
    [
        ({"source": "sim", "seed": 7}, "simulated rig, seed 7"),
        ({"source": "rig", "seed": 7}, "recorded on the rig"),
        ({"source": "import"}, "imported recordings"),
        ({"seeds": [1, 2]}, "simulated rigs"),
    ],
)
def test_figure_is_marked_by_the_source_of_its_data_alone(axes, data, mark):
    style.save(axes.figure, data)
    assert [text.get_text() for text in axes.figure.texts] == [mark]


@pytest.mark.parametrize("unit", [r"$\frac{$", "$x$", "\x1b[31mN"])
def test_unit_from_a_file_is_drawn_as_text(axes, unit):
    """A pair of dollars would be a formula, and a wrong one an error."""
    axes.set_xlabel(hysteresis.label("p_target_kpa", {"p_target_unit": unit}))
    axes.figure.canvas.draw()
    assert axes.get_xlabel() == rf"$P_\mathrm{{exp}}$ [{figure(unit)}]"


# Figures 4, 5 and 8


def test_loops_show_the_start_until_the_command_turns(log, figures):
    logs = log("one.h5", speed=3.0), log("two.h5", speed=4.0)
    draw.draw_experiments(*logs, fig4=PICTURES, fig5=PICTURES, validation=HOW)
    for fig in figures:
        assert fig.data["seed"] == 7
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
    loops = hysteresis.mean_loops(
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
    channels = {"time_s": time_s, "p_target_kpa": time_s, "theta_deg": 2.0 * time_s}
    loops = hysteresis.mean_loops(channels)
    assert loops["f_hz"].unique() == pytest.approx([0.3])
    assert loops["theta_deg"].max() == pytest.approx(6.0, abs=0.05)


def test_fig_8_writes_the_rmse_that_it_shows(figures, log, place):
    logs = log("fit.h5", offset=3.0), log("test.h5", offset=-5.0)
    hysteresis.draw_training(*logs, [*PICTURES, place("t.csv")])
    assert pd.read_csv(place("t.csv"))["rmse"].tolist() == pytest.approx([3.0, 5.0])
    shown = [ax.get_title("right") for ax in figures[0].axes]
    assert [text for text in shown if text] == ["RMSE 3.0 kPa", "RMSE 5.0 kPa"]


# Figures 9 to 11


def test_fig_9_writes_the_shares_and_their_means(figures, place, monkeypatch):
    shares = {"bias": [[0.1], [0.2]], "p_o": [[0.3, 0.1], [0.1, 0.1]], "theta_d": [[0.5], [0.6]]}
    found = {"shares": shares, "mean_share": {"p_o": 0.3, "theta_d": 0.55}}
    data = Columns(Path("sweep.h5"), {}, {"source": "sim"})
    monkeypatch.setattr(draw, "read_data", lambda path: data)
    monkeypatch.setattr(draw, "weight_shares", lambda data, how: found)
    draw.draw_experiments("sweep.h5", fig9=[*PICTURES, place("t.csv")], validation=HOW)
    table = pd.read_csv(place("t.csv"))
    assert table.groupby("rule")["share"].sum().tolist() == pytest.approx([1.0, 1.0])
    of_p_o = table[table["feature"] == "p_o"]
    assert of_p_o.groupby("rule")["share"].sum().mean() == pytest.approx(0.3)
    assert set(of_p_o["mean_of_feature"]) == {0.3}
    assert set(of_p_o["published_mean_of_feature"]) == {0.561}
    assert [text.get_text() for text in figures[0].axes[0].texts] == [
        "30 %", "55 %", "56 %", "44 %"
    ]  # fmt: skip


def cells_over(setting, fold=None):
    """Cells with errors of four folds, or of one; a later fold's are larger."""
    return [
        {"model": model, setting: value, "test_rmse_kpa": folds[0] + 0.5 * (fold or 0)}
        | {
            f"{phase}_rmse_kpa": [factor * x for x in folds] if fold is None
            else factor * folds[0] + 0.5 * fold
            for phase, factor in (("train", 1.0), ("validation", 2.0))
        }
        for model in (("fprc", "fuzzy_linear") if setting == "n_c" else ("fprc",))
        for value, folds in FOLDS.items()
    ]  # fmt: skip


TAPS = [
    {"model": "fprc", "n_u": n_u, "n_y": n_y, "train_rmse_kpa": [n_u, n_y],
     "validation_rmse_kpa": [n_u, 3.0 * n_y], "test_rmse_kpa": n_u + 10.0 * n_y}
    for n_u in (1, 2, 3)
    for n_y in (1, 2)
]  # fmt: skip


@pytest.fixture
def drawn(figures, place):
    """Draw Figs. 10 and 11 of reports; return their figures and tables."""

    def make(*reports):
        entries = [
            {"model": model, "n_c": n_c, "phase": phase, "mode": mode, "seconds": folds}
            for model in ("fprc", "fuzzy_linear")
            for n_c, folds in FOLDS.items()
            for phase in ("train", "test")
            for mode in ("batch", "sequential")
        ]
        whole = [{"source": "sim", "taps": TAPS} | report for report in reports]
        files = [[*PICTURES, place(name)] for name in ("fig10.csv", "fig11.csv")]
        grids.draw_grids(whole, {"source": "sim", "times": entries}, *files)
        return *figures, *(pd.read_csv(file[-1]) for file in files)

    return make


def test_figs_10_and_11_draw_the_means_and_sample_deviations_of_their_tables(drawn):
    grids = {name: cells_over(name) for name in ("n_c", "epsilon")}
    settings, taps, table, of_taps = drawn({"seed": 1, "unit": "kPa", **grids})
    assert settings.data["seed"] == 1
    assert list(table["panel"].unique()) == ["a", "b", "c"]
    for panel, ax in zip("abc", settings.axes, strict=True):
        groups = list(table[table["panel"] == panel].groupby(["model", "phase"], sort=False))
        for ((model, phase), group), line, band in zip(
            groups, ax.lines, ax.collections, strict=True
        ):
            assert line.get_linestyle() == style.line_of(model)["linestyle"]
            assert line.get_marker() == style.PHASES[phase]["marker"]
            assert line.get_xdata() == pytest.approx(group["value"].tolist())
            assert line.get_ydata() == pytest.approx(group["mean"].tolist(), rel=1e-5)
            if group["values"].iloc[0] == 1:
                assert not band.get_paths()
                continue
            factor = 2.0 if phase == "validation" else 1.0
            expected = [factor * statistics.stdev(folds) for folds in FOLDS.values()]
            assert group["std"].tolist() == pytest.approx(expected, rel=1e-5)
    for phase, ax in zip(PHASES, taps.axes, strict=False):
        rows = of_taps[of_taps["phase"] == phase].sort_values(["n_y", "n_u"])
        mesh = ax.collections[0]
        assert mesh.get_array().ravel().tolist() == pytest.approx(rows["mean"].tolist(), rel=1e-5)
        ends = of_taps["mean"].min(), of_taps["mean"].max()
        assert (mesh.norm.vmin, mesh.norm.vmax) == pytest.approx(ends)
        assert f"{rows['mean'].min():.1f}" in ax.get_title("left")


def test_fig_10_of_further_seeds_shows_means_and_deviations_over_them(drawn):
    fig, _, table, _ = drawn(
        *({"seed": 101 + k} | {name: cells_over(name, k) for name in ("n_c", "epsilon")}
          for k in range(2))
    )  # fmt: skip
    assert fig.data == {"seeds": [101, 102]}
    errors = table[table["panel"] != "c"]
    assert set(errors["values"]) == {2}
    assert errors["std"].tolist() == pytest.approx([0.5 / np.sqrt(2.0)] * len(errors), rel=1e-5)
    tests = errors[(errors["panel"] == "a") & (errors["phase"] == "test")]
    assert tests["mean"].tolist() == [folds[0] + 0.25 for folds in FOLDS.values()]


# Figures 12 to 17


def run_of(reference, controller, offset):
    """Return a closed-loop log of 50 s on a sine of 0.25 Hz; the last 30 s are pushed."""
    time_s = np.arange(5000) / 100.0
    wave = np.sin(2 * np.pi * 0.25 * (time_s - 5.0)) * (time_s >= 5.0)
    channels = {
        "time_s": time_s, "theta_d_deg": 30.0 * wave,
        "theta_deg": 30.0 * wave + np.where(time_s < 5.0, 25.0, offset * np.cos(time_s)),
        "p_ff_kpa": 100.0 * wave, "p_fb_kpa": wave, "p_i_kpa": 200.0 * wave,
        "p_o_kpa": 100.0 + 20.0 * wave, "phi_deg": 20.0 * wave + 6.0 * (time_s >= 20.0),
    }  # fmt: skip
    attributes = {"reference": reference, "controller": controller, "settle_s": 5.0}
    return Columns(Path(f"{reference}_{controller}"), channels, SIMULATED | attributes)


# the runs of a figure that is not made widen no axes
@pytest.mark.parametrize("last", [14, 15])
def test_figs_12_to_17_show_the_errors_and_signals_of_their_runs(figures, place, monkeypatch, last):
    names = [(name, loop) for name in REFERENCES for loop in ("fprc", "fprc_pd")]
    names += [(name, "pd") for name in LOOPS] + [("disturbance", "fprc_pd")]
    logs = {name: run_of(*name, offset=1.0 + k) for k, name in enumerate(names)}
    monkeypatch.setattr(draw, "read_each", lambda read, paths: list(logs.values()))
    numbers = (*range(12, last + 1), 17)
    files = {f"fig{n}": [*PICTURES, place(f"fig{n}.csv")] for n in numbers} | {"fig16": PICTURES}
    limits = Settings().quality
    more = {"left_out": [], "limits": limits, "feedback": "", "quiet_s": 20.0}
    draw.draw_loops([], **more, **files)
    *following, loops, disturbance = figures
    cosine = np.cos(np.arange(500, 5000) / 100.0)
    size = np.sqrt(np.mean(cosine**2))
    for k, fig in enumerate(following):
        rmse = pd.read_csv(place(f"fig{12 + k}.csv"))["rmse_deg"]
        assert rmse.tolist() == pytest.approx([(2 * k + 1) * size, (2 * k + 2) * size], rel=1e-5)
        axes = np.reshape(fig.axes, (5, 2))
        for ax, end in axes:
            assert ax.get_xlim() == pytest.approx((0.0, 49.99))
            assert end.get_xlim() == pytest.approx((44.99, 49.99))
        for ax, number in zip(axes[:2, 0], rmse, strict=True):
            assert f"{number:.2f} deg" in ax.get_title(loc="right")
        # the ranges are those of all runs
        limit = 1.05 * 2 * (last - 11) * np.abs(cosine).max()
        assert axes[2, 0].get_ylim() == pytest.approx((-limit, limit))
        assert axes[4, 0].get_ylim() == pytest.approx((-1.05, 1.05), abs=0.01)
        closed = logs[REFERENCES[k], "fprc_pd"].channels
        for ax, channel in zip(axes[3:, 0], ("p_ff_kpa", "p_fb_kpa"), strict=True):
            np.testing.assert_array_equal(ax.lines[0].get_ydata(), closed[channel])
    for ax, reference in zip(loops.axes, LOOPS, strict=True):
        drawn = [line.get_ydata() for line in ax.lines if len(line.get_ydata()) == 4500]
        pair = [logs[reference, law].channels["theta_deg"][500:] for law in ("pd", "fprc_pd")]
        np.testing.assert_array_equal(drawn, pair)
    (rmse,) = pd.read_csv(place("fig17.csv"))["rmse_deg"]
    assert rmse == pytest.approx(len(names) * size, rel=1e-5)
    for ax, name in zip(disturbance.axes[2:], ("p_i_kpa", "phi_deg", "p_o_kpa"), strict=True):
        pushed = logs["disturbance", "fprc_pd"].channels[name]
        np.testing.assert_array_equal(ax.lines[0].get_ydata(), pushed)
        assert [span.get_x() for span in ax.patches] == [0.0, 5.0, 20.0]
