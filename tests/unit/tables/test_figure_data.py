"""Each figure's table has the numbers that are drawn."""

import statistics
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from fprc.artifacts import write_json
from fprc.config.load import PUBLISHED
from fprc.figures import style
from fprc.logs import Columns, write_columns
from fprc.paper import LOOPS, reference_and_controller, run_log
from fprc.stages import draw, draw_tracking

#: Nothing is saved to these.
PICTURES = ("f.pdf", "f.png")
PHASES = ("train", "validation", "test")
FOLDS = {1: [10.0, 12.0, 11.0, 16.0], 2: [9.0, 9.5, 8.0, 8.5], 4: [7.0, 7.1, 7.2, 7.7]}


@pytest.fixture
def place(tmp_path):
    return lambda name: str(tmp_path / name)


def cells_over(setting):
    return [
        {"model": model, setting: value, "train_rmse_kpa": folds, "test_rmse_kpa": folds[0],
         "validation_rmse_kpa": [2.0 * error for error in folds]}
        for model in (("fprc", "fuzzy_linear") if setting == "n_c" else ("fprc",))
        for value, folds in FOLDS.items()
    ]  # fmt: skip


def one_rig(place, **grids):
    write_json(place("grids.json"), {"source": "sim", "seed": 1, "unit": "kPa", **grids})
    return [place("grids.json")]


def times(place):
    entries = [
        {"model": model, "n_c": n_c, "phase": phase, "mode": mode, "seconds": folds}
        for model in ("fprc", "fuzzy_linear")
        for n_c, folds in FOLDS.items()
        for phase in ("train", "test")
        for mode in ("batch", "sequential")
    ]
    write_json(place("times.json"), {"source": "sim", "times": entries})
    return place("times.json")


def further_seeds(place):
    """Write two seeds' grids; each error is the first fold's, the second seed's are larger."""
    paths = []
    for seed in (101, 102):
        report = {"seed": seed, "source": "sim"}
        for name in ("n_c", "epsilon"):
            report[name] = [
                cell | {f"{phase}_rmse_kpa": np.ravel(cell[f"{phase}_rmse_kpa"])[0]
                        + 0.5 * (seed - 101) for phase in PHASES}
                for cell in cells_over(name)
            ]  # fmt: skip
        paths.append(place(f"grids_{seed}.json"))
        write_json(paths[-1], report)
    return paths


def test_fig_10_draws_the_means_and_sample_deviations_of_its_table(figures, place):
    csv = place("fig10.csv")
    grids = one_rig(place, **{name: cells_over(name) for name in ("n_c", "epsilon")})
    draw.draw_settings(grids, times(place), [*PICTURES, csv])
    assert figures[0].data["seed"] == 1
    table = pd.read_csv(csv)
    assert list(table["panel"].unique()) == ["a", "b", "c"]
    assert set(table["source"]) == {"sim"}
    for panel, ax in zip("abc", figures[0].axes, strict=True):
        rows = table[table["panel"] == panel]
        groups = list(rows.groupby(["model", "phase"], sort=False))
        assert len(groups) == len(ax.lines) == len(ax.collections)
        drawn = zip(groups, ax.lines, ax.collections, strict=True)
        for ((model, phase), group), line, band in drawn:
            assert line.get_linestyle() == style.line_of(model)["linestyle"]
            assert line.get_marker() == style.PHASES[phase]["marker"]
            assert line.get_xdata() == pytest.approx(group["value"].tolist())
            assert line.get_ydata() == pytest.approx(group["mean"].tolist(), rel=1e-5)
            if group["values"].iloc[0] > 1:
                factor = 2.0 if phase == "validation" else 1.0
                expected = [factor * statistics.stdev(folds) for folds in FOLDS.values()]
                assert group["std"].tolist() == pytest.approx(expected, rel=1e-5)
                heights = np.vstack([path.vertices for path in band.get_paths()])[:, 1]
                ends = (group["mean"] - group["std"]).min(), (group["mean"] + group["std"]).max()
                assert (heights.min(), heights.max()) == pytest.approx(ends, rel=1e-5)
            else:
                assert not band.get_paths()


