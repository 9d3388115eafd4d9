"""Rigs around a fitted one that fit the tables too: what print leaves open about the rig."""

import logging
from collections.abc import Mapping
from typing import Any

import numpy as np
from joblib import delayed
from scipy.special import ndtr, ndtri

from fprc.config.calibration import FIRST_SEED, SEEDS_PER_FIT
from fprc.errors import EvaluationError
from fprc.experiments.settings import RigSettings
from fprc.paper import REFERENCES
from fprc.studies.calibration.fit import Bench, pool_of, smoothed
from fprc.studies.calibration.objective import printed_errors, targets
from fprc.studies.calibration.space import encode, free_parameters, value_at

log = logging.getLogger(__name__)

#: Largest deviations of the 12 errors of Tables II and III from print, in the median and of any.
MEDIAN, LARGEST = 0.08, 0.25

#: Standard deviation of the rigs that are drawn, in normal units of the ranges; how many turns of
#: the smoother follow; offset of their seeds from those of a fit.
_SPREAD, _TURNS, _SEEDS = 0.35, 2, 5000


def ensemble_around(
    on_rig: RigSettings,
    count: int,
    printed: Mapping[str, Any],
    judgement: Mapping[str, Any],
    calibration: Mapping[str, Any],
    tracking: Mapping[str, Any],
    *,
    workers: int,
) -> dict[str, Any]:
    """Return ``count`` rigs around that of ``on_rig`` which fit the tables and have a stable loop.

    Rigs are drawn around it and moved towards print by the smoother, each with noise of its own.
    Those that the full models find within ``MEDIAN`` and ``LARGEST``, and on which feedback helps
    on every reference with the printed gains and with 1.5 times these, are kept.

    Returns
    -------
    dict
        ``parameters``, paths of the free parameters, and ``rigs``, their values rig by rig.

    Raises
    ------
    EvaluationError
        Fewer rigs fit.
    """
    free = free_parameters(calibration["free"], calibration["ranges"])
    bench = Bench(on_rig, free, judgement, tracking)
    of = targets(printed, calibration["fit"])
    first = FIRST_SEED + SEEDS_PER_FIT * calibration["seed"] + _SEEDS
    rng = np.random.default_rng(first)
    middle = ndtri(np.clip(encode(on_rig.rig, free), 0.01, 0.99))
    points = middle + _SPREAD * rng.standard_normal((calibration["members"], len(free)))
    rigs: list[list[float]] = []
    with pool_of(workers) as pool:
        shares = ndtr(smoothed(bench, of, points, _TURNS, first, pool))
        for at in range(0, len(shares), count):
            part = shares[at : at + count]
            found = pool(
                delayed(bench.fully)(share, first + 3000 + at + k) for k, share in enumerate(part)
            )
            rigs += [
                [value_at(bench.rig_at(share).rig, parameter.path) for parameter in free]
                for share, judged in zip(part, found, strict=True)
                if fits(judged, printed)
            ]
            log.info("%d of %d rigs fit, %d are needed", len(rigs), at + len(part), count)
            if len(rigs) >= count:
                paths = [parameter.path for parameter in free]
                return {"source": "sim", "parameters": paths, "rigs": rigs[:count]}
    raise EvaluationError(
        f"only {len(rigs)} of {len(shares)} rigs fit the tables; raise calibration.members"
    )


def fits(judged: Mapping[str, Mapping[str, float]], printed: Mapping[str, Any]) -> bool:
    """Return whether the full models' errors on a rig fit the tables, and feedback helps."""
    wanted = printed_errors(printed)
    off = [abs(judged["errors"][key] / value - 1.0) for key, value in wanted.items()]
    helps = all(
        judged[loop][name] < judged["open_loop"][name]
        for loop in ("closed_loop", "firm_loop")
        for name in REFERENCES
    )
    return bool(np.median(off) <= MEDIAN and max(off) <= LARGEST and helps)
