"""Plausible measurements of a rig, without a simulation."""

import numpy as np

RATE_HZ = 200.0


def hysteresis(samples: int = 400) -> dict[str, np.ndarray]:
    """Return every channel of a raw log that passes all quality checks."""
    rng = np.random.default_rng(7)
    time_s = np.arange(samples) / RATE_HZ
    p_exp = 175.0 - 120.0 * np.cos(2.0 * np.pi * 0.9 * time_s)
    theta = 60.0 * (p_exp / 350.0) ** 1.2 + 3.0 * np.sin(2.0 * np.pi * 0.9 * time_s)
    p_i = 7.0 * theta
    exact = {
        "p_exp_command_kpa": p_exp,
        "p_exp_kpa": p_exp,
        "theta_deg": theta,
        "p_i_command_kpa": p_i,
        "p_i_kpa": p_i,
        "p_o_kpa": 110.0 + 0.15 * p_i + time_s / 60.0,
        "phi_deg": 0.5 * theta,
        "valve_main_v": 5.0 + np.gradient(p_exp) / 4.0,
        "valve_reservoir_v": 5.0 + np.gradient(p_i) / 4.0,
    }
    noisy = {
        name: values if "command" in name else values + 1e-3 * rng.standard_normal(samples)
        for name, values in exact.items()
    }
    return {"time_s": time_s, **noisy}


def tracking(samples: int = 400) -> dict[str, np.ndarray]:
    """Return the channels of a closed-loop run."""
    channels = hysteresis(samples)
    p_ff = 0.9 * channels["p_exp_command_kpa"]
    return channels | {
        "theta_d_deg": channels["theta_deg"] + 1.0,
        "p_ff_kpa": p_ff,
        "p_fb_kpa": channels["p_exp_command_kpa"] - p_ff,
    }
