"""Judge an ensemble of random rigs, and measure the sensitivity of one rig."""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from fprc.artifacts import write_json
from fprc.evaluation.cells import judged_cells
from fprc.experiments.settings import RigSettings
from fprc.studies.calibration.space import free_parameters
from fprc.studies.families.ensemble import judge_moved, judge_rig


def judge_rigs(
    rigs: str,
    *,
    numbers: Sequence[int],
    ensemble: Mapping[str, Any],
    free: Mapping[str, Any],
    on_rig: Mapping[str, Any],
    tracking: Mapping[str, Any],
    judgement: Mapping[str, Any],
    **run: Any,
) -> None:
    """Compute Tables II to IV on some rigs of the ensemble.

    Parameters
    ----------
    numbers : sequence of int
        Numbers of the rigs; a rig does not depend on the chunk that it is in.
    free : Mapping
        Arguments of ``free_parameters``: ``paths`` and ``ranges``.
    on_rig : Mapping
        Arguments of ``RigSettings``.
    judgement : Mapping
        Arguments of ``Judgement`` without the seed.
    **run
        ``checkpoint`` and ``version`` of ``judged_cells``.
    """
    with judged_cells(
        partial(
            judge_rig,
            ensemble=ensemble,
            free=free_parameters(**free),
            on_rig=RigSettings(**on_rig),
            tracking=tracking,
            judgement=judgement,
        ),
        [{"rig": number} for number in numbers],
        workers=1,
        settings=[ensemble, free, on_rig, tracking, judgement],
        **run,
    ) as judged:
        write_json(rigs, {"source": "sim", "rigs": judged})


def measure_sensitivity(
    effects: str,
    *,
    paths: Sequence[str],
    steps: int,
    seeds: Sequence[int],
    surrogate: Mapping[str, int],
    on_rig: Mapping[str, Any],
    models: Mapping[str, Any],
    **run: Any,
) -> None:
    """Move one parameter at a time over its range, and judge the rig with the surrogate models.

    Parameters
    ----------
    on_rig : Mapping
        Arguments of ``RigSettings``.
    **run
        Those of ``judge_rigs``, and ``workers``.
    """
    shares = np.linspace(0.0, 1.0, steps).tolist()
    cells = [{"path": path, "share": share} for path in paths for share in shares]
    with judged_cells(
        partial(
            judge_moved,
            seeds=seeds,
            surrogate=surrogate,
            on_rig=RigSettings(**on_rig),
            models=models,
        ),
        [{"path": None, "share": None}, *cells],
        settings=[seeds, surrogate, on_rig, models],
        **run,
    ) as judged:
        write_json(effects, {"source": "sim", "seeds": list(seeds), "cells": judged})
