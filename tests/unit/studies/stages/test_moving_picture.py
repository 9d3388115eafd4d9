import numpy as np
import pytest
from PIL import Image

from fprc.studies.stages import moving_picture

pytestmark = pytest.mark.slow


def test_picture_moves_and_ends_as_its_poster(monkeypatch, write_run, tmp_path):
    monkeypatch.setattr(moving_picture, "SPAN_S", (0.2, 1.2))
    monkeypatch.setattr(moving_picture, "FRAMES_HZ", 4.0)
    gif, png = str(tmp_path / "a.gif"), str(tmp_path / "a.png")
    moving_picture.draw_moving_picture(write_run(), write_run("other.h5"), gif, png)
    with Image.open(gif) as moving, Image.open(png) as poster:
        frames, colours = [], set()
        for frame in range(moving.n_frames):
            moving.seek(frame)
            frames.append(np.asarray(moving.convert("L"), dtype=float))
            colours |= {colour for _, colour in moving.convert("RGB").getcolors()}
        assert len(frames) == 4
        assert len(colours) <= 64  # more make a large file
        assert all(np.any(a != b) for a, b in zip(frames, frames[1:], strict=False))
        last = np.asarray(poster.convert("L").resize(moving.size), dtype=float)
    apart = [np.abs(frame - last).mean() for frame in frames]
    assert min(apart) == apart[-1] < 0.8 * apart[0]
