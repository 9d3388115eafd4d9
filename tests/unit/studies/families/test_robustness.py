import itertools
import re
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest
import yaml
from matplotlib.text import Text
from matplotlib.transforms import Bbox
from scipy.stats import t

from fprc.artifacts import write_json
from fprc.config import PUBLISHED, Settings
from fprc.figures import style
from fprc.studies.families.claims import JUDGED_BY_RIG
from fprc.studies.families.robustness import (
    ensemble,
    ensemble_page,
    sensitivity,
    sensitivity_page,
    targets,
    targets_page,
    worth,
)
from fprc.studies.stages import robustness
from fprc.studies.stages.draw_ensemble import draw_ensemble
from fprc.tables.text import read_markdown

pytestmark = pytest.mark.slow

PRINTED = yaml.safe_load(PUBLISHED.read_text(encoding="utf-8"))
PATHS = list(Settings().calibration.free)
MODELS = ("esn", "fprc", "fuzzy_linear")
TEXTS = {claim.id: claim.text for claim in JUDGED_BY_RIG}


def write(stage, tmp_path, *arguments, **options):
    """Run a stage that writes a table; return its CSV, Markdown and LaTeX."""
    files = {kind: str(tmp_path / f"table.{kind}") for kind in ("csv", "md", "tex")}
    stage(*arguments, **files, **options)
    csv, md, tex = (Path(file).read_text(encoding="utf-8") for file in files.values())
    for text in (md, tex):
        assert not re.search(r"\b(nan|inf|none)\b", text, re.IGNORECASE)
    return csv, md, tex


def has_no_gap(page):
    assert page.notna().all(axis=None)
    assert not page.map(lambda cell: bool(re.search(r"\b(nan|inf)\b", str(cell)))).any(axis=None)
    return True


# --- ensemble -------------------------------------------------------------------------------------


def claim(name, holds, correlations):
    share = holds / 38
    return {
        "id": name,
        "claim": TEXTS[name],
        "rig": "fitted",
        "holds": holds,
        "rigs": 38,
        "share": share,
        "low": max(share - 0.125, 0.0),
        "high": min(share + 0.125, 1.0),
        "correlations": correlations,
        "least_significant": 0.47,
    }


def correlations(*first):
    """Return correlations of all parameters; the later ones are weak."""
    values = [*first, *np.linspace(-0.4, 0.4, len(PATHS) - len(first))]
    return dict(zip(PATHS, values, strict=True))


def given(names, holds, rigs, low, high, p):
    return {
        "given": list(names), "holds": holds, "rigs": rigs, "share": holds / rigs,
        "low": low, "high": high, "ratio": [0.9, 0.7, 1.2], "p": p,
        "matters": None if p is None else p < 0.05 / 3,
    }  # fmt: skip


def make_summary():
    """Return the summary of an ensemble in which one claim holds on all rigs and one on none."""
    named = {
        "C2": (19, correlations(0.5, -0.9, 0.46)),
        "C3": (38, {}),
        "C4": (0, {}),
        "C7a": (30, correlations(0.3, 0.2)),
    }
    return {
        "source": "sim",
        "seeds": list(range(1000, 1040)),
        "parameters": PATHS,
        "rigs": 40,
        "failed": 2,
        "draws": 123,
        "drawn": "rigs that were drawn",
        "deviation": 0.14,
        "worth": [0.9, 0.7, 1.2],
        "worth_given": [
            given((), 19, 38, 0.35, 0.65, None),
            given(("C8a",), 9, 10, 0.6, 0.98, 0.012),
            given(("C18a",), 0, 5, 0.0, 0.43, 0.056),
            {
                "given": ["C8a", "C18a"],
                "holds": 0,
                "rigs": 0,
                "ratio": [None] * 3,
                **dict.fromkeys(("share", "low", "high", "p", "matters")),
            },
        ],
        "near_print": [
            {
                "limit": name,
                "holds": holds,
                "rigs": 38,
                "share": holds / 38,
                "low": 0.01,
                "high": 0.145,
                "claims": {"B1": b1, "C8a": 0, "C18a": 1, "C18b": 0},
            }
            for name, holds, b1 in (("Table IV, 15 % at most", 3, 2), ("all", 1, 1))
        ],
        "claims": [claim(name, *named.get(name, (25, correlations(-0.6)))) for name in TEXTS],
    }