def test_fig_10_of_further_seeds_shows_means_and_deviations_over_them(figures, place):
    draw.draw_settings(further_seeds(place), times(place), [*PICTURES, place("t.csv")])
    assert figures[0].data == {"seeds": [101, 102]}
    table = pd.read_csv(place("t.csv"))
    errors = table[table["panel"] != "c"]
    assert set(errors["values"]) == {2}
    assert errors["std"].tolist() == pytest.approx([0.5 / np.sqrt(2.0)] * len(errors), rel=1e-5)
    tests = errors[(errors["panel"] == "a") & (errors["phase"] == "test")]
    assert tests["mean"].tolist() == [folds[0] + 0.25 for folds in FOLDS.values()]


def test_fig_11_draws_the_means_of_its_table(figures, place):
    cells = [
        {"model": "fprc", "n_u": n_u, "n_y": n_y, "train_rmse_kpa": [n_u, n_y],
         "validation_rmse_kpa": [n_u, 3.0 * n_y], "test_rmse_kpa": n_u + 10.0 * n_y}
        for n_u in (1, 2, 3)
        for n_y in (1, 2)
    ]  # fmt: skip
    draw.draw_taps(one_rig(place, taps=cells), str(PUBLISHED), [*PICTURES, place("t.csv")])
    table = pd.read_csv(place("t.csv"))
    norms = set()
    for phase, ax in zip(("train", "validation", "test"), figures[0].axes, strict=False):
        (mesh,) = ax.collections[:1]
        norms.add(mesh.norm)
        rows = table[table["phase"] == phase].sort_values(["n_y", "n_u"])
        assert mesh.get_array().ravel().tolist() == pytest.approx(rows["mean"].tolist(), rel=1e-5)
        assert f"{rows['mean'].min():.1f}" in ax.get_title("left")
    (norm,) = norms
    assert (norm.vmin, norm.vmax) == pytest.approx((table["mean"].min(), table["mean"].max()))


def test_fig_8_writes_the_rmse_that_it_shows(figures, place):
    for name, offset in (("fit.h5", 3.0), ("test.h5", -5.0)):
        time_s = np.arange(20) / 20.0
        write_columns(
            place(name),
            {"time_s": time_s, "p_target_kpa": 100.0 * time_s, "p_ff_kpa": 100.0 * time_s + offset},
            {"source": "sim", "seed": 7, "model": "fprc"},
        )
    draw.draw_training(place("fit.h5"), place("test.h5"), [*PICTURES, place("t.csv")])
    table = pd.read_csv(place("t.csv"))
    assert table["rmse"].tolist() == pytest.approx([3.0, 5.0])
    shown = [ax.get_title("right") for ax in figures[0].axes]
    assert [text for text in shown if text] == ["RMSE 3.0 kPa", "RMSE 5.0 kPa"]


def test_fig_9_writes_the_shares_and_their_means(figures, place):
    shares = {"bias": [[0.1], [0.2]], "p_o": [[0.3, 0.1], [0.1, 0.1]], "theta_d": [[0.5], [0.6]]}
    means = {"p_o": 0.3, "theta_d": 0.55}
    report = {"source": "sim", "seed": 1, "shares": shares, "mean_share": means}
    write_json(place("weights.json"), report)
    draw.draw_weights(place("weights.json"), str(PUBLISHED), [*PICTURES, place("t.csv")])
    table = pd.read_csv(place("t.csv"))
    assert table.groupby("rule")["share"].sum().tolist() == pytest.approx([1.0, 1.0])
    of_p_o = table[table["feature"] == "p_o"]
    assert of_p_o.groupby("rule")["share"].sum().mean() == pytest.approx(0.3)
    assert set(of_p_o["mean_of_feature"]) == {0.3}
    assert set(of_p_o["published_mean_of_feature"]) == {0.561}
    assert [text.get_text() for text in figures[0].axes[0].texts] == [
        "30 %", "55 %", "56 %", "44 %"
    ]  # fmt: skip


PAIR = ("pd", "fprc_pd")


def run_of(place, name, controller, offset=1.0, pushed=0.0):
    """Write a closed-loop log of 50 s on a sine of 0.25 Hz; the last 30 s are pushed."""
    time_s = np.arange(5000) / 100.0
    wave = np.sin(2 * np.pi * 0.25 * (time_s - 5.0)) * (time_s >= 5.0)
    push = pushed * (time_s >= 20.0) * np.sin(7.0 * time_s)
    channels = {
        "time_s": time_s, "theta_d_deg": 30.0 * wave,
        "theta_deg": 30.0 * wave + np.where(time_s < 5.0, 25.0, offset * np.cos(time_s)),
        "p_ff_kpa": 100.0 * wave, "p_fb_kpa": wave, "p_i_kpa": 200.0 * wave,
        "p_o_kpa": 100.0 + 20.0 * wave, "phi_deg": 20.0 * wave + push,
    }  # fmt: skip
    attributes = {"source": "sim", "seed": 7, "reference": "sine_0p2", "controller": controller,
                  "settle_s": 5.0, "rig": {}}  # fmt: skip
    return Columns(Path(place(name)), channels, attributes)


