"""Judge the paper's claims on the results."""

import logging
from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from fprc.artifacts import read_json, write_csv, write_json
from fprc.claims import MEMBERS, TEXTS
from fprc.claims.claim import Results
from fprc.claims.ledger import fit_in_words, judge_claims
from fprc.config import PUBLISHED
from fprc.yaml_file import read_yaml

log = logging.getLogger(__name__)


def write_ledger(
    replicates: Sequence[str],
    grids: Sequence[str],
    controls: Sequence[str],
    times: str,
    times_over_n_c: str,
    claims: Sequence[str],
    *,
    fitted: Mapping[str, Any],
) -> None:
    """Write the claims ledger: the paper's numbers, ours, test and verdict, as JSON and as CSV.

    ``fitted`` has the name of the rig, the terms that it was fitted to, and those that the rig at
    which the fit began was searched for.
    """
    of_seeds = ([read_json(path) for path in paths] for paths in (replicates, grids, controls))
    results = Results._make([*of_seeds, read_json(times), read_json(times_over_n_c)])
    members = read_json(MEMBERS)
    ledger = judge_claims(results, read_yaml(PUBLISHED), fitted, members=members)
    origin = (
        f"The rig {fitted['name']} was fitted to {fit_in_words(fitted)}; the other claims were not "
        "part of the fit. A verdict is undecided where the 95 % interval of the mean over noise "
        "seeds of this rig contains a limit. Rigs: on how many rigs that fit Tables II and III too "
        "the claim holds with one seed, and the middle 95 % of their numbers; what holds on all of "
        "them and no fit decides is not informative."
    )
    json, csv = claims
    source, reasons = results.controls[0]["source"], read_yaml(TEXTS)["not_tested"]
    write_json(json, {"source": source, "note": origin, "claims": ledger, "not_tested": reasons})
    write_csv(csv, pd.DataFrame(ledger).drop(columns=["statements", "shown_in"]))
    for row in ledger:
        log.info("%s: %s", row["id"], row["verdict"])
