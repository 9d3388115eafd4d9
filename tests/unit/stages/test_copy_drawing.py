"""Figures that show no data."""

from pathlib import Path

from PIL import Image

from fprc.figures import DRAWINGS
from fprc.plan.results import RESULTS
from fprc.stages.copy_drawing import copy_drawing


def test_copies_have_the_bytes_of_the_drawing(tmp_path):
    given = [tmp_path / "given.pdf", tmp_path / "given.png"]
    given[0].write_bytes(b"%PDF \xff")
    given[1].write_bytes(b"\x89PNG")
    made = [tmp_path / "made.pdf", tmp_path / "made.png"]
    copy_drawing(list(map(str, given)), *map(str, made))
    assert [path.read_bytes() for path in made] == [path.read_bytes() for path in given]


def test_every_figure_that_is_made_of_nothing_has_a_drawing():
    stems = [
        Path(result.files[0]).stem
        for result in RESULTS
        if result.name.startswith("fig") and result.files and not result.made_of
    ]
    names = {f"{stem}.{kind}" for stem in stems for kind in ("pdf", "png")}
    assert {path.name for path in DRAWINGS.iterdir()} == names


def test_drawings_are_as_wide_and_as_sharp_as_other_figures():
    for path in DRAWINGS.glob("*.png"):
        with Image.open(path) as picture:
            assert picture.width == 1050  # a column of 3.5 inches at 300 dpi
            assert round(picture.info["dpi"][0]) == 300
        assert path.stat().st_size < 200_000
