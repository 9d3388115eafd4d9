"""What the claims are judged on, and what is found of one."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np


class Results(NamedTuple):
    """What the claims are judged on, as read from result files."""

    replicates: Sequence[Mapping[str, Any]]
    times: Mapping[str, Any]
    times_over_n_c: Mapping[str, Any]
    weights: Mapping[str, Any]
    sweeps: Mapping[str, Mapping[str, Any]]
    runs: Mapping[str, Mapping[str, np.ndarray]]  #: closed loop, by "reference/controller/gain"
    sweep: Mapping[str, np.ndarray]  #: channels of the sweep experiment
    settle_s: float
    quiet_s: float


class Finding(NamedTuple):
    """What was found of one claim."""

    published: str
    ours: str
    test: str
    holds: bool | None  #: None where the paper contradicts itself
    basis: str
