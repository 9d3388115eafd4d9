"""Claims that can be judged on one recording of a rig, and how often they hold in a family."""

from typing import Any

import numpy as np
from scipy.stats import binomtest

from fprc.claims import numbers
from fprc.claims.finding import Results, Statement
from fprc.claims.paper import ASSUMED, CLAIMS, Claim
from fprc.claims.statements import Printed
from fprc.signals import LEVEL


def _worth(results: Results, printed: Printed) -> list[Statement]:
    errors = [report["filter_alone"]["test_rmse_kpa"] for report in results.replicates]
    ratio = numbers.error(results, "sweep", "fprc", "test") / np.array(list(map(np.mean, errors)))
    return [Statement("FPRC / FPRC on low-passed theta_d, test", ratio, high=1.0)]


#: B1 on one rig: what P_o is worth there.
WORTH = Claim("B1", "P_o beats low-passed theta_d, forward", "-", _worth)

#: Claims that Tables II to IV, weights and loops decide; the others need grids or times, or are
#: assumed.
JUDGED_BY_RIG = (
    *(claim for claim in CLAIMS if claim.over == "seeds" and claim.kind != ASSUMED), WORTH,
)  # fmt: skip


def share_of(held: np.ndarray) -> dict[str, Any]:
    """Return on how many rigs something holds, their number, the share and its Wilson interval."""
    holds = int(held.sum())
    interval = binomtest(holds, held.size).proportion_ci(LEVEL, method="wilson")
    return {
        "holds": holds,
        "rigs": held.size,
        "share": holds / held.size,
        "low": float(interval.low),
        "high": float(interval.high),
    }
