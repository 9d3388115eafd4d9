"""
P_o drifts
==========

The same model twice on the same rig, whose sealed chamber reads 5 kPa more than in the training:
once as it was trained, once learning while it runs.
"""

import matplotlib.pyplot as plt
import numpy as np

from fprc.config import Settings
from fprc.datasets import load_hysteresis
from fprc.experiments.tracking import Track, tracking_rmse
from fprc.models import FPRC

# %%
# ``partial_fit`` trains as ``fit`` does, and keeps what the model needs to go on learning.
train = load_hysteresis("sweep")
fprc = FPRC(random_state=1).partial_fit(train.data, train.target)

# %%
# A setting lets it learn. ``inputs`` are theta_d and P_o of a whole run.
figure, axes = plt.subplots(figsize=(6, 3), layout="constrained")
settings = Settings().model_dump()
for adapt, color in ((False, "0.6"), (True, "black")):
    settings["control"]["feedforward"]["adapt"] = adapt
    rig = Track(settings["tracking"], settings["control"], settings["rig"], seed=1)
    theta_d = rig.reference("complex")
    inputs = rig.inputs(theta_d, number=40) + np.array([0.0, 5.0])
    run = rig.simulate(theta_d, rig.feed(fprc, inputs), 40, feedback=False)
    name = "learning" if adapt else "as trained"
    print(f"{name}: tracking RMSE {tracking_rmse(run, settle_s=5.0):.2f} deg")
    axes.plot(run["time_s"], run["theta_deg"] - theta_d, color=color, lw=0.6, label=name)
axes.set(xlabel="Time [s]", ylabel="theta - theta_d [deg]", title="Open loop, simulated rig")
axes.legend()

# %%
# :doc:`/drift` says when it pays.
