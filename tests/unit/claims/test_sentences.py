"""Each sentence and each number of the paper has a row that says what tests it."""

import hashlib
import re
from collections import defaultdict
from pathlib import Path

import pytest
import yaml

from fprc.claims import VERDICTS
from fprc.claims.paper import CLAIMS
from fprc.config import PUBLISHED
from fprc.plan.results import NEEDS
from fprc.studies.beyond.claims import CLAIMS as BEYOND

ROWS = yaml.safe_load(Path(__file__).with_name("sentences.yaml").read_text(encoding="utf-8"))
DECLARED = yaml.safe_load(VERDICTS.read_text(encoding="utf-8"))
PAPER = Path(__file__).parents[4] / "shared/paper/paper.tex"
IDS = {claim.id for claim in CLAIMS}
KINDS = ("method", "background", "not tested")


def paper() -> str:
    """Return the paper from its abstract on."""
    if not PAPER.exists():
        pytest.skip(f"{PAPER} is not here")
    text = PAPER.read_text(encoding="utf-8")
    return text[text.index(r"\begin{abstract}") :]


def sentences() -> list[tuple[str, str]]:
    """Return section and words of each sentence of the paper's text."""
    text = paper().replace(r"\begin{abstract}", "\n\n@@Abstract\n\n")
    for pattern, new in (
        (r"(?<!\\)%.*", ""),
        (r"\\(?:sub)?section\{(.*?)\}", r"\n\n@@\1\n\n"),
        (r"(?s)\\begin\{(figure|table|IEEEkeywords)\}.*?\\end\{\1\}", "\n\n"),
        (r"(?s)\\begin\{equation\}.*?\\end\{equation\}", " "),
        (r"\\(cite|label|vspace|end|begin)\{.*?\}", ""),
        (r"\\IEEEPARstart\{(.)\}\{(\w+)\}", r"\1\2"),
        (r"Fig\.", "Fig"),
        (r"(e)\.g\.,|(i)\.e\.,", lambda found: f"{found[1] or found[2]}{'g' if found[1] else 'e'}"),
    ):
        text = re.sub(pattern, new, text)
    found, section = [], ""
    for paragraph in (" ".join(part.split()) for part in re.split(r"\n\s*\n", text)):
        if paragraph.startswith("@@"):
            section = paragraph[2:]
        elif paragraph:
            first, *others = re.split(r"(?<=[.?!])\s+(?=[A-Z$\\1-9])", paragraph)
            # what goes on after an equation belongs to the sentence before it
            own = [] if first[0].islower() else [first]
            found += [(section, sentence) for sentence in [*own, *others]]
    return found


def test_every_sentence_of_the_paper_has_one_row():
    unused = {
        (section, begins)
        for section, rows in ROWS["sentences"].items()
        if isinstance(rows, dict)
        for begins in rows
        if begins != "others"
    }
    others = defaultdict(list)
    for section, sentence in sentences():
        rows = ROWS["sentences"].get(section, {})
        of_it = [begins for begins in rows if sentence.startswith(begins)]
        assert len(of_it) < 2, (sentence, of_it)
        unused -= {(section, begins) for begins in of_it}
        if isinstance(rows, str) or not of_it:
            others[section].append(sentence)
    assert unused == set()
    # sentences without a row of their own are those that were read, and no others
    listed = {
        section: rows if isinstance(rows, str) else rows["others"]
        for section, rows in ROWS["sentences"].items()
        if isinstance(rows, str) or "others" in rows
    }
    for section, left in others.items():
        digest = hashlib.sha256("\n".join(left).encode()).hexdigest()[:12]
        assert listed.get(section, "").partition(": ")[2] == f"{len(left)} sentences, {digest}", (
            section,
            left,
        )
    assert listed.keys() == others.keys()


#: Numbers of the paper that no claim, table or setting needs.
ELSEWHERE = {
    "06": "part of the name of a pressure sensor",
    "540": "part of the name of a pressure sensor",
    "1608": "part of the name of a board",
    "1616": "part of the name of a board",
    "20": "share of a fold in per cent: follows from the number of folds",
    "0.6": "distance of the rows of a table",
    "1.2": "distance of the columns of Table III",
    "1.5": "distance of the columns of Table II",
}


def test_every_number_of_the_paper_is_published():
    # a width of a figure, a span of columns or the name of a reference is no result
    text = re.sub(
        r"(?<!\\)%.*|\\(includegraphics|vspace|hspace|cite|ref|label|cline|multicolumn|multirow)"
        r"\*?(\[.*?\])?\{.*?\}",
        "",
        paper(),
    )
    printed = set(re.findall(r"\d+(?:\.\d+)?", text)) - ELSEWHERE.keys()
    assert len(printed) > 75
    published = yaml.safe_load(PUBLISHED.read_text(encoding="utf-8"))
    del published["claims"]  # they repeat numbers in words
    known = {float(number) for number in re.findall(r"\d+(?:\.\d+)?(?:e-?\d+)?", str(published))}
    assert {number for number in printed if float(number) not in known} == set()


def test_rows_name_claims_that_exist_and_every_claim_is_named():
    named = set()
    for section in ROWS["sentences"].values():
        for row in section.values() if isinstance(section, dict) else [section]:
            if isinstance(row, str):
                assert row.startswith(KINDS)
            else:
                named |= set(row)
    # B8 was judged in November 2026, and is not any more
    assert named - {*BEYOND, "B8"} == DECLARED["verdicts"].keys() == IDS


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
