"""Worlds whose numbers are known."""

import pytest

from fprc.studies.beyond.claims import judge_world


@pytest.fixture(scope="session")
def worlds(make_world):
    """A full world, one of drawn rigs, one with the least that can be, and one that failed."""
    sparse = {"capacity": None, "training_length": None, "step_us": None}
    failed = [{"unit": 0, "seed": 601, "rig": None, "failed": "no pressure"}]
    return [
        make_world("dry", fitted=["tables", "orders", "open_loop", "C8"]),
        make_world("drawn", units=9, builds=2, spread=0.1, fitted=[]),
        make_world("sparse", units=3, models=("fprc", "fuzzy_linear"), **sparse),
        make_world("broken", cells=failed, **sparse),
    ]


@pytest.fixture(scope="session")
def ledgers(worlds):
    return [judge_world(world) for world in worlds]
