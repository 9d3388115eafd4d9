"""
Export to C
===========

A fitted model becomes one C header for a microcontroller. Here a compiler builds it for this
computer, to compare it with Python.
"""

import ctypes
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from fprc.datasets import load_hysteresis
from fprc.models import FPRC, save_model

train, test = load_hysteresis("sweep"), load_hysteresis("complex")
model = FPRC(random_state=1).fit(train.data, train.target)
folder = Path(tempfile.mkdtemp())
save_model(model, folder / "fprc.h5")
command = "export fprc.h5 --c fprc_model.h"
fprc = [sys.executable, "-m", "fprc"]  # the same as `fprc`, wherever it is installed
subprocess.run([*fprc, *command.split()], cwd=folder, check=True)
print("\n".join((folder / "fprc_model.h").read_text().splitlines()[:12]))

# %%
# ``fprc_model_init`` begins a stream, and ``fprc_model_step`` takes the next sample.
(folder / "model.c").write_text("""\
#include "fprc_model.h"
static fprc_model_state state;
void init(void) { fprc_model_init(&state); }
double step(const double *x) { return fprc_model_step(&state, x); }
""")
if shutil.which("cc"):
    build = "cc -O2 -shared -fPIC model.c -o model.so -lm"
    subprocess.run(build.split(), cwd=folder, check=True)
    library = ctypes.CDLL(str(folder / "model.so"))
    library.step.restype = ctypes.c_double
    library.init()
    in_c = [library.step((ctypes.c_double * 2)(*x)) for x in test.data]
    print(f"largest difference to Python: {np.max(abs(model.predict(test.data) - in_c)):.1e} kPa")
