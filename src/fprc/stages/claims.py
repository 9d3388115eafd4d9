"""Judge the paper's claims on the results."""

import logging
from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from fprc.artifacts import read_json, write_json, write_text
from fprc.claims.finding import Results
from fprc.claims.ledger import fit_in_words, judge_claims
from fprc.paper import SOURCES
from fprc.tables.text import markdown
from fprc.yaml_file import read_yaml

log = logging.getLogger(__name__)


def write_ledger(
    published: str,
    replicates: Sequence[str],
    grids: Sequence[str],
    controls: Sequence[str],
    times: str,
    times_over_n_c: str,
    untested: str,
    members: str,
    claims: Sequence[str],
    *,
    fitted: Mapping[str, Any],
) -> None:
    """Write the claims ledger: the paper's numbers, ours, test and verdict.

    Parameters
    ----------
    claims : sequence of str
        JSON and Markdown of the ledger.
    untested : str
        File whose ``not_tested`` has the sentences that cannot be tested, with reasons.
    members : str
        On how many rigs of the ensemble each claim holds.
    fitted : Mapping
        Name of the rig, the terms that it was fitted to, and those that the rig at which the fit
        began was searched for.
    """
    printed = read_yaml(published)
    every = Results(
        replicates=[read_json(path) for path in replicates],
        grids=[read_json(path) for path in grids],
        controls=[read_json(path) for path in controls],
        times=read_json(times),
        times_over_n_c=read_json(times_over_n_c),
    )
    ledger = judge_claims(every, printed, fitted, members=read_json(members))
    source = every.controls[0]["source"]
    origin = (
        f"The rig {fitted['name']} was fitted to {fit_in_words(fitted)}; the other claims were not "
        "part of the fit. A verdict is undecided where the 95 % interval of the mean over noise "
        "seeds of this rig contains a limit. Rigs: on how many rigs that fit Tables II and III too "
        "the claim holds with one seed, and the middle 95 % of their numbers; what holds on all of "
        "them and no fit decides is not informative."
    )
    reasons = read_yaml(untested)["not_tested"]
    json, md = claims
    write_json(json, {"source": source, "note": origin, "claims": ledger, "not_tested": reasons})
    counts = pd.Series([row["verdict"] for row in ledger]).value_counts()
    note = (
        f"Claims of the paper. Data: {SOURCES[source]}. {origin}\n"
        + ", ".join(f"{count} {verdict}" for verdict, count in counts.items())
        + "."
    )
    page = (
        pd.DataFrame(ledger).drop(columns=["statements", "shown_in"]).rename(columns=str.capitalize)
    )
    sentences = [f"- {begins} ...: {why}" for begins, why in reasons.items()]
    closing = "Sentences of the paper that cannot be tested here:\n\n" + "\n".join(sentences)
    write_text(md, f"{markdown(page, note)}\n{closing}\n")
    for row in ledger:
        log.info("%s: %s", row["id"], row["verdict"])