@pytest.fixture
def summary():
    return make_summary()


def row_of(table, name):
    (row,) = table[table["id"] == name].to_dict("records")
    return row


def test_ensemble_has_a_row_for_each_claim_with_its_share(summary):
    table = ensemble(summary)
    assert table["id"].tolist() == list(TEXTS)
    assert set(table["source"]) == {"sim"}
    row = row_of(table, "C2")
    assert (row["claim"], row["holds"], row["rigs"]) == (TEXTS["C2"], 19, 38)
    assert (row["share"], row["low"], row["high"]) == (0.5, 0.375, 0.625)


def test_only_parameters_beyond_chance_decide_the_strongest_first(summary):
    table = ensemble(summary)
    row = row_of(table, "C2")
    assert row["decided_by"] == f"{PATHS[1]} (-0.90); {PATHS[0]} (+0.50)"
    assert row["strongest"] == f"{PATHS[1]} (-0.90)"
    row = row_of(table, "C7a")
    assert (row["decided_by"], row["strongest"]) == ("", f"{PATHS[2]} (-0.40)")


@pytest.mark.parametrize("name", ["C3", "C4"])
def test_claim_that_all_rigs_agree_on_is_decided_by_nothing(summary, name):
    row = row_of(ensemble(summary), name)
    assert (row["decided_by"], row["strongest"]) == ("", "")


def test_worth_is_decided_where_its_interval_excludes_one_half(summary):
    table = worth(summary)
    assert table["given"].tolist() == ["", "C8a", "C18a", "C8a and C18a"]
    assert table["verdict"].tolist() == ["undecided", "yes", "no", "undecided"]
    assert table["matters"].tolist() == ["", "yes", "no", ""]
    ratios = table[["ratio", "ratio_low", "ratio_high"]].to_numpy()[:3]
    assert ratios.tolist() == [[0.9, 0.7, 1.2]] * 3


def test_page_of_the_ensemble_is_what_a_person_reads(summary):
    page = ensemble_page(ensemble(summary)).set_index("Claim")
    assert has_no_gap(page)
    assert page.loc["C2"].tolist() == [
        TEXTS["C2"], "fitted", "19 of 38", "50 % (38 to 62)",
        f"{PATHS[1]} (-0.90); {PATHS[0]} (+0.50)",
    ]  # fmt: skip
    assert page.loc["C3"].tolist() == [TEXTS["C3"], "fitted", "38 of 38", "100 % (88 to 100)", "-"]


def test_files_of_the_ensemble_say_what_it_is(summary, tmp_path):
    write_json(tmp_path / "summary.json", summary)
    csv, md, tex = write(robustness.tabulate_ensemble, tmp_path, str(tmp_path / "summary.json"))
    note, page = read_markdown(md)
    assert "38 simulated rigs" in note
    assert "2 more could not be judged, 123 draws" in note
    assert "0.47" in note
    assert page["Claim"].tolist() == list(TEXTS)
    assert len(csv.splitlines()) == 1 + len(TEXTS)
    assert r"50 \%" in tex


def test_page_of_the_limits_counts_rigs_and_their_claims(summary, tmp_path):
    write_json(tmp_path / "summary.json", summary)
    csv, md, tex = write(robustness.tabulate_near_print, tmp_path, str(tmp_path / "summary.json"))
    note, page = read_markdown(md)
    assert "38 simulated rigs" in note
    assert page.to_numpy().tolist() == [
        ["Table IV, 15 % at most", "3 of 38", "7.9 % (1.0 to 14.5)", "2", "0", "1", "0"],
        ["all", "1 of 38", "2.6 % (1.0 to 14.5)", "1", "0", "1", "0"],
    ]
    assert len(csv.splitlines()) == 3
    assert r"7.9 \%" in tex


# --- sensitivity ----------------------------------------------------------------------------------