@pytest.fixture
def logs(monkeypatch):
    """Logs by name, in place of files."""
    found = {}
    monkeypatch.setattr(
        draw_tracking, "read_each", lambda read, paths: [found[path] for path in paths]
    )
    return found


def test_figs_12_to_15_show_rmse_and_share_the_range_of_the_errors(figures, place, logs):
    logs["open"] = run_of(place, "open", "fprc", offset=4.0)
    logs["closed"] = run_of(place, "closed", "fprc_pd")
    for controller in ("fprc", "fprc_pd"):
        logs[f"other {controller}"] = run_of(place, "other", controller, offset=9.0)
        logs[f"other {controller}"].attributes["reference"] = "sweep"
    files = {name: [*PICTURES, place(f"{name}.csv")] for name in ("fig12", "fig14")}
    draw_tracking.draw_tracking(list(logs), quiet_s=20.0, **files)
    table = pd.read_csv(place("fig12.csv"))
    cosine = np.cos(np.arange(500, 5000) / 100.0)
    assert table["rmse_deg"].tolist() == pytest.approx(
        [4.0 * np.sqrt(np.mean(cosine**2)), np.sqrt(np.mean(cosine**2))], rel=1e-5
    )
    axes = np.reshape(figures[0].axes, (5, 2))
    limit = 1.05 * 9.0 * np.abs(cosine).max()
    for ax, end in axes:
        assert ax.get_xlim() == pytest.approx((0.0, 49.99))
        assert end.get_xlim() == pytest.approx((44.99, 49.99))
    for ax, rmse in zip(axes[:2, 0], table["rmse_deg"], strict=True):
        assert f"{rmse:.2f} deg" in ax.get_title(loc="right")
    assert axes[2, 0].get_ylim() == pytest.approx((-limit, limit))
    assert axes[4, 0].get_ylim() == pytest.approx((-1.05, 1.05), abs=0.01)  # of P_fb, in all runs
    for ax, channel in zip(axes[3:, 0], ("p_ff_kpa", "p_fb_kpa"), strict=True):
        np.testing.assert_array_equal(ax.lines[0].get_ydata(), logs["closed"].channels[channel])


def test_fig_16_shows_each_reference_with_pd_and_with_both(figures, place, logs):
    for name in (run_log(reference, controller) for reference in LOOPS for controller in PAIR):
        reference, controller = reference_and_controller(name)
        logs[name] = run_of(place, name, controller, offset=1.0 + len(logs))
        logs[name].attributes["reference"] = reference
    draw_tracking.draw_tracking(list(logs), quiet_s=20.0, fig16=PICTURES)
    for ax, reference in zip(figures[0].axes, LOOPS, strict=True):
        drawn = [line.get_ydata() for line in ax.lines if len(line.get_ydata()) == 4500]
        expected = [logs[run_log(reference, law)].channels["theta_deg"][500:] for law in PAIR]
        np.testing.assert_array_equal(drawn, expected)


def test_fig_17_shows_the_error_of_its_run_and_the_signals_of_the_reservoir(figures, place, logs):
    logs["run"] = run_of(place, "run", "fprc_pd", pushed=6.0)
    logs["run"].attributes["reference"] = "disturbance"
    draw_tracking.draw_tracking(["run"], quiet_s=20.0, fig17=[*PICTURES, place("t.csv")])
    cosine = np.cos(np.arange(500, 5000) / 100.0)
    (rmse,) = pd.read_csv(place("t.csv"))["rmse_deg"]
    assert rmse == pytest.approx(np.sqrt(np.mean(cosine**2)), rel=1e-5)
    for ax, name in zip(figures[0].axes[2:], ("p_i_kpa", "phi_deg", "p_o_kpa"), strict=True):
        (line,) = ax.lines
        np.testing.assert_array_equal(line.get_ydata(), logs["run"].channels[name])
        assert [span.get_x() for span in ax.patches] == [0.0, 5.0, 20.0]
