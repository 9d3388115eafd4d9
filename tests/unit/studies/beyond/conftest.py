"""Families whose numbers are known."""

import pandas as pd
import pytest

from fprc.studies.beyond.claims import CLAIMS, numbers_of
from fprc.studies.beyond.verdicts import judge_family


@pytest.fixture(scope="session")
def families(make_family):
    """A full family, one of drawn rigs, one with the least that can be, and one that failed."""
    failed = [{"unit": 0, "seed": 601, "failed": "no pressure"}]
    return [
        make_family("dry", fitted=["tables", "orders", "open_loop", "C8"]),
        make_family("drawn", units=9, repeats=2, spread=0.1, fitted=[]),
        make_family("sparse", units=3, models=("fprc", "fuzzy_linear")),
        make_family("broken", cells=failed),
    ]


@pytest.fixture(scope="session")
def judge_claims():
    """Return what judges the claims in several families."""

    def judge(*families):
        judged = [judge_family(family, CLAIMS, numbers_of(family)) for family in families]
        return pd.concat(judged, ignore_index=True)

    return judge


@pytest.fixture(scope="session")
def verdicts(families, judge_claims):
    return judge_claims(*families)
