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


def readout(*asked: str, mapping: Mapping[str, Any]) -> dict[str, Any]:
    """Run `fprc readout` in an empty folder and return its report on the models."""
    with tempfile.TemporaryDirectory() as folder:
        asked += ("--out", f"{folder}/out")
        for option, content in (("--map", mapping), ("--config", FEW)):
            path = Path(folder, f"{option[2:]}.yaml")
            path.write_text(yaml.safe_dump(content), encoding="utf-8")
            asked += (option, str(path))
        if code := main(["readout", *asked]):
            raise SystemExit(code)
        return read_json(f"{folder}/out/readout/competitors.json")


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
    for dataset, file in FILES.items():
        path = str(datasets / dataset / file)
        mapping = yaml.safe_load((ROOT / f"config/maps/{dataset}.yaml").read_text("utf-8"))
        yield row(f"`{dataset}`", readout(path, mapping=mapping))
    yield row(f"`{dataset}`, in mm", readout(path, mapping=in_mm(mapping)))
    with tempfile.TemporaryDirectory() as name:
        logs = [str(Path(name, f"{experiment}.h5")) for experiment in ("complex", "sweep")]
        for log in logs:
            main(["simulate", Path(log).stem, "--out", log])
        report = readout(logs[0], "--train", logs[1], mapping=SIMULATED)
        yield row("sweep of the simulated rig", report)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    table = pd.DataFrame(rows(Path(sys.argv[1]))).to_markdown(index=False, disable_numparse=True)
    page = PAGE.read_text(encoding="utf-8")
    write_text(PAGE, replace_block(page, "recordings", table, str(PAGE)))
