"""
A model of your own
===================

A model is features over time and a readout of each row; this one is ridge regression on the taps of
theta.
"""

from fprc.datasets import load_hysteresis
from fprc.evaluation import rmse
from fprc.figures import style
from fprc.models import FuzzyLinear, RidgeReadout, SequenceModel, TapFeatures


class RidgeOnTaps(SequenceModel):
    """P_ff(k) = w [1, theta(k), ..., theta(k-n_y+1)]."""

    def __init__(self, n_y=5, alpha=1e-3):
        self.n_y = n_y
        self.alpha = alpha

    def make_features(self):
        return TapFeatures(n_y=self.n_y, n_references=None)

    def make_readout(self):
        return RidgeReadout(self.alpha)


# %%
# ``fit``, ``predict``, ``reset`` and ``step`` come from the base class, which also fits several
# recordings at once.
train, test = load_hysteresis("sweep"), load_hysteresis("complex")
figure, axes = style.figure(1, 1, style.COLUMN_IN, 3)
axes.plot(test.data[:, 0], test.target, color=style.SIGNALS["p_exp"], lw=0.5, label="P_exp")
for model, grey in ((RidgeOnTaps(), "0.7"), (FuzzyLinear(random_state=1), "0.2")):
    predicted = model.fit(train.data[:, :1], train.target).predict(test.data[:, :1])
    name = type(model).__name__
    print(f"{name}: test RMSE {rmse(test.target, predicted):.1f} kPa")
    axes.plot(test.data[:, 0], predicted, color=grey, lw=0.5, label=name)
axes.set(xlabel="theta [deg]", ylabel="Pressure [kPa]", title="Test log, simulated rig")
axes.legend()

# %%
# :doc:`/extending` names the model in a configuration; then it is in every table of the workflow.
