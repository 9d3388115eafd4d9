"""
P_o drifts
==========

The same model twice on the same rig, whose sealed chamber reads 5 kPa more than in the training:
once as it was trained, once learning while it runs.
"""

import numpy as np

from fprc.channels import LEARNING_CHANNELS, TRACKING_CHANNELS
from fprc.config import check
from fprc.control import run, tracking_law
from fprc.datasets import load_hysteresis
from fprc.devices.sim import SimulatedRig
from fprc.evaluation import rmse
from fprc.figures import style
from fprc.models import FPRC, Learning, Online
from fprc.signals import multisine

# %%
# ``remember`` keeps what the model needs to go on learning.
train = load_hysteresis("sweep")
fprc = FPRC(random_state=1).fit(train.data, train.target).remember(train.data)
settings = check({"rig": "paper", "control": {"feedforward": {"p_o_shift_kpa": 5.0}}})
period_s = 0.005
time_s = np.arange(12000) * period_s
theta_d = multisine(time_s, f_hz=[0.12, 0.04, 0.31, 0.29, 0.25], amplitude=6.5, offset=40.5)


# %%
# ``Online`` learns from the tracking error. The law calls it at each sample.
def track(learns):
    fprc.reset((theta_d[0], train.data[0, 1]))
    online = Online(fprc, Learning(), period_s, pressure_limit_kpa=450.0) if learns else None
    law = tracking_law(theta_d, settings.control, 450.0, model=fprc, online=online)
    rig = SimulatedRig(settings.rig.model_dump(), seed=1, run=40, sample_rate_hz=1.0 / period_s)
    extra = TRACKING_CHANNELS + LEARNING_CHANNELS * learns
    return run(rig, rig, law, len(theta_d), settings.control, extra=extra)["theta_deg"]


# %%
figure, axes = style.figure(1, 1, style.COLUMN_IN, 2.4)
for name, learns, grey in (("as trained", False, "0.65"), ("learning", True, "0.1")):
    theta = track(learns)
    print(f"{name}: tracking RMSE {rmse(theta_d[1000:], theta[1000:]):.2f} deg")
    axes.plot(time_s, theta - theta_d, color=grey, label=name)
axes.set(xlabel="Time [s]", ylabel="Error of the angle [deg]", xlim=(5, None))
axes.set_title("Without feedback, simulated rig")
style.legend_above(axes)

# %%
# :doc:`/drift` says when it pays.
