"""Input and outcome of the claims' tests."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

#: A number within this distance of its limit counts as equal to it.
ROUNDING = 1e-9


class Results(NamedTuple):
    """Numbers that the claims are judged on, from result files; sequences have one per seed."""

    replicates: Sequence[Mapping[str, Any]]  #: errors of the models, and weights
    grids: Sequence[Mapping[str, Any]]  #: cells of the grids, by their name
    controls: Sequence[Mapping[str, Any]]  #: numbers of ``experiments.measures``
    times: Mapping[str, Any]
    times_over_n_c: Mapping[str, Any]


class Finding(NamedTuple):
    """Outcome of one claim's test."""

    published: str
    ours: str
    test: str
    holds: bool | None  #: None where the paper contradicts itself
    basis: str


def over_seeds(reports: Sequence[Mapping[str, Any]]) -> str:
    """Describe the seeds that a number is taken over."""
    return "one seed" if len(reports) == 1 else f"mean ± deviation over {len(reports)} seeds"


def pm(values: np.ndarray) -> str:
    """Format mean and sample standard deviation; of a single value only the mean."""
    if np.size(values) == 1:
        return f"{np.mean(values):.3g}"
    return f"{np.mean(values):.3g} ± {np.std(values, ddof=1):.2g}"
