"""
What a reservoir remembers
==========================

Memory and capacity of any state, for an input that need not be independent: an echo state network
on random numbers, and the sealed chamber of the simulated rig on a sweep.
"""

import numpy as np

import fprc
from fprc.datasets import load_hysteresis
from fprc.figures import style
from fprc.models import EchoStates, LowpassBank

# %%
# Of independent uniform numbers, the capacity of degree 1 is the memory capacity.
u = np.random.default_rng(1).uniform(-1.0, 1.0, 10_000)
echo = EchoStates(r=50, f_input=0.2, gamma=0.0, rho=0.9, n_y=1, random_state=1)
network = fprc.capacity(echo.fit_transform(u[:, None])[:, 1:], u, lags=60)
print("of degree 1, 2, 3:", network.degrees.round(2), "of", network.rank, "states")

# %%
# The chamber on the sweep, at 50 samples a second, beside as many low-passes of the angle. Its
# input is correlated: such numbers compare states on one input.
log = load_hysteresis("sweep").channels
theta, p_o = (log[name].reshape(-1, 4).mean(axis=1) for name in ("theta_deg", "p_o_kpa"))
states = LowpassBank([1.0, 0.13, 0.04, 0.012])
of_each = {
    name: fprc.capacity(states.fit_transform(x[:, None]), theta, rate_hz=50.0, spacing=5, taps=5)
    for name, x in (("P$_o$", p_o), ("θ", theta))
}
for name, found in of_each.items():
    print(name, found.degrees.round(3), f"memory {found.memory_s:.2f} s")

# %%
figure, axes = style.figure(1, 1, style.COLUMN_IN, 2.2)
for (name, found), colour in zip(of_each.items(), ("0.15", "0.65"), strict=True):
    axes.plot(found.lags_s, found.memory, color=colour, label=f"{name} and its low-passes")
axes.set(xlabel="Lag [s]", ylabel="Share of past θ added")
axes.legend()
