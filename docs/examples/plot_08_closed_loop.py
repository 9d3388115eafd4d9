"""
Close the loop
==============

Follow a sine with the PD controller alone, with FPRC as the feedforward, and with both. The same
``run`` drives the simulated rig and a real one.
"""

import numpy as np

from fprc.channels import TRACKING_CHANNELS
from fprc.config import check
from fprc.control import run, tracking_law
from fprc.datasets import load_hysteresis
from fprc.devices.sim import SimulatedRig
from fprc.evaluation import rmse
from fprc.figures import style
from fprc.models import FPRC
from fprc.signals import multisine

train = load_hysteresis("sweep")
fprc = FPRC(random_state=1).fit(train.data, train.target)
settings = check({"rig": "paper"})
control, period_s, limit_kpa = settings.control, 0.005, 450.0

# %%
# A law returns the setpoints of both chambers at each sample. The reference begins with 5 s at its
# lowest angle.
time_s = np.arange(9000) * period_s
theta_d = multisine((time_s - 5.0).clip(0.0), f_hz=[0.5], amplitude=27.5, offset=32.5)


def follow(with_fprc, with_pd):
    fprc.reset((theta_d[0], train.data[0, 1]))
    model = fprc if with_fprc else None
    law = tracking_law(theta_d, control, limit_kpa, model=model, feedback=with_pd)
    rig = SimulatedRig(settings.rig.model_dump(), seed=1, run=20, sample_rate_hz=1.0 / period_s)
    return run(rig, rig, law, len(theta_d), control, extra=TRACKING_CHANNELS)


# %%
figure, axes = style.figure(1, 1, style.COLUMN_IN, 2.4)
axes.plot(time_s, theta_d, color=style.SIGNALS["theta_d"], label="theta_d")
for name, *given in (("pd", False, True), ("fprc", True, False), ("fprc_pd", True, True)):
    theta = follow(*given)["theta_deg"]
    print(f"{name}: {rmse(theta_d[1000:], theta[1000:]):.2f} deg")
    axes.plot(time_s, theta, label=name, **style.line_of(name))
axes.set(xlabel="Time [s]", ylabel="Angle [deg]", xlim=(10, 18))
axes.set_title("Simulated rig")
style.legend_above(axes)
