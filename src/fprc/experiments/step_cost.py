"""Computing time of a step of the closed loop."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from fprc.channels import Readings
from fprc.control import tracking_law
from fprc.control.pressure import pressure_loops
from fprc.evaluation.timing import WARM_UP, time_steps
from fprc.experiments.data import Data
from fprc.models import SequenceModel


def step_cost(
    model: SequenceModel, test: Data, control: Mapping[str, Any], pressure_limit_kpa: float
) -> dict[str, float]:
    """Time the computation between two samples of the closed loop, for each sample.

    The readings of the test log are replayed to the controller: feedforward by the
    fitted model, PD and both pressure loops, without a rig.
    """
    period_s = 1.0 / control["sample_rate_hz"]
    theta, p_exp = (test.channels[name] for name in ("theta_deg", "p_target_kpa"))
    p_o = test.channels.get("p_o_kpa", np.zeros_like(theta))
    samples = len(theta)
    readings = [
        Readings(k * period_s, p_exp[k], theta[k], 0.0, p_o[k], 0.0) for k in range(samples)
    ]
    law = tracking_law(theta, control, pressure_limit_kpa, model=model, feedback=True)
    main_loop, reservoir_loop = pressure_loops(control)

    def tick(k: int) -> None:
        now = readings[k]
        p_exp_kpa, p_i_kpa, *_ = law(k, now)
        main_loop.step(p_exp_kpa, now.p_exp_kpa)
        reservoir_loop.step(p_i_kpa, now.p_i_kpa)

    model.reset()
    time_steps(tick, min(WARM_UP, samples))
    microseconds = 1e6 * time_steps(tick, samples)
    return {
        "samples": samples,
        "median_us": float(np.median(microseconds)),
        "p99_9_us": float(np.percentile(microseconds, 99.9)),
        "max_us": float(microseconds.max()),
        "budget_us": 1e6 * period_s,
    }
