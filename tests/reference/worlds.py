"""Six made worlds, in which it is known whether P_o helps.

A pressure moves an arm with backlash; the angle and P_o are measured with noise. What P_o is
differs:

- repeating: a sine that touches nothing and has the period of a motion that repeats;
- unrelated: a slow random signal that touches nothing;
- copy: the angle once more, with noise of its own;
- memory: a chamber that fills with the square of the angle in 12 s, and pushes back;
- disturbance: a random load, which moves the arm too;
- noise: nothing else.

``python -m tests.reference.worlds 20`` answers 20 of each, and prints how often each answer came.
"""

import sys
from collections import Counter

import numpy as np
from joblib import Parallel, delayed

from fprc.config import Settings
from fprc.evaluation.sides import Recordings
from fprc.recordings.answer import answer_recordings

#: World: right answers. Where the motion repeats, not to decide is right too.
WORLDS = {
    "repeating": ("No", "Not decided"),
    "unrelated": ("No",),
    "copy": ("No",),
    "memory": ("Yes",),
    "disturbance": ("Yes",),
    "noise": ("No",),
}


def slow(rng, size, rate_hz, highest_hz):
    """Return a random signal below a frequency, of variance 1."""
    f_hz = np.fft.rfftfreq(size, 1.0 / rate_hz)
    power = (f_hz > 0.0) * np.exp(-((f_hz / highest_hz) ** 2))
    phases = rng.standard_normal(f_hz.size) + 1j * rng.standard_normal(f_hz.size)
    signal = np.fft.irfft(np.sqrt(power) * phases, size)
    return (signal - signal.mean()) / signal.std()


def play(x, half_width):
    """Return backlash of a signal."""
    y, state = np.empty_like(x), x[0]
    for k, u in enumerate(x):
        y[k] = state = max(u - half_width, min(u + half_width, state))
    return y


def world(name, seed, *, duration_s=180.0, rate_hz=50.0):
    """Return theta [deg], P_o [kPa] and P_exp [kPa] of a world."""
    rng = np.random.default_rng([seed, list(WORLDS).index(name)])
    size = round(duration_s * rate_hz)
    t = np.arange(size) / rate_hz
    p = 150.0 + 50.0 * slow(rng, size, rate_hz, 0.5)
    if name == "repeating":
        phase = 2.0 * np.pi * t / 15.0
        parts = zip(
            (1, 2, 3, 5, 7), (25, 20, 15, 10, 8), rng.uniform(0.0, 2 * np.pi, 5), strict=True
        )
        p = 150.0 + sum(size * np.sin(k * phase + shift) for k, size, shift in parts)
    load = 15.0 * slow(rng, size, rate_hz, 0.3) if name == "disturbance" else np.zeros(size)
    theta = 0.3 * play(p - load, 15.0) + 0.05 * p
    theta += 0.05 * rng.standard_normal(size)
    p_o = 5.0 * slow(rng, size, rate_hz, 0.5)
    if name == "repeating":
        p_o = 10.0 * np.sin(phase) + 5.0 * np.cos(2.0 * phase + 1.0)
    elif name == "copy":
        p_o = theta.copy()
    elif name == "memory":
        filled = np.empty(size)
        state = np.mean(theta**2)
        for k, u in enumerate(theta**2):
            state += (u - state) / (12.0 * rate_hz)
            filled[k] = state
        p_o = 0.01 * filled
        p = p + 3.0 * (p_o - p_o.mean())
    elif name == "disturbance":
        p_o = 0.5 * load
    elif name == "noise":
        p_o = np.zeros(size)
    noise = 0.1 if name != "noise" else 5.0
    return theta, 100.0 + p_o + noise * rng.standard_normal(size), p


def verdict(name, seed, *, recorded_hz=50.0, each=1):
    """Return the answer to a world, of which only each so many samples are given."""
    theta, p_o, target = (x[::each] for x in world(name, seed, rate_hz=recorded_hz))
    recordings = Recordings(theta, p_o, target, [len(theta)], recorded_hz / each)
    models = Settings().model_dump(mode="json")["models"]
    return answer_recordings(recordings, models, seed)["verdict"]


if __name__ == "__main__":
    seeds = int(sys.argv[1])
    for name, right in WORLDS.items():
        given = Counter(Parallel(2)(delayed(verdict)(name, seed) for seed in range(seeds)))
        print(f"{name}: {sum(given[answer] for answer in right)} of {seeds} right, {dict(given)}")
