import json
from contextlib import nullcontext
from pathlib import Path

import numpy as np
import pytest
import yaml
from matplotlib import style
from matplotlib.figure import Figure
from PIL import Image

from fprc.errors import FprcError
from fprc.studies.stages.check import check_results


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Results as a run leaves them, and two pictures of the documentation."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "results").mkdir()
    (tmp_path / "results/claims.json").write_text(
        json.dumps({"claims": [{"id": "C1", "verdict": "reproduced", "rig": "fitted"}]})
    )
    (tmp_path / "known.yaml").write_text(yaml.safe_dump({"verdicts": {"C1": "reproduced"}}))
    (tmp_path / "docs").mkdir()
    for name in ("docs/one.png", "results/one.png", "docs/two.png"):
        Image.new("RGB", (40, 30), "red").save(name)
    return tmp_path


def check():
    pictures = {"docs/one.png": "results/one.png", "docs/two.png": "results/two.png"}
    check_results("results/claims.json", "known.yaml", pictures=pictures)


def test_verdict_that_is_not_as_declared_is_reported(folder):
    (folder / "known.yaml").write_text(yaml.safe_dump({"verdicts": {"C1": "undecided"}}))
    with pytest.raises(FprcError, match="C1"):
        check()


def drawn(path, *, factor=0.0, curve_px=0.0, dot_px=0.0, bar_px=0.0, text="RMSE 11.9 kPa"):
    """Draw a curve, a dot, a bar and a text, moved by pixels."""
    with style.context("default"):  # whatever was drawn before
        fig = Figure(figsize=(2, 1.5), dpi=150)
        ax = fig.add_axes([0, 0, 1, 1], xlim=(0, 300), ylim=(0, 225))
        noise = np.random.default_rng(0).normal(size=(2, 8000))
        x = np.linspace(0, 300, 8000)
        y = (100 + 40 * np.sin(x / 9) + noise[0] + curve_px) * (1 + factor * noise[1])
        ax.plot(x, y, lw=0.4)
        ax.plot([50 + dot_px + factor * 50], [30], "o", ms=3)
        ax.bar([250], [20 + bar_px + factor * 20], width=30, color="0.8")
        ax.text(100, 200, text, fontsize=6)
        fig.savefig(path)


def test_picture_of_the_numbers_of_another_processor_is_in_order(folder):
    drawn("docs/one.png")
    drawn("results/one.png", factor=1e-6)
    assert Path("docs/one.png").read_bytes() != Path("results/one.png").read_bytes()
    check()


@pytest.mark.parametrize(
    "change",
    [{"curve_px": 0.25}, {"dot_px": 1.0}, {"bar_px": 1.0}, {"text": "RMSE 11.8 kPa"}],
    ids=str,
)
def test_picture_that_shows_something_else_is_reported(folder, change):
    drawn("docs/one.png")
    drawn("results/one.png", **change)
    with pytest.raises(FprcError, match=r"docs/one\.png differs from results/one\.png$"):
        check()


@pytest.mark.parametrize(
    ("levels", "pixels", "reported"),
    [(16, 1200, False), (17, 20, False), (255, 20, False), (17, 21, True), (255, 1200, True)],
)
def test_few_pixels_or_faint_differences_are_no_other_picture(folder, levels, pixels, reported):
    pixel = np.zeros((30, 40, 3), np.uint8)
    Image.fromarray(pixel).save("docs/one.png")
    pixel.reshape(-1, 3)[:pixels, 1] = levels
    Image.fromarray(pixel).save("results/one.png")
    with pytest.raises(FprcError, match="results/one") if reported else nullcontext():
        check()


def test_everything_is_reported_at_once(folder):
    (folder / "known.yaml").write_text(yaml.safe_dump({"verdicts": {"C1": "not reproduced"}}))
    (folder / "docs/one.png").unlink()
    with pytest.raises(FprcError) as found:
        check()
    first = "".join(line[0] for line in str(found.value).splitlines())
    assert first == "v p "
