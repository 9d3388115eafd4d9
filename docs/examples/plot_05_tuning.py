"""
Tuning
======

Choose epsilon by cross-validation on blocks of the training log, and see what the choice is worth
on the test log.
"""

import numpy as np
from sklearn.model_selection import GridSearchCV, TimeSeriesSplit

from fprc.datasets import load_hysteresis
from fprc.evaluation import evaluate, settled_rmse, split_rows
from fprc.figures import style
from fprc.models import FPRC

train, test = load_hysteresis("sweep"), load_hysteresis("complex")

# %%
# Neighbours in time resemble each other, so whole blocks validate, and the 400 samples on each
# side of a block do not train.
folds = split_rows(len(train.target), 5, "blocked", seed=1, purge=400)
logs = [(log.data, log.target, None) for log in (train, test)]
epsilons = [0.001, 0.003, 0.01, 0.03, 0.1]
errors = []
for epsilon in epsilons:
    found = evaluate(FPRC(epsilon=epsilon, random_state=1), folds, *logs)
    errors.append([np.mean(found[f"{name}_rmse_kpa"]) for name in ("train", "validation", "test")])
    print(f"epsilon {epsilon}: training, validation, test {np.round(errors[-1], 1)} kPa")

# %%
# The best epsilon in the validation need not be the best on another signal: :doc:`/beyond`
# measures how much that costs on six kinds of rigs.
figure, axes = style.figure(1, 1, style.COLUMN_IN, 2.5)
for phase, values in zip(("train", "validation", "test"), np.transpose(errors), strict=True):
    axes.semilogx(epsilons, values, color="0.3", label=phase, **style.PHASES[phase])
axes.set(xlabel="epsilon", ylabel="RMSE [kPa]", ylim=(0, None))
axes.set_title("Simulated rig")
style.legend_above(axes)

# %%
# scikit-learn's tools do the same for any parameter, if the folds are whole stretches of time. With
# ``KFold(shuffle=True)`` they would be wrong without a word: a model takes each row for the next
# sample. The first 400 samples of a test, in which the filter settles, do not count.
search = GridSearchCV(
    FPRC(random_state=1),
    {"epsilon": epsilons, "n_c": [4, 8]},
    cv=TimeSeriesSplit(n_splits=4, gap=400),
    scoring=settled_rmse(400),
)
search.fit(train.data, train.target)
print(f"{search.best_params_}: {-search.best_score_:.1f} kPa on later times")
