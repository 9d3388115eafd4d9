"""Judge the paper's claims on the results, and check the verdicts."""

import logging
from collections.abc import Sequence

import pandas as pd
import yaml

from fprc.artifacts import read_json, write_json, write_text
from fprc.claims import Results, changed_verdicts, judge_claims
from fprc.errors import FprcError
from fprc.logs import read_columns
from fprc.tables import SOURCES, markdown

log = logging.getLogger(__name__)

_TRACKED = ("time_s", "theta_d_deg", "theta_deg", "p_ff_kpa", "p_fb_kpa", "p_i_kpa", "p_o_kpa",
            "phi_deg")  # fmt: skip


def write_ledger(
    published: str,
    replicates: Sequence[str],
    times: str,
    times_over_n_c: str,
    weights: str,
    sweeps: Sequence[str],
    runs: Sequence[str],
    sweep: str,
    json: str,
    md: str,
    *,
    quiet_s: float,
) -> None:
    """Write the claims ledger: published, ours, test and verdict of C1 to C18."""
    with open(published, encoding="utf-8") as file:
        printed = yaml.safe_load(file)
    logs = [read_columns(path, _TRACKED) for path in runs]
    tracked = {
        "/".join(log.attributes[key] for key in ("reference", "controller", "gain")): log.channels
        for log in logs
    }
    swept = [read_json(path) for path in sweeps]
    results = Results(
        replicates=[read_json(path) for path in replicates],
        times=read_json(times),
        times_over_n_c=read_json(times_over_n_c),
        weights=read_json(weights),
        sweeps={report["sweep"]: report for report in swept},
        runs=tracked,
        sweep=read_columns(sweep, ("time_s", "p_exp_kpa", "theta_deg", "p_o_kpa")).channels,
        settle_s=logs[0].attributes["settle_s"],
        quiet_s=quiet_s,
    )
    ledger = judge_claims(printed["claims"], results, printed)
    source = logs[0].attributes["source"]
    write_json(json, {"source": source, "claims": ledger})
    counts = pd.Series([row["verdict"] for row in ledger]).value_counts()
    note = (
        f"Claims of the paper. Data: {SOURCES[source]}. The rig was fitted to Tables II and III, "
        "to the orders of C2, C4 and C7, and to loops that change little with frequency (C18).\n"
        + ", ".join(f"{count} {verdict}" for verdict, count in counts.items())
        + "."
    )
    page = pd.DataFrame(ledger).rename(columns=str.capitalize)
    write_text(md, markdown(page, note))
    for row in ledger:
        log.info("%s: %s", row["id"], row["verdict"])


def check_verdicts(ledger: str, known: str) -> None:
    """Compare the verdicts with those that the configuration declares as known.

    Raises
    ------
    FprcError
        Lists every claim whose verdict differs.
    """
    with open(known, encoding="utf-8") as file:
        declared = yaml.safe_load(file)
    changed = changed_verdicts(read_json(ledger)["claims"], declared)
    if changed:
        lines = "\n".join(f"  {line}" for line in changed)
        raise FprcError(
            f"{len(changed)} verdicts are not those of {known}; see the ledger, and declare them "
            f"there if they are right:\n{lines}"
        )
    log.info("all %d verdicts are as declared", len(declared))
