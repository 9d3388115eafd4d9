"""Draw rigs that are compatible with the printed errors, and judge the claims' numbers on them."""

import logging
from collections.abc import Mapping, Sequence
from functools import partial
from itertools import count
from typing import Any

import numpy as np

from fprc.artifacts import read_json, write_json
from fprc.evaluation.cells import checkpoint_key, judged_cells, judging
from fprc.experiments.settings import RigSettings
from fprc.studies.calibration.full_models import full_errors, ratios_to_full
from fprc.studies.calibration.objective import printed_errors
from fprc.studies.calibration.space import free_parameters
from fprc.studies.calibration.surrogate import judge_by_surrogate
from fprc.studies.families.ensemble import judge_drawn
from fprc.studies.families.posterior import draw_posterior, judge_member, prior_point, rig_at
from fprc.yaml_file import read_yaml

log = logging.getLogger(__name__)


def draw_members(
    published: str,
    members: str,
    *,
    posterior: Mapping[str, Any],
    ensemble: Mapping[str, Any],
    free: Mapping[str, Any],
    on_rig: Mapping[str, Any],
    judgement: Mapping[str, Any],
    surrogate: Mapping[str, int],
    workers: int,
    checkpoint: str,
    version: str,
) -> None:
    """Draw rigs from the posterior given the errors of Tables II and III.

    The points of each step follow from the seed and from what was judged before, so a run
    that was stopped can continue from its checkpoint.

    Parameters
    ----------
    posterior : Mapping
        That section of the configuration without ``chunk``.
    ensemble : Mapping
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
        "ensemble": ensemble,
        "free": free_parameters(**free),
        "on_rig": RigSettings(**on_rig),
    }
    key = checkpoint_key([posterior, ensemble, free, on_rig, judgement, surrogate, errors, version])
    log.info("judging the rig of the configuration, for the surrogate's ratios")
    own, seeds_of_ratios = settings["on_rig"], range(posterior["seed"] - 2, posterior["seed"])
    ratios = ratios_to_full(
        full_errors(own, seeds_of_ratios, workers, judgement),
        [judge_by_surrogate(own, seed, models, surrogate, {}, {}) for seed in seeds_of_ratios],
    )
    judge = partial(
        judge_member,
        **settings,
        models=models,
        surrogate=surrogate,
        ratios={name: ratios[name] for name in errors},
    )
    with judging(workers=workers, checkpoint=checkpoint, key=key) as run:
        numbers = range(posterior["seed"], posterior["seed"] + posterior["rigs"])
        drawn = run(partial(_draw, **settings), [{"draw": number} for number in numbers])
        seeds = count(posterior["seed"] + posterior["rigs"])
        seed_of: dict[bytes, int] = {}

        def simulate(points: np.ndarray) -> list[list[float] | None]:
            cells = [{"point": point.tolist(), "seed": next(seeds)} for point in points]
            for point, cell in zip(points, cells, strict=True):
                seed_of[point.tobytes()] = cell["seed"]
            judged = run(judge, cells)
            log.info(
                "%d rigs judged, %d possible", len(cells), sum("logs" in each for each in judged)
            )
            return [each.get("logs") for each in judged]

        points, logs, history = draw_posterior(
            np.array([each["point"] for each in drawn]),
            simulate,
            np.log(list(errors.values())),
            **{name: posterior[name] for name in ("tolerance", "assimilations", "sweeps", "seed")},
        )
        write_json(
            members,
            {
                "source": "sim",
                "errors": errors,
                "history": history,
                "members": [
                    {
                        "point": point.tolist(),
                        "seed": seed_of[point.tobytes()],
                        "logs": own.tolist(),
                    }
                    for point, own in zip(points, logs, strict=True)
                ],
            },
        )


def judge_members(
    members: str,
    rigs: str,
    *,
    numbers: Sequence[int],
    free: Mapping[str, Any],
    on_rig: Mapping[str, Any],
    tracking: Mapping[str, Any],
    judgement: Mapping[str, Any],
    **run: Any,
) -> None:
    """Compute Tables II to IV with the full models on some rigs of the posterior.

    Parameters
    ----------
    numbers : sequence of int
        Numbers of the rigs; those beyond the last are left out.
    judgement : Mapping
        Arguments of ``Judgement`` without the seed.
    **run
        ``checkpoint`` and ``version`` of ``judged_cells``.
    """
    drawn = read_json(members)["members"]
    cells = [drawn[number] for number in numbers if number < len(drawn)]
    with judged_cells(
        partial(
            _judge,
            free=free_parameters(**free),
            on_rig=RigSettings(**on_rig),
            tracking=tracking,
            judgement=judgement,
        ),
        cells,
        workers=1,
        settings=[free, on_rig, tracking, judgement],
        **run,
    ) as judged:
        write_json(rigs, {"source": "sim", "rigs": judged})


def _draw(cell: Mapping[str, int], **settings: Any) -> dict[str, list[float]]:
    return {"point": prior_point(cell["draw"], **settings).tolist()}


def _judge(
    cell: Mapping[str, Any], *, free: Any, on_rig: RigSettings, tracking: Any, judgement: Any
) -> dict[str, Any]:
    drawn = rig_at(cell["point"], free, on_rig)
    return judge_drawn(drawn, cell["seed"], free, tracking, judgement)
