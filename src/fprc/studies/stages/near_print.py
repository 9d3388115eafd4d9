"""Find rigs near print."""

import logging
from collections.abc import Mapping
from functools import partial
from itertools import count
from typing import Any

import numpy as np

from fprc.artifacts import write_json
from fprc.evaluation.cells import checkpoint_key, judging
from fprc.experiments.settings import RigSettings
from fprc.studies.calibration.full_models import judge_fully, ratios_to_full
from fprc.studies.calibration.objective import printed_errors
from fprc.studies.calibration.space import free_parameters
from fprc.studies.calibration.surrogate import judge_by_surrogate
from fprc.studies.families.near_print import draw_member, judge_member, move_near, rig_at
from fprc.yaml_file import read_yaml

log = logging.getLogger(__name__)


def find_near_print(
    published: str,
    rigs: str,
    *,
    near_print: Mapping[str, Any],
    drawn: Mapping[str, Any],
    free: Mapping[str, Any],
    on_rig: Mapping[str, Any],
    judgement: Mapping[str, Any],
    surrogate: Mapping[str, int],
    workers: int,
    checkpoint: str,
    version: str,
) -> None:
    """Find rigs whose errors are near those of Tables II and III, and keep some of them.

    The points of each step follow from the seed and from what was judged before, so a run
    that was stopped can continue from its checkpoint.

    Parameters
    ----------
    near_print : Mapping
        That section of the configuration.
    drawn : Mapping
        Plausible ranges: ``angle_deg`` and ``p_o_swing_kpa``.
    free : Mapping
        Arguments of ``free_parameters``: ``paths`` and ``ranges``.
    on_rig : Mapping
        Arguments of ``RigSettings``; its rig gives the parameters that are not free.
    judgement : Mapping
        Arguments of ``Judgement`` without the seed.
    """
    errors = printed_errors(read_yaml(published))
    models = judgement["models"]
    settings: dict[str, Any] = {
        "drawn": drawn,
        "free": free_parameters(**free),
        "on_rig": RigSettings(**on_rig),
    }
    key = checkpoint_key([near_print, drawn, free, on_rig, judgement, surrogate, errors, version])
    log.info("judging the rig of the configuration, for the surrogate's ratios")
    start, seeds_of_ratios = settings["on_rig"], range(near_print["seed"] - 2, near_print["seed"])
    ratios = ratios_to_full(
        judge_fully(start, seeds_of_ratios, workers, judgement, tracking={}, measures=()),
        [judge_by_surrogate(start, seed, models, surrogate, {}, {}) for seed in seeds_of_ratios],
    )["errors"]
    judge = partial(
        judge_member,
        **settings,
        models=models,
        surrogate=surrogate,
        ratios={name: ratios[name] for name in errors},
    )
    with judging(workers=workers, checkpoint=checkpoint, key=key) as run:
        numbers = range(near_print["seed"], near_print["seed"] + near_print["rigs"])
        prior = run(partial(draw_member, **settings), [{"draw": number} for number in numbers])
        seeds = count(near_print["seed"] + near_print["rigs"])

        def simulate(points: np.ndarray) -> list[list[float] | None]:
            cells = [{"point": point.tolist(), "seed": next(seeds)} for point in points]
            judged = run(judge, cells)
            log.info(
                "%d rigs judged, %d possible", len(cells), sum("logs" in rig for rig in judged)
            )
            return [rig.get("logs") for rig in judged]

        points = move_near(
            np.array([rig["point"] for rig in prior]),
            simulate,
            np.log(list(errors.values())),
            **{name: near_print[name] for name in ("tolerance", "assimilations", "sweeps", "seed")},
        )
        write_json(
            rigs,
            {
                "source": "sim",
                "rigs": [
                    rig_at(point, settings["free"], settings["on_rig"]).rig
                    for point in points[: near_print["keep"]]
                ],
            },
        )
