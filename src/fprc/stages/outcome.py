"""What a run of the workflow has shown, in a line."""

from pathlib import Path

import pandas as pd

from fprc.artifacts import read_json
from fprc.claims.paper import TIMED
from fprc.tables.against_paper import against_paper


def outcome(results: str) -> str:
    """Return how many claims are reproduced, how far the tables deviate, and what to open.

    Parameters
    ----------
    results : str
        Folder of the results.
    """
    parts = [f"open {Path(results, 'report.html')}"]
    tables = [Path(results, f"tables/table{number}_seeds.csv") for number in (2, 3)]
    if all(path.exists() for path in tables):
        off = against_paper({path.stem: pd.read_csv(path) for path in tables})["ratio"] - 1.0
        parts.insert(0, f"median deviation of Tables II and III {100 * off.abs().median():.0f} %")
    ledger = Path(results, "claims.json")
    if ledger.exists():
        # without those on execution times, as in README.md: they vary from run to run
        claims = read_json(str(ledger))["claims"]
        verdicts = [claim["verdict"] for claim in claims if claim["rig"] != TIMED]
        parts.insert(0, f"{verdicts.count('reproduced')} of {len(verdicts)} claims reproduced")
    return "; ".join(parts)
