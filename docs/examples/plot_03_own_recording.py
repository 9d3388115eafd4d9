"""
Your own recording, and its answer
==================================

From a CSV with its own names and units to the question of whether P_o is worth a second sensor. A
simulated experiment stands in for your file.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import pandas as pd

from fprc.datasets import load_hysteresis
from fprc.figures import style

folder = Path(tempfile.mkdtemp())
simulated = load_hysteresis("sweep").channels
pd.DataFrame(
    {
        "t [ms]": 1e3 * simulated["time_s"],
        "angle [rad]": np.deg2rad(simulated["theta_deg"]),
        "P set [bar]": simulated["p_exp_command_kpa"] / 100.0,
        "PAM B [kPa abs]": simulated["p_o_kpa"] + 101.325,
    }
).to_csv(folder / "arm.csv", sep=";", index=False)

# %%
# A map names the columns and their units.
(folder / "map.yaml").write_text("""\
experiment: sweep
time: {column: "t [ms]", unit: ms}
channels:
  theta_deg: {column: "angle [rad]", unit: rad}
  p_exp_command_kpa: {column: "P set [bar]", unit: bar}
  p_o_kpa: {column: "PAM B [kPa abs]", unit: kPa, offset: -101.325, note: read as absolute}
""")
command = "readout arm.csv --map map.yaml --out mine"
fprc = [sys.executable, "-m", "fprc"]  # the same as `fprc`, wherever it is installed
subprocess.run([*fprc, *command.split()], cwd=folder, capture_output=True, check=True)

# %%
# ``mine/report.md`` begins with the answer.
print(
    (folder / "mine/report.md").read_text(encoding="utf-8").partition("\n## The paper's models")[0]
)

# %%
# Both sides, family by family:
answer = json.loads((folder / "mine/readout/answer.json").read_text(encoding="utf-8"))["answer"]
table = pd.DataFrame({side: answer[side]["families"] for side in ("without", "with")})
figure, axes = style.figure(1, 1, style.COLUMN_IN, 2.4)
table.plot.barh(ax=axes, color=["0.75", "0.35"])
axes.set(xlabel="RMSE on unseen blocks [kPa]", ylabel="")
axes.legend(["without P_o", "with P_o"])
axes.set_title("A recording of the simulated rig")
