"""Write the table of recordings in docs/own-data.md: ``python tools/recordings.py folder``.

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
from fprc.cli import main
from fprc.recordings.answer import family_title
from fprc.studies.pages import replace_block
from fprc.tables.text import three_digits

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs/own-data.md"
#: Public recordings: file below the folder of its map's name.
FILES = {"byu_bellows_arm": "bellows_arm_whitened.mat", "pneusim_antagonistic_pam": "data.mat"}
SIMULATED = {
    "time": {"column": "time_s"},
    "channels": {
        name: {"column": name, "unit": unit}
        for name, unit in {"theta_deg": "deg", "p_exp_command_kpa": "kPa", "p_o_kpa": "kPa"}.items()
    },
}


def readout(*asked: str, mapping: Mapping[str, Any]) -> dict[str, Any]:
    """Run `fprc readout` in an empty folder and return its report on the models."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "map.yaml")
        path.write_text(yaml.safe_dump(mapping), encoding="utf-8")
        if code := main(["readout", *asked, "--out", f"{folder}/out", "--map", str(path)]):
            raise SystemExit(code)
        return read_json(f"{folder}/out/readout/answer.json")


def row(name: str, report: Mapping[str, Any]) -> dict[str, str]:
    """Return the row of a recording."""
    found = report["answer"]
    beaten = sum(found["with"]["error"] < error for error in found["shifts"])
    sides = {
        f"{side} P_o": f"{three_digits(found[side]['error'])} {report['unit']}, "
        f"{family_title(found[side]['family'], side == 'with')}"
        for side in ("without", "with")
    }
    return {
        "recording": name,
        "length": f"{found['duration_s']:.0f} s in {len(found['block_s'])} blocks",
        "answer": found["verdict"],
        **sides,
        "ratio": f"{found['ratio']:.2f} ({found['low']:.2f} to {found['high']:.2f})",
        "shifts beaten": f"{beaten} of {len(found['shifts'])}",
        **{claim["id"]: claim["words"] for claim in report["claims"]},
    }


def recordings(datasets: Path, folder: str) -> Iterator[tuple[str, list[str], dict[str, Any]]]:
    """Yield name, files and map of each recording; simulated ones are written to the folder."""
    for dataset, file in FILES.items():
        mapping = yaml.safe_load((ROOT / f"config/maps/{dataset}.yaml").read_text("utf-8"))
        yield f"`{dataset}`", [str(datasets / dataset / file)], mapping
    test, train = (str(Path(folder, f"{experiment}.h5")) for experiment in ("complex", "sweep"))
    for log in (test, train):
        main(["simulate", Path(log).stem, "--out", log])
    yield "sweep of the simulated rig", [test, "--train", train], SIMULATED


if __name__ == "__main__":
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    with tempfile.TemporaryDirectory() as scratch:
        rows = [
            row(name, readout(*files, mapping=mapping))
            for name, files, mapping in recordings(Path(sys.argv[1]), scratch)
        ]
    text = pd.DataFrame(rows).to_markdown(index=False, disable_numparse=True)
    write_text(PAGE, replace_block(PAGE.read_text("utf-8"), "recordings", text, str(PAGE)))
