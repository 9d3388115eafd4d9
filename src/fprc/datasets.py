"""Hysteresis of a soft bending actuator, simulated.

Task: predict P_exp (target) from the present and earlier samples of theta and P_o (data), which are
in the order of time. The paper's models are trained on the sweep and tested on the complex signal,
and the other way round, with the error RMSE: Shen, Miyazaki, Kawashima, IEEE RA-L 2024,
10.1109/LRA.2024.3523229, Secs. II-B and III-D.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from sklearn.utils import Bunch

from fprc.channels import unit_of
from fprc.config import check
from fprc.errors import ConfigError
from fprc.escape import in_words
from fprc.experiments.data import RUNS, acquire


def load_hysteresis(
    experiment: str = "sweep", *, seed: int = 1, rig: str | Mapping[str, Any] = "paper"
) -> Any:
    """Load a hysteresis experiment: bending angle and reservoir pressure, to predict P_exp.

    It is simulated with the paper's signals and control (Sec. II-B), as ``snakemake logs`` does, in
    the form of scikit-learn's loaders.

    Parameters
    ----------
    experiment : {"sweep", "complex"}, default="sweep"
        The paper trains on the sweep and tests on the complex signal.
    seed : int, default=1
        Seed of the simulated rig's sensors and their noise.
    rig : str or Mapping, default="paper"
        Simulated rig: its name, or numbers as in the section ``rig`` of the configuration.

    Returns
    -------
    Bunch
        ``data`` of shape (n_samples, 2), theta in deg and P_o in kPa; ``target`` of shape
        (n_samples,), the commanded P_exp in kPa; their ``feature_names`` and ``target_names``;
        ``channels`` and ``units`` of the raw log by name; ``sample_rate_hz``, and ``DESCR``.

    Raises
    ------
    ConfigError
        An argument is wrong.
    """
    if experiment not in RUNS:
        raise ConfigError(f"experiment = {experiment!r}; must be {in_words(RUNS, 'or')}")
    settings = check({"rig": rig, "seed": seed})
    control, signal = settings.control, dict(settings.experiments)[experiment]
    channels = acquire(experiment, signal, control, settings.rig.model_dump(), settings.seed)
    inputs, output = ["theta_deg", "p_o_kpa"], "p_exp_command_kpa"
    return Bunch(
        data=np.column_stack([channels[name] for name in inputs]),
        target=channels[output],
        feature_names=inputs,
        target_names=[output],
        channels=channels,
        units={name: unit_of(name) for name in channels},
        sample_rate_hz=control.sample_rate_hz,
        DESCR=__doc__,
    )
