"""Each sentence and each number of the paper has a row that says what tests it."""

import re
from pathlib import Path

import yaml

from fprc.claims import TEXTS
from fprc.claims.paper import CLAIMS
from fprc.config import PUBLISHED
from fprc.plan import NEEDS
from fprc.studies.beyond import CLAIMS as BEYOND

ROWS = yaml.safe_load(Path(__file__).with_name("sentences.yaml").read_text(encoding="utf-8"))
DECLARED = yaml.safe_load(TEXTS.read_text(encoding="utf-8"))
IDS = {claim.id for claim in CLAIMS}
KINDS = ("method", "background", "not tested")


def test_rows_name_claims_that_exist_and_every_claim_is_named():
    named = set()
    for section in ROWS["sentences"].values():
        for row in section.values() if isinstance(section, dict) else [section]:
            if isinstance(row, str):
                assert row.startswith(KINDS)
            else:
                named |= set(row)
    # B8 was judged in November 2026, and is not any more
    assert named - {*BEYOND, "B8"} == IDS


def test_of_every_sentence_that_is_not_tested_there_is_the_reason():
    rows = {}
    for section in ROWS["sentences"].values():
        rows |= section if isinstance(section, dict) else {}
    assert {begins for begins, row in rows.items() if row == "not tested"} == {
        *DECLARED["not_tested"]
    }


def test_every_number_of_the_paper_is_judged_shown_or_a_setting():
    published = yaml.safe_load(PUBLISHED.read_text(encoding="utf-8"))
    assert list(ROWS["numbers"]) == list(published)
    for shown in ROWS["numbers"].values():
        if not isinstance(shown, str):
            assert set(shown) <= IDS | {"table1", "table4", *NEEDS}


def test_every_published_claim_has_rows():
    published = yaml.safe_load(PUBLISHED.read_text(encoding="utf-8"))["claims"]
    rows = {re.sub("[a-z]$", "", claim.id) for claim in CLAIMS}
    assert rows >= {claim["id"] for claim in published}
