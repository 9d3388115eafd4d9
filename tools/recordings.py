"""Write the tables of recordings in docs/chamber.md: ``make recordings DATASETS=folder``.

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
from fprc.claims.paired import LEAST_UNITS, verdict_in_words
from fprc.cli import main
from fprc.studies.blocks import replace_block

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs/chamber.md"
#: Public recordings: file below the folder of its map's name.
FILES = {"byu_bellows_arm": "bellows_arm_whitened.mat", "pneusim_antagonistic_pam": "data.mat"}
SIMULATED_SWEEP = "sweep of the simulated rig"
#: Rates at which two recordings are evaluated again, with every second and every fourth sample.
RATES_HZ = {SIMULATED_SWEEP: (200, 100, 50), "`byu_bellows_arm`": (100, 50, 25)}
CLAIMS = ("B1", "B4", "R1")
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
        path = Path(folder, "map.yaml")
        path.write_text(yaml.safe_dump(mapping), encoding="utf-8")
        if code := main(["readout", *asked, "--out", f"{folder}/out", "--map", str(path)]):
            raise SystemExit(code)
        return read_json(f"{folder}/out/readout/competitors.json")


def row(name: str, report: Mapping[str, Any]) -> dict[str, str]:
    """Return the row of a recording."""
    tested = {cell["model"]: cell.get("test_rmse_kpa") for cell in report["cells"]}
    lengths = sorted(report["block_s"])
    few = ", too few" if len(lengths) < LEAST_UNITS else ""
    verdicts = {
        claim["id"]: f"{claim['ratio']:.2f} ({claim['low']:.2f} to {claim['high']:.2f}), "
        f"{verdict_in_words(claim['verdict'], True, claim['turned'])}"
        for claim in report["verdicts"]
    }
    tests = {
        f"test, with {what}": f"{100 * (tested[model] / tested['fuzzy_linear'] - 1):+.0f} %"
        for model, what in (("fprc", "P_o"), ("fprc_lowpass", "low-passed theta"))
    }
    blocks = f"{len(lengths)} of {lengths[0]:.3g} s{few}"
    return {"recording": name, "blocks": blocks, **verdicts, **tests}


def recordings(datasets: Path, folder: str) -> Iterator[tuple[str, list[str], dict[str, Any]]]:
    """Yield name, files and map of each recording; simulated ones are written to the folder."""
    for dataset, file in FILES.items():
        mapping = yaml.safe_load((ROOT / f"config/maps/{dataset}.yaml").read_text("utf-8"))
        yield f"`{dataset}`", [str(datasets / dataset / file)], mapping
    yield f"`{dataset}`, in mm", [str(datasets / dataset / file)], in_mm(mapping)
    test, train = (str(Path(folder, f"{experiment}.h5")) for experiment in ("complex", "sweep"))
    for log in (test, train):
        main(["simulate", Path(log).stem, "--out", log])
    yield SIMULATED_SWEEP, [test, "--train", train], SIMULATED


def tables(datasets: Path) -> dict[str, pd.DataFrame]:
    """Evaluate the recordings, two of them at lower rates too; return tables by their blocks."""
    at_own_rate, at_rates = [], []
    with tempfile.TemporaryDirectory() as folder:
        for name, files, mapping in recordings(datasets, folder):
            report = readout(*files, mapping=mapping)
            at_own_rate.append(row(name, report))
            for hz in RATES_HZ.get(name, ()):
                report = readout(*files, mapping=mapping | {"sample_rate_hz": hz})
                verdicts = {key: text for key, text in row(name, report).items() if key in CLAIMS}
                at_rates.append({"recording": name, "rate": f"{hz} Hz", **verdicts})
    return {"recordings": pd.DataFrame(at_own_rate), "rates": pd.DataFrame(at_rates)}


if __name__ == "__main__":
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    page = PAGE.read_text(encoding="utf-8")
    for block, table in tables(Path(sys.argv[1])).items():
        text = table.to_markdown(index=False, disable_numparse=True)
        page = replace_block(page, block, text, str(PAGE))
    write_text(PAGE, page)