ERRORS = {
    f"{trained_on}/{model}/{phase}": 10.0
    for trained_on in ("sweep", "complex")
    for model in MODELS
    for phase in ("train", "test")
}


def cell(path, share, **factors):
    errors = {key: value * factors.get("every", 1.0) for key, value in ERRORS.items()}
    for key, factor in factors.items():
        if key != "every":
            errors[key.replace("_on_", "/").replace("__", "/")] *= factor
    return {"path": path, "share": share, "errors": errors}


@pytest.fixture
def report():
    """Effects of a weak parameter, of a strong one, and of one with an impossible end."""
    return {
        "source": "sim",
        "seeds": [201, 202],
        "cells": [
            cell(None, None),
            cell(PATHS[0], 0.0, every=0.9),
            cell(PATHS[0], 1.0, every=1.05),
            cell(PATHS[1], 0.0, sweep__fprc__test=2.5),
            cell(PATHS[1], 1.0, complex__esn__train=0.8),
            {"path": PATHS[2], "share": 0.0, "errors": None, "impossible": "it breaks a rule"},
            cell(PATHS[2], 1.0, every=0.6),
        ],
    }


def test_sensitivity_is_the_change_against_the_unmoved_rig(report):
    report["cells"][0]["errors"]["sweep/fprc/test"] = 20.0
    table = sensitivity(report)
    assert len(table) == 5 * len(ERRORS)
    found = table.set_index(["parameter", "share_of_range", "trained_on", "model", "phase"])
    row = found.loc[(PATHS[1], 0.0, "sweep", "fprc", "test")]
    assert (row["rmse_kpa"], row["change"], row["source"]) == (25.0, 0.25, "sim")
    row = found.loc[(PATHS[0], 1.0, "complex", "esn", "train")]
    assert row["change"] == pytest.approx(0.05)


def test_page_of_the_sensitivity_has_the_strongest_parameter_first(report):
    page = sensitivity_page(sensitivity(report))
    assert has_no_gap(page)
    assert page["Parameter"].tolist() == [PATHS[1], PATHS[2], PATHS[0]]
    assert list(page.columns) == [
        "Parameter",
        *(
            f"{number} {name} {phase}"
            for number in ("II", "III")
            for name in ("ESN", "FPRC", "Fuzzy-linear")
            for phase in ("training", "test")
        ),
    ]
    strong, impossible, weak = page.to_dict("records")
    assert strong["II FPRC test"] == "+0 to +150 %"
    assert strong["III ESN training"] == "-20 to +0 %"
    assert set(weak.values()) == {PATHS[0], "-10 to +5 %"}
    assert set(impossible.values()) == {PATHS[2], "-40 to -40 %"}


def test_parameter_that_is_impossible_everywhere_has_no_row(report):
    report["cells"][-1] = report["cells"][-2] | {"share": 1.0}
    page = sensitivity_page(sensitivity(report))
    assert page["Parameter"].tolist() == [PATHS[1], PATHS[0]]
    assert has_no_gap(page)


# --- targets --------------------------------------------------------------------------------------

REFERENCES = ("sine_0p2", "sine_0p5", "sweep", "complex", "disturbance")
RUNS = ("fprc", "fprc_pd", "pd")


def replicate(seed, error):
    return {
        "seed": seed,
        "source": "sim",
        "models": [
            {
                "model": model,
                "trained_on": trained_on,
                "train_rmse_kpa": [error - 1.0, error + 1.0],
                "validation_rmse_kpa": [error + 2.0],
                "test_rmse_kpa": error + 5.0 * (model == "fprc"),
            }
            for trained_on in ("sweep", "complex")
            for model in MODELS
        ],
    }


def control(seed, error):
    return {
        "seed": seed,
        "source": "sim",
        "rmse_deg": {
            f"{reference}/{run}": error + k + 10.0 * n
            for n, run in enumerate(RUNS)
            for k, reference in enumerate(REFERENCES)
        },
    }


VALUES = {"command": (10.0, 12.0, 14.0), "measured": (20.0, 21.0, 22.0)}


