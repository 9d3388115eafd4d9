"""Judge the paper's claims on the results."""

import logging
from collections.abc import Sequence

import pandas as pd

from fprc.artifacts import read_json, write_json, write_text
from fprc.claims import Results, judge_claims
from fprc.paper import SOURCES
from fprc.tables import markdown
from fprc.yaml_file import read_yaml

log = logging.getLogger(__name__)

#: Claims whose numbers or order the rig was fitted to; execution times do not depend on the rig.
_FITTED = ("C1", "C2", "C3", "C4", "C7", "C18")
_TIMED = ("C5", "C6", "C10")

#: The simulated rig assumes, as the paper does, that the reservoir's bending hardly changes P_o.
_ASSUMED = ("C17",)

_NOTE = (
    "The simulated rig was fitted to Tables II and III, to the order of the models in them and to "
    "loops that change little with frequency; the other claims were no part of the fit."
)


def _rig(claim: str) -> str:
    if claim in _TIMED:
        return "timed"
    if claim in _ASSUMED:
        return "assumed"
    return "fitted" if claim in _FITTED else "predicted"


def write_ledger(
    published: str,
    replicates: Sequence[str],
    grids: Sequence[str],
    controls: Sequence[str],
    times: str,
    times_over_n_c: str,
    json: str,
    md: str,
) -> None:
    """Write the claims ledger: published, ours, test and verdict of C1 to C18."""
    printed = read_yaml(published)
    results = Results(
        replicates=[read_json(path) for path in replicates],
        grids=[read_json(path) for path in grids],
        controls=[read_json(path) for path in controls],
        times=read_json(times),
        times_over_n_c=read_json(times_over_n_c),
    )
    ledger = [
        {**row, "rig": _rig(row["id"])} for row in judge_claims(printed["claims"], results, printed)
    ]
    source = results.controls[0]["source"]
    write_json(json, {"source": source, "note": _NOTE, "claims": ledger})
    counts = pd.Series([row["verdict"] for row in ledger]).value_counts()
    note = (
        f"Claims of the paper. Data: {SOURCES[source]}. {_NOTE}\n"
        + ", ".join(f"{count} {verdict}" for verdict, count in counts.items())
        + "."
    )
    page = pd.DataFrame(ledger).rename(columns=str.capitalize)
    write_text(md, markdown(page, note))
    for row in ledger:
        log.info("%s: %s", row["id"], row["verdict"])
