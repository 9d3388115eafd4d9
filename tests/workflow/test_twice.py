"""A second cold build: one core, another folder, time zone, locale and hash seed."""

import time

import pytest

from tools import twice

pytestmark = pytest.mark.slow


def test_second_build_gives_the_same_bytes(smoked, rebuilt):
    first, second = (project.folder / "results/smoke" for project in (smoked[0], rebuilt))
    assert not twice.agree(first, second), "times that were measured anew were the same"
    twice.give_measurements(first, second)
    done = rebuilt.smoke("all")
    assert done.returncode == 0, done.stdout
    assert twice.agree(first, second)
    for name in ("report.html", "claims.json", "figures/fig10_settings.pdf"):
        assert (second / name).exists()


@pytest.mark.parametrize(("second", "code"), [("same", 0), ("other", 1)])
def test_exit_code_says_whether_builds_agree(monkeypatch, second, code):
    def build(folder, circumstances):
        assert (folder / "workflow/Snakefile").exists()
        results = folder / "results"
        if results in begun:  # the second build again, with the measurements of the first
            return
        (results / "timing").mkdir(parents=True)
        for name in twice.MEASURED:
            (results / name).write_text(str(time.monotonic()))
        begun.append(results)
        (results / "claims.json").write_text(second if len(begun) == 2 else "same")

    begun = []
    monkeypatch.setattr(twice, "build", build)
    assert twice.main() == code
    assert len(begun) == 2
