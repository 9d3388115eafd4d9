"""
The rig as a benchmark
======================

Compare models on several draws of both rigs: what makes the loops decides what the reservoir is
worth.
"""

import matplotlib.pyplot as plt
import numpy as np

from fprc.datasets import load_hysteresis
from fprc.evaluation import rmse
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
figure, axes = plt.subplots(figsize=(6, 2.5), layout="constrained")
for place, rig in enumerate(["dry", "viscous"]):
    found = np.array([errors(rig, seed) for seed in (501, 502, 503)])
    axes.barh(np.arange(3) + 0.35 * place, found.mean(axis=0), 0.3, label=f"rig {rig}")
    for name, mean, std in zip(names, found.mean(axis=0), found.std(axis=0, ddof=1), strict=True):
        print(f"rig {rig}, {name}: {mean:.1f} ± {std:.1f} kPa")
axes.set_yticks(np.arange(3) + 0.175, names)
axes.set(xlabel="test RMSE [kPa]", title="Mean of three seeds, simulated rigs")
axes.legend(loc="upper left", bbox_to_anchor=(1, 1))
