"""The hysteresis experiments as a dataset, in the form of scikit-learn's loaders."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from sklearn.utils import Bunch

from fprc.channels import TARGETS
from fprc.config import Settings, check
from fprc.errors import ConfigError
from fprc.escape import in_words
from fprc.experiments.data import select_channels
from fprc.experiments.hysteresis import RUNS, acquire
from fprc.logs import Columns, read_raw
from fprc.logs.quality import noted_unit

_DESCRIPTION = """\
Hysteresis of a soft bending actuator

Task: predict P_exp (target) from the present and earlier samples of theta and P_o (data), which are
in the order of time.

The models of the paper are trained on the sweep and tested on the complex signal, and the other
way round, with the error RMSE.

Source: Shen, Miyazaki, Kawashima, IEEE RA-L 2024, 10.1109/LRA.2024.3523229, Secs. II-B and III-D.
"""


def load_hysteresis(
    experiment: str = "sweep",
    *,
    seed: int = 1,
    rig: str | Mapping[str, Any] = "paper",
    raw: Path | str | None = None,
    target: str = "command",
) -> Any:
    """Load a hysteresis experiment: bending angle and reservoir pressure, to predict P_exp.

    It is simulated with the paper's signals and control, as ``snakemake logs`` does, unless
    ``raw`` names a log.

    Parameters
    ----------
    experiment : {"sweep", "complex"}, default="sweep"
        The paper trains on the sweep and tests on the complex signal.
    seed : int, default=1
        Seed of the simulated rig's sensors and their noise.
    rig : str or Mapping, default="paper"
        Simulated rig: its name, or numbers as in the section ``rig`` of the configuration.
    raw : path, optional
        Raw log of the experiment to read instead; ``seed`` and ``rig`` do not count then.
    target : {"command", "measured"}, default="command"
        P_exp to predict: commanded or measured pressure.

    Returns
    -------
    Bunch
        ``data`` : ndarray of shape (n_samples, 2)
            theta in deg and P_o in kPa; of shape (n_samples, 1) if the log has no P_o.
        ``target`` : ndarray of shape (n_samples,)
            P_exp in kPa.
        ``feature_names``, ``target_names`` : list of str
            Channels of ``data`` and ``target``.
        ``channels`` : dict of ndarray of shape (n_samples,)
            Every channel of the raw log.
        ``units`` : dict of str
            Unit of each channel.
        ``sample_rate_hz`` : float
            Samples per second.
        ``source`` : str
            ``sim``, ``rig`` or ``import``, as in the raw log.
        ``DESCR`` : str
            Description of the task.

    Raises
    ------
    ConfigError
        An argument is wrong.
    LogError
        The raw log cannot be used.

    References
    ----------
    Paper, Sec. II-B.
    """
    if experiment not in RUNS or target not in TARGETS:
        raise ConfigError(
            f"experiment must be {in_words(RUNS, 'or')}, and target {in_words(TARGETS, 'or')}"
        )
    if raw is None:
        settings = check({"rig": rig, "seed": seed})
        control, signal = settings.control, dict(settings.experiments)[experiment]
        arrays = acquire(experiment, signal, control, settings.rig.model_dump(), settings.seed)
        attributes = {"source": "sim", "sample_rate_hz": control.sample_rate_hz}
        log = Columns(Path(f"{experiment}, simulated"), arrays, attributes)
    else:
        tolerance = Settings().quality.rate_tolerance
        log = read_raw(raw, experiment=experiment, sample_rate_hz=None, rate_tolerance=tolerance)
    selected = select_channels(log, target)
    inputs = [name for name in ("theta_deg", "p_o_kpa") if name in log.channels]
    output = TARGETS[selected.attributes["target"]]
    data = np.column_stack([log.channels[name] for name in inputs])
    return Bunch(
        data=data,
        target=log.channels[output],
        feature_names=inputs,
        target_names=[output],
        channels=log.channels,
        units={name: noted_unit(name, log.attributes) for name in log.channels},
        sample_rate_hz=float(log.attributes["sample_rate_hz"]),
        source=log.attributes["source"],
        DESCR=_DESCRIPTION,
    )
