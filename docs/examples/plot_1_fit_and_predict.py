"""
Fit and predict
===============

Train FPRC, and the same readout without the reservoir, on the sweep; test both on the complex
signal.
"""

import matplotlib.pyplot as plt

from fprc.datasets import load_hysteresis
from fprc.evaluation import rmse
from fprc.models import FPRC, FuzzyLinear

train, test = load_hysteresis("sweep"), load_hysteresis("complex")
print(test.DESCR)

# %%
# The columns of ``data`` are theta in deg and P_o in kPa. Fuzzy-linear takes theta alone.
fprc = FPRC(random_state=1).fit(train.data, train.target)
fuzzy_linear = FuzzyLinear(random_state=1).fit(train.data[:, :1], train.target)
p_ff = {"FPRC": fprc.predict(test.data), "Fuzzy-linear": fuzzy_linear.predict(test.data[:, :1])}
for name, predicted in p_ff.items():
    print(f"{name}: test RMSE {rmse(test.target, predicted):.1f} kPa")

# %%
# In a control loop a model predicts sample by sample, with the same result.
fprc.reset(test.data[0])
steps = [fprc.step(x) for x in test.data[:1000]]
print(f"largest difference: {abs(p_ff['FPRC'][:1000] - steps).max():.1e} kPa")

# %%
time_s = test.channels["time_s"]
shown = slice(0, 4000)
figure, axes = plt.subplots(figsize=(7, 3), layout="constrained")
axes.plot(time_s[shown], test.target[shown], color="black", label="P_exp")
for name, predicted in p_ff.items():
    axes.plot(time_s[shown], predicted[shown], label=name)
axes.set(xlabel="time [s]", ylabel="pressure [kPa]", title="Test log, simulated rig")
axes.legend()
