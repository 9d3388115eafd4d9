"""Two public recordings, read from a folder beside the project; skipped if they are not there."""

from pathlib import Path

import pytest

from fprc.cli import main
from fprc.given import read_json

ROOT = Path(__file__).parents[2]
DATASETS = ROOT.parent / "shared" / "datasets"
PNEUSIM = DATASETS / "pneusim_antagonistic_pam" / "data.mat"
BYU = DATASETS / "byu_bellows_arm" / "bellows_arm_whitened.mat"


@pytest.mark.slow
@pytest.mark.parametrize(("source", "unit"), [(PNEUSIM, "N"), (BYU, "% of its scale")])
def test_one_command_goes_from_the_file_to_a_report(source, unit, tmp_path):
    if not source.exists():
        pytest.skip(f"{source.parent.name} is not in a folder shared/datasets beside the project")
    map_file = ROOT / f"config/maps/{source.parent.name}.yaml"
    asked = ["readout", str(source), "--map", str(map_file), "--out", str(tmp_path / "out")]
    assert main(asked) == 0
    report = read_json(tmp_path / "out/readout/answer.json")
    assert report["unit"] == unit
    if source == PNEUSIM:
        # as much as a ridge by other hands: 26.3 N without, 23.1 N with p1
        errors = [report["answer"][side]["families"]["taps"] for side in ("without", "with")]
        assert all(20.0 < error < 32.0 for error in errors)
    page, found = (ROOT / "docs/own-data.md").read_text(encoding="utf-8"), report["answer"]
    (row,) = [line for line in page.splitlines() if line.startswith(f"| `{source.parent.name}`")]
    assert found["verdict"] in row
    assert "{ratio:.2f} ({low:.2f} to {high:.2f})".format_map(found) in row
