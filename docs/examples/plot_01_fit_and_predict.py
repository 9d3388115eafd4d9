"""
Fit and predict
===============

Train FPRC, and the same readout without the reservoir, on the sweep; test both on the complex
signal.
"""

from fprc.datasets import load_hysteresis
from fprc.evaluation import rmse
from fprc.figures import style
from fprc.models import FPRC, FuzzyLinear

train, test = load_hysteresis("sweep"), load_hysteresis("complex")
print(test.DESCR)

# %%
# The columns of ``data`` are theta in deg and P_o in kPa. Fuzzy-linear takes theta alone.
fprc = FPRC(random_state=1).fit(train.data, train.target)
fuzzy_linear = FuzzyLinear(random_state=1).fit(train.data[:, :1], train.target)
p_ff = {"fprc": fprc.predict(test.data), "fuzzy_linear": fuzzy_linear.predict(test.data[:, :1])}
for name, predicted in p_ff.items():
    print(f"{name}: test RMSE {rmse(test.target, predicted):.1f} kPa")

# %%
time_s = test.channels["time_s"]
shown = slice(0, 4000)
figure, axes = style.figure(1, 1, style.COLUMN_IN, 2.4)
axes.plot(time_s[shown], test.target[shown], color=style.SIGNALS["p_exp"], label="P_exp")
for name, predicted in p_ff.items():
    axes.plot(time_s[shown], predicted[shown], label=name, **style.line_of(name))
axes.set(xlabel="Time [s]", ylabel="Pressure [kPa]")
axes.set_title("Simulated rig")
style.legend_above(axes)
