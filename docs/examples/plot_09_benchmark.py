"""
The rig as a benchmark
======================

Compare models on several draws of two rigs: what makes the loops decides what the reservoir is
worth.
"""

import numpy as np

from fprc.datasets import load_hysteresis
from fprc.evaluation import rmse
from fprc.figures import style
from fprc.models import FPRC, FuzzyLinear


def errors(rig, seed):
    """Return the test RMSE of FPRC, of FPRC on theta in place of P_o, and of Fuzzy-linear."""
    train, test = (load_hysteresis(name, rig=rig, seed=seed) for name in ("sweep", "complex"))

    def judged(model, columns):
        model.fit(train.data[:, columns], train.target)
        return rmse(test.target, model.predict(test.data[:, columns]))

    return [
        judged(FPRC(random_state=seed), [0, 1]),
        judged(FPRC(random_state=seed), [0, 0]),
        judged(FuzzyLinear(random_state=seed), [0]),
    ]


# %%
# Three seeds show how it is done; a comparison needs ten or more.
names = ["FPRC", "FPRC on low-passed theta", "Fuzzy-linear"]
figure, axes = style.figure(1, 1, style.COLUMN_IN, 2.4)
for place, rig in enumerate(["dry", "viscous"]):
    found = np.array([errors(rig, seed) for seed in (501, 502, 503)])
    grey = ("0.35", "0.75")[place]
    axes.barh(np.arange(3) + 0.35 * place, found.mean(axis=0), 0.3, color=grey, label=f"rig {rig}")
    for name, mean, std in zip(names, found.mean(axis=0), found.std(axis=0, ddof=1), strict=True):
        print(f"rig {rig}, {name}: {mean:.1f} ± {std:.1f} kPa")
axes.set_yticks(np.arange(3) + 0.175, names)
axes.set(xlabel="Test RMSE [kPa]")
axes.set_title("Simulated rigs")
style.legend_above(axes)
