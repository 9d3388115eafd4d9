"""
Your own recording
==================

From a CSV with its own names and units to a raw log and a model. A simulated experiment stands in
for your file.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from fprc.datasets import load_hysteresis
from fprc.models import FPRC

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
# A map names the columns and their units. ``fprc import`` checks the recording and writes a raw
# log.
(folder / "map.yaml").write_text("""\
experiment: sweep
time: {column: "t [ms]", unit: ms}
channels:
  theta_deg: {column: "angle [rad]", unit: rad}
  p_exp_command_kpa: {column: "P set [bar]", unit: bar}
  p_o_kpa: {column: "PAM B [kPa abs]", unit: kPa, offset: -101.325, note: read as absolute}
""")
command = "import arm.csv --map map.yaml --out sweep.h5"
fprc = [sys.executable, "-m", "fprc"]  # the same as `fprc`, wherever it is installed
done = subprocess.run(
    [*fprc, *command.split()], cwd=folder, capture_output=True, text=True, check=True
)
print(done.stdout)

# %%
# The raw log is read in the same form as a simulated one.
mine = load_hysteresis("sweep", raw=folder / "sweep.h5")
model = FPRC(random_state=1).fit(mine.data[:16000], mine.target[:16000])
rest = slice(16000, None)
figure, axes = plt.subplots(figsize=(4, 3), layout="constrained")
axes.plot(mine.data[rest, 0], mine.target[rest], color="black", lw=0.5, label="recorded")
axes.plot(mine.data[rest, 0], model.predict(mine.data)[rest], lw=0.5, label="FPRC")
axes.set(xlabel="theta [deg]", ylabel="P_exp [kPa]", title="Last 40 s, not in the training")
axes.legend()