@pytest.fixture
def reports():
    """Reports of three seeds for both targets."""
    return [
        {target: [make(seed, value) for seed, value in enumerate(values)]
         for target, values in VALUES.items()}
        for make in (replicate, control)
    ]  # fmt: skip


def test_targets_hold_tables_2_to_4_with_intervals_of_the_mean(reports):
    table = targets(*reports, PRINTED)
    assert table.groupby(["target", "table"], sort=False).size().to_dict() == {
        (target, number): count
        for target in VALUES
        for number, count in (("II", 9), ("III", 9), ("IV", 10))
    }
    assert set(table["source"]) == {"sim"}
    found = table.set_index(["target", "table", "what"])
    row = found.loc[("command", "II", "FPRC, Test RMSE")]
    half = t.ppf(0.975, 2) * 2.0 / np.sqrt(3.0)
    assert (row["mean"], row["low"], row["high"]) == pytest.approx((17.0, 17.0 - half, 17.0 + half))
    assert (row["unit"], row["published"]) == ("kPa", 11.0)
    row = found.loc[("measured", "III", "ESN, Test RMSE")]
    assert (row["mean"], row["published"]) == (21.0, 60.32)


def test_targets_never_follow_with_pd_alone(reports):
    table = targets(*reports, PRINTED)
    fourth = table[(table["table"] == "IV") & (table["target"] == "command")]
    assert fourth["what"].tolist() == [
        f"{name}, {reference}"
        for name in ("FPRC", "FPRC+PD")
        for reference in (
            "Sine 0.2 Hz", "Sine 0.5 Hz", "Sweep", "Complex", "Sine 0.3 Hz, disturbed",
        )
    ]  # fmt: skip
    assert fourth["mean"].tolist() == [12.0 + k for k in range(5)] + [22.0 + k for k in range(5)]
    assert fourth["published"].tolist()[:4] == [2.04, 2.25, 2.67, 1.70]
    assert pd.isna(fourth["published"].iloc[4])


def test_page_of_the_targets_has_both_beside_the_paper(reports):
    page = targets_page(targets(*reports, PRINTED))
    assert has_no_gap(page)
    assert len(page) == 9 + 9 + 10
    shown = page.set_index(["Table", "RMSE"])
    assert shown.loc[("II", "FPRC, Test RMSE [kPa]")].tolist() == [
        "17.0 (12.0 to 22.0)", "26.0 (23.5 to 28.5)", "11.0",
    ]  # fmt: skip
    assert shown.loc[("IV", "FPRC, Sine 0.3 Hz, disturbed [deg]"), "Paper"] == ""


def test_files_of_the_targets_are_of_the_reports_in_the_folders_of_their_names(reports, tmp_path):
    paths = []
    for kind, by_target in zip(("models", "control"), reports, strict=True):
        paths.append([])
        for target, group in by_target.items():
            for report in group:
                path = tmp_path / "replicates" / target / f"{kind}_{report['seed']}.json"
                write_json(path, report)
                paths[-1].append(str(path))
    csv, md, _ = write(
        robustness.tabulate_targets, tmp_path, str(PUBLISHED), *paths, names=list(VALUES)
    )
    note, page = read_markdown(md)
    assert "simulated rig, not hardware" in note
    assert page["Target command"].iloc[5] == "17.0 (12.0 to 22.0)"
    assert len(csv.splitlines()) == 1 + 2 * 28


# --- figure ---------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def draw(tmp_path_factory):
    """Draw a summary; return the figure, what the stage gives, and the bytes of its files."""
    folder, saved, save = tmp_path_factory.mktemp("drawn"), [], style.save

    def remember(fig, *arguments):
        saved.append(fig)
        return save(fig, *arguments)

    def call(summary):
        write_json(folder / "summary.json", summary)
        files = [folder / name for name in ("f.pdf", "f.png")]
        data = draw_ensemble(str(folder / "summary.json"), *map(str, files))
        return saved[-1], data, [file.read_bytes() for file in files]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(style, "save", remember)
        # fewer pixels and no subsets of fonts, for speed
        patch.setitem(style._STYLE, "savefig.dpi", 50)
        patch.setitem(style._STYLE, "pdf.fonttype", 3)
        yield call
    plt.close("all")


