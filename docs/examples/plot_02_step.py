"""
Step in a loop
==============

A control loop asks for one sample at a time: ``reset`` begins a stream, ``step`` takes the next
sample, and the results are those of ``predict``.
"""

import time

import numpy as np

from fprc.datasets import load_hysteresis
from fprc.models import FPRC

train, test = load_hysteresis("sweep"), load_hysteresis("complex")
model = FPRC(random_state=1).fit(train.data, train.target)

# %%
# The sample given to ``reset`` counts as the input at all earlier times.
model.reset(test.data[0])
began = time.perf_counter()
p_ff = [model.step(x) for x in test.data[:2000]]
step_s = (time.perf_counter() - began) / 2000
print(f"largest difference to predict: {abs(model.predict(test.data)[:2000] - p_ff).max():.1e} kPa")
print(f"one step takes {1e6 * step_s:.0f} us of the 5000 us between two samples")

# %%
# A sensor that fails is refused and ignored; the stream goes on with the next sample.
try:
    model.step([20.0, np.nan])
except ValueError as error:
    print(f"refused: {error}")
print(f"next sample: {model.step(test.data[2000]):.1f} kPa, measured {test.target[2000]:.1f} kPa")
