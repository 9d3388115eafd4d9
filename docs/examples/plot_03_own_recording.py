"""
Your own recording, and its answer
==================================

From a CSV with its own names and units to the question of how much P_o improves the model. A
simulated experiment stands in for your file.
"""

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
# A map names the columns and their units, and where the test begins.
(folder / "map.yaml").write_text("""\
test_from_s: 80
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
print((folder / "mine/report.md").read_text(encoding="utf-8").partition("\n## The models")[0])

# %%
# The other models, on the same two parts of the recording:
table = pd.read_csv(folder / "mine/readout/competitors.csv").sort_values("test_rmse")
figure, axes = style.figure(1, 1, style.COLUMN_IN, 2.4)
axes.barh(table["model"], table["test_rmse"], color="0.6")
axes.set(xlabel="Test RMSE [kPa]")
style.letter(axes, "A recording of the simulated rig")
