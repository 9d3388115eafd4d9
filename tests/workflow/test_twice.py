"""A second cold build: one core, another folder, time zone, locale and hash seed."""

import pytest

pytestmark = pytest.mark.slow


def test_second_build_gives_the_same_bytes(smoked, rebuilt):
    first, second = (project.folder / "results/smoke" for project in (smoked[0], rebuilt))
    for name in ("report.html", "claims.json", "figures/fig10_settings.pdf"):
        assert (second / name).exists()
    times = "timing/times.json"
    assert (first / times).read_bytes() != (second / times).read_bytes()
    assert rebuilt.differences_but_times(smoked[0]) == ""