@pytest.fixture(scope="module")
def drawn(draw):
    """The summary, drawn once."""
    return draw(make_summary())


@pytest.fixture(scope="module")
def fig(drawn):
    return drawn[0]


def texts(fig):
    """Every text that is seen; ticks outside the limits are not."""
    found = [text for text in fig.findobj(Text) if text.get_text() and text.get_visible()]
    unseen = {
        label
        for ax in fig.axes
        for axis in (ax.xaxis, ax.yaxis)
        for label, at in zip(axis.get_ticklabels(), axis.get_ticklocs(), strict=True)
        if not min(axis.get_view_interval()) <= at <= max(axis.get_view_interval())
    }
    return [text for text in found if text not in unseen]


def test_nothing_of_the_figure_is_clipped_and_no_texts_overlap(fig):
    fig.draw_without_rendering()
    boxes = {text: text.get_window_extent() for text in texts(fig)}
    assert len(boxes) > 14 + 2 * len(TEXTS)
    for text, box in boxes.items():
        assert Bbox.union([fig.bbox, box]).bounds == pytest.approx(fig.bbox.bounds), text
    for (one, first), (other, second) in itertools.combinations(boxes.items(), 2):
        assert not first.overlaps(second), (one.get_text(), other.get_text())


def labels(ax, axis):
    return [label.get_text() for label in getattr(ax, f"get_{axis}ticklabels")()]


def test_figure_has_each_claim_and_the_parameters_with_the_strongest_correlations(fig, summary):
    shares, grid = fig.axes[:2]
    assert labels(shares, "y") == labels(grid, "x") == list(TEXTS)
    found = [row["correlations"] for row in summary["claims"] if row["correlations"]]
    strengths = {path: max(abs(row[path]) for row in found) for path in PATHS}
    strongest = sorted(strengths, key=strengths.get, reverse=True)[:14]
    assert len(set(labels(grid, "y"))) == 14
    drawn = np.ma.filled(grid.collections[0].get_array(), np.nan).reshape(14, -1)
    assert np.nanmax(np.abs(drawn), axis=1) == pytest.approx([strengths[p] for p in strongest])
    assert shares.get_title(loc="left").startswith("(a) Claims on 38 rigs")
    bottom, top = shares.get_ylim()
    assert bottom > top  # the first claim is at the top


def test_figure_shows_shares_with_their_intervals(fig, summary):
    (container,) = fig.axes[0].containers
    points, _, (bars,) = container.lines
    assert points.get_xdata().tolist() == [row["share"] for row in summary["claims"]]
    for segment, row in zip(bars.get_segments(), summary["claims"], strict=True):
        assert segment[:, 0] == pytest.approx([row["low"], row["high"]])


def test_figure_marks_correlations_beyond_chance_and_leaves_a_claim_without_any_empty(fig, summary):
    grid = fig.axes[1]
    values = np.ma.filled(grid.collections[0].get_array(), np.nan).reshape(14, -1)
    marked = {(int(y), int(x)) for x, y in zip(*grid.lines[0].get_data(), strict=True)}
    for column, found in enumerate(summary["claims"]):
        own = [abs(value) for value in values[:, column]]
        assert bool(found["correlations"]) != bool(np.isnan(own).all())
        beyond = {(row, column) for row, value in enumerate(own) if value > 0.47}
        assert beyond == {place for place in marked if place[1] == column}
    assert marked
    assert f"Beyond chance: {len(marked)} (x)" in grid.get_title(loc="left")


def test_figure_of_an_ensemble_that_agrees_on_everything_is_drawn(draw, summary):
    for row in summary["claims"]:
        row |= {"holds": 38, "share": 1.0, "low": 0.91, "high": 1.0, "correlations": {}}
    fig, *_ = draw(summary)
    assert fig.axes[1].lines[0].get_xdata().size == 0
    assert fig.axes[1].get_title(loc="left").endswith("none")
