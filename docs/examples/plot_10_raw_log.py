"""
Read a raw log
==============

A raw log is an HDF5 file: a dataset for each channel, whose name ends in its unit, and attributes
that say where it comes from.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import h5py

from fprc.figures import style
from fprc.logs import read_raw

path = Path(tempfile.mkdtemp()) / "sweep.h5"
command = f"simulate sweep --out {path}"
fprc = [sys.executable, "-m", "fprc"]  # the same as `fprc`, wherever it is installed
subprocess.run([*fprc, *command.split()], capture_output=True, check=True)

# %%
# Any program that reads HDF5 can read it:
with h5py.File(path) as log:
    for name in log:
        channel = log[name][:]
        print(f"{name:22}{channel.size:7} samples, {channel.min():8.3f} to {channel.max():8.3f}")

# %%
# ``read_raw`` also checks it: sums, units, the clock.
log = read_raw(path, experiment="sweep", sample_rate_hz=200.0, rate_tolerance=0.01)
print({name: log.attributes[name] for name in ("experiment", "source", "seed", "sample_rate_hz")})

# %%
figure, axes = style.figure(2, 1, style.COLUMN_IN, 3, sharex=True)
for ax, names in zip(
    axes, (("p_exp_kpa", "p_i_kpa", "p_o_kpa"), ("theta_deg", "phi_deg")), strict=True
):
    for name in names:
        signal = name.rpartition("_")[0]
        ax.plot(
            log.channels["time_s"], log.channels[name], color=style.SIGNALS[signal], label=signal
        )
    style.legend_above(ax)
axes[0].set_ylabel("Pressure [kPa]")
axes[1].set(xlabel="Time [s]", ylabel="Angle [deg]", xlim=(0, 40))
axes[0].set_title("Sweep, simulated rig")
