"""Write the table of recordings in docs/chamber.md: ``make recordings DATASETS=folder``.

The folder has the two public recordings of ``config/maps``, each in a folder of its map's name.
"""

import sys
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pandas as pd
import yaml

from fprc.artifacts import read_json, write_text
from fprc.claims.paired import LEAST_UNITS
from fprc.cli import main
from fprc.studies.blocks import replace_block

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs/chamber.md"
BLOCK = "recordings"
#: Public recordings: file below the folder of its map's name.
FILES = {"byu_bellows_arm": "bellows_arm_whitened.mat", "pneusim_antagonistic_pam": "data.mat"}
#: The grid over epsilon and taps, which the table does not show, as small as it can be.
FEW = {"grids": {"epsilon": [0.01], "readout_taps": [3]}}
SIMULATED = {
    "experiment": "complex",
    "time": {"column": "time_s"},
    "channels": {
        name: {"column": name, "unit": unit}
        for name, unit in {"theta_deg": "deg", "p_exp_command_kpa": "kPa", "p_o_kpa": "kPa"}.items()
    },
}


def in_mm(mapping: Mapping[str, Any]) -> dict[str, Any]:
    """Return the map of a recording in um with its displacement in mm."""
    theta = {**mapping["channels"]["theta_deg"], "scale": 1e3, "note": "displacement x [mm]"}
    return {**mapping, "channels": {**mapping["channels"], "theta_deg": theta}}


def readout(folder: Path, *asked: str, mapping: Mapping[str, Any]) -> dict[str, Any]:
    """Run `fprc readout` in an empty folder and return its report on the models."""
    for name, content in (("map.yaml", mapping), ("few.yaml", FEW)):
        (folder / name).write_text(yaml.safe_dump(content), encoding="utf-8")
    given = ("--map", folder / "map.yaml", "--config", folder / "few.yaml", "--out", folder / "out")
    if code := main(["readout", *asked, *map(str, given)]):
        raise SystemExit(code)
    report: dict[str, Any] = read_json(folder / "out/readout/competitors.json")
    return report


def row(name: str, report: Mapping[str, Any]) -> dict[str, str]:
    """Return the row of a recording."""
    tested = {cell["model"]: cell.get("test_rmse_kpa") for cell in report["cells"]}
    lengths = sorted(report["block_s"])
    few = ", too few" if len(lengths) < LEAST_UNITS else ""
    verdicts = {
        claim["id"]: f"{claim['ratio']:.2f} ({claim['low']:.2f} to {claim['high']:.2f}), "
        f"{claim['verdict']}"
        for claim in report["verdicts"]
    }
    tests = {
        f"test, with {what}": f"{100 * (tested[model] / tested['fuzzy_linear'] - 1):+.0f} %"
        for model, what in (("fprc", "P_o"), ("fprc_lowpass", "low-passed theta"))
    }
    blocks = f"{len(lengths)} of {lengths[0]:.3g} s{few}"
    return {"recording": name, "blocks": blocks, **verdicts, **tests}


def rows(datasets: Path) -> Iterator[dict[str, str]]:
    """Evaluate the recordings one after the other, and yield their rows."""
    with tempfile.TemporaryDirectory() as name:
        folders = iter(Path(tempfile.mkdtemp(dir=name)) for _ in range(9))
        for dataset, file in FILES.items():
            path = str(datasets / dataset / file)
            mapping = yaml.safe_load((ROOT / f"config/maps/{dataset}.yaml").read_text("utf-8"))
            yield row(f"`{dataset}`", readout(next(folders), path, mapping=mapping))
        yield row(f"`{dataset}`, in mm", readout(next(folders), path, mapping=in_mm(mapping)))
        logs = [str(Path(name, f"{experiment}.h5")) for experiment in ("complex", "sweep")]
        for log in logs:
            main(["simulate", Path(log).stem, "--out", log])
        asked = (logs[0], "--train", logs[1])
        yield row("sweep of the simulated rig", readout(next(folders), *asked, mapping=SIMULATED))


def block(datasets: Path) -> str:
    """Return the table."""
    text: str = pd.DataFrame(rows(datasets)).to_markdown(index=False, disable_numparse=True)
    return text


if __name__ == "__main__":
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    page = replace_block(
        PAGE.read_text(encoding="utf-8"), BLOCK, block(Path(sys.argv[1])), str(PAGE)
    )
    write_text(PAGE, page)
