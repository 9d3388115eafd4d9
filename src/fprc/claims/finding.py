"""What the claims are judged on, and what is found of one."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

#: A number as close as this to its limit is at the limit.
ROUNDING = 1e-9


class Results(NamedTuple):
    """What the claims are judged on, as read from result files; one entry a further seed."""

    replicates: Sequence[Mapping[str, Any]]  #: errors of the models, and weights
    grids: Sequence[Mapping[str, Any]]  #: cells of the grids, by their name
    controls: Sequence[Mapping[str, Any]]  #: what ``measures`` found
    times: Mapping[str, Any]
    times_over_n_c: Mapping[str, Any]


class Finding(NamedTuple):
    """What was found of one claim."""

    published: str
    ours: str
    test: str
    holds: bool | None  #: None where the paper contradicts itself
    basis: str


def over_seeds(reports: Sequence[Mapping[str, Any]]) -> str:
    """Say how many seeds a number stands for."""
    return "one seed" if len(reports) == 1 else f"mean ± deviation over {len(reports)} seeds"


def pm(values: np.ndarray) -> str:
    """Format mean and sample standard deviation, which a single value has not."""
    if np.size(values) == 1:
        return f"{np.mean(values):.3g}"
    return f"{np.mean(values):.3g} ± {np.std(values, ddof=1):.2g}"
