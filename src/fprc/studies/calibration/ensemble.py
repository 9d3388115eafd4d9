"""Rigs around a fitted one that fit the tables too: what print leaves open about the rig."""

import logging
from collections.abc import Mapping
from typing import Any

import numpy as np
from joblib import delayed
from scipy.special import ndtr, ndtri

from fprc.config.calibration import FIRST_SEED, SEEDS_PER_FIT
from fprc.errors import EvaluationError
from fprc.experiments.data import RigSettings
from fprc.paper import REFERENCES
from fprc.studies.calibration.fit import Bench, pool_of
from fprc.studies.calibration.objective import printed_errors
from fprc.studies.calibration.space import encode, free_parameters, value_at
from fprc.studies.calibration.surrogate import judge_fully

log = logging.getLogger(__name__)

#: Largest deviations of the 12 errors of Tables II and III from print, in the median and of any.
MEDIAN, LARGEST = 0.08, 0.25

#: Standard deviation of the rigs that are drawn, in normal units of the ranges, so that a third of
#: them fit; how many are drawn at most for each that is needed; offset of their seeds from those
#: of a fit.
_SPREAD, _DRAWN, _SEEDS = 0.25, 10, 5000


def ensemble_around(
    printed: Mapping[str, Any],
    on_rig: RigSettings,
    count: int,
    calibration: Mapping[str, Any],
    *,
    workers: int,
    **how: Mapping[str, Any],
) -> dict[str, Any]:
    """Return ``count`` rigs around that of ``on_rig`` which fit the tables and have a stable loop.

    Rigs are drawn around it, each with noise of its own. Those that the full models find within
    ``MEDIAN`` and ``LARGEST``, and on which feedback helps on every reference, are kept. The
    arguments are those of ``fit.fit_rig``.

    Returns
    -------
    dict
        ``parameters``, paths of the free parameters, and ``rigs``, their values rig by rig.

    Raises
    ------
    EvaluationError
        Too few rigs fit.
    """
    free = free_parameters(calibration["free"], calibration["ranges"])
    bench = Bench(on_rig, free, how)
    first = FIRST_SEED + SEEDS_PER_FIT * calibration["seed"] + _SEEDS
    rng = np.random.default_rng(first)
    middle = ndtri(np.clip(encode(on_rig.rig, free), 0.01, 0.99))
    rigs: list[list[float]] = []
    with pool_of(workers) as pool:
        for turn in range(_DRAWN):
            shares = ndtr(middle + _SPREAD * rng.standard_normal((count, len(free))))
            found = pool(
                delayed(bench.judge)(judge_fully, share, first + turn * count + k)
                for k, share in enumerate(shares)
            )
            rigs += [
                [value_at(bench.rig_at(share).rig, parameter.path) for parameter in free]
                for share, judged in zip(shares, found, strict=True)
                if judged and fits(judged, printed)
            ]
            log.info("%d of %d rigs fit, %d are needed", len(rigs), (turn + 1) * count, count)
            if len(rigs) >= count:
                paths = [parameter.path for parameter in free]
                return {"source": "sim", "parameters": paths, "rigs": rigs[:count]}
    raise EvaluationError(f"only {len(rigs)} of {_DRAWN * count} rigs fit the tables")


def fits(judged: Mapping[str, Mapping[str, float]], printed: Mapping[str, Any]) -> bool:
    """Return whether the full models' errors on a rig fit the tables, and feedback helps."""
    wanted = printed_errors(printed)
    off = [abs(judged["errors"][key] / value - 1.0) for key, value in wanted.items()]
    helps = all(judged["closed_loop"][name] < judged["open_loop"][name] for name in REFERENCES)
    return bool(np.median(off) <= MEDIAN and max(off) <= LARGEST and helps)
