"""Families whose numbers are known."""

import pytest

from fprc.studies.beyond.claims import judge_family


@pytest.fixture(scope="session")
def families(make_family):
    """A full family, one of drawn rigs, one with the least that can be, and one that failed."""
    sparse = {"capacity": [], "step_us": {}}
    failed = [{"unit": 0, "seed": 601, "failed": "no pressure"}]
    return [
        make_family("dry", fitted=["tables", "orders", "open_loop", "C8"]),
        make_family("drawn", units=9, repeats=2, spread=0.1, fitted=[]),
        make_family("sparse", units=3, models=("fprc", "fuzzy_linear"), **sparse),
        make_family("broken", cells=failed, **sparse),
    ]


@pytest.fixture(scope="session")
def ledgers(families):
    return [judge_family(family) for family in families]
