import json
import re

import pytest
import yaml

from fprc.errors import FprcError
from fprc.studies.pages import check_results, different_lines, update_pages, with_blocks

NUMBER = {"text": "errors", "mean": 0.5, "first": 0.4, "last": 0.6, "limits": "below 1"}
LEDGER = json.dumps({"note": "On the rig dry.", "claims": [
    {"id": "C5", "claim": "it is fast", "rig": "counted", "rigs": "-", "verdict": "undecided",
     "statements": [{**NUMBER, "verdict": "reproduced"},
                    {**NUMBER, "text": "times", "last": 1.1, "verdict": "undecided"}]},
    {"id": "C1", "claim": "it is so", "rig": "fitted", "rigs": "2 of 3", "verdict": "reproduced",
     "statements": [{**NUMBER, "verdict": "reproduced"}]},
]})  # fmt: skip


def block(name, content):
    return f"<!-- {name}: generated -->\n{content}\n<!-- {name}: end -->"


#: Results, and the text of their pages.
PAGES = {
    "table2": "Table II.\n\n| a |\n|---|\n| 1 ± 2 \\d |\n",
    "table2_seeds": "Over seeds.\n",
    "table3_seeds": "Reversed.\n",
    "table4_seeds": "Followed with P_o.\n",
    "table2_timing": "Times.\n",
}
README = "\n".join([block("table2_seeds", "old"), block("table4_seeds", "old"), "End.\n"])
OLD = [block(name, "old") for name in (*PAGES, "held", "verdicts")]
#: The same as numbers: 10, 20 and 30 % off print; 5 % in open loop, 40 % in closed loop.
ERRORS = {
    "table2_seeds": "mean,published_mean\n11,10\n8,10\n",
    "table3_seeds": "mean,published_mean\n13,10\n",
    "table4_seeds": "controller,rmse_deg,published_rmse_deg\n"
    "fprc,2.1,2\nfprc,2,2\nfprc_pd,0.6,1\npd,3,\n",
}
RESULTS = "\nBetween.\n".join(["# Title\n", *OLD, "The end.\n"])


@pytest.fixture
def project(tmp_path):
    """The two pages and the results that go into them."""
    (tmp_path / "docs").mkdir()
    files = {"README.md": README, "docs/results.md": RESULTS, "claims.json": LEDGER}
    for name, text in (files | {f"{name}.md": text for name, text in PAGES.items()}).items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    for name, text in ERRORS.items():
        (tmp_path / f"{name}.csv").write_text(text, encoding="utf-8")
    (tmp_path / "figure.png").write_bytes(b"\x89PNG picture")
    return tmp_path


def update(project):
    update_pages(
        [str(project / "figure.png")],
        pages=[str(project / "README.md"), str(project / "docs/results.md")],
        pictures=[str(project / "images" / "picture.png")],
        verdicts=str(project / "claims.json"),
        **{name: str(project / f"{name}.md") for name in PAGES},
    )
    return (project / "docs/results.md").read_text(encoding="utf-8")


def test_blocks_and_pictures_are_replaced_and_everything_else_is_kept(project):
    expected = RESULTS
    for name, new in PAGES.items():
        expected = expected.replace(block(name, "old"), block(name, new.strip()))
    head, tail = expected.split("\nBetween.\n".join(OLD[-2:]))
    text, readme = update(project), (project / "README.md").read_text(encoding="utf-8")
    assert text.startswith(head)
    assert text.endswith(tail)
    assert "\nold\n" not in text + readme
    seeds = PAGES["table2_seeds"].strip(), "Followed with P<sub>o</sub>."
    assert readme == README.replace("old", seeds[0], 1).replace("old", seeds[1])
    assert (project / "images" / "picture.png").read_bytes() == b"\x89PNG picture"


def test_claims_have_the_number_that_decides_and_are_counted_by_kind(project):
    text = update(project)
    cards = [re.findall(r"C\d, [a-z]+|errors|times|[\d.]+ \([\d.]+ to .*?\)", line)
             for line in text.splitlines() if line.startswith("- **")]  # fmt: skip
    assert cards == [
        ["C1, reproduced", "errors", "0.5 (0.4 to 0.6)"],
        ["C5, undecided", "times", "0.5 (0.4 to 1.1)"],
    ]
    held = text.partition("<!-- held: generated -->")[2].partition("<!-- held")[0]
    counts = re.findall(r"^\| (\w+): .* (\d+ of \d+) ", held, re.MULTILINE)
    assert counts == [("fitted", "1 of 1"), ("counted", "0 of 1")]
    assert re.findall(r"([\d.]+) %", held) == ["20.0", "30", "5", "40"]  # off print


def test_missing_marker_leaves_both_pages_as_they_were(project):
    spoiled = RESULTS.replace("<!-- table2_timing: end -->", "")
    (project / "docs/results.md").write_text(spoiled, encoding="utf-8")
    with pytest.raises(FprcError, match="table2_timing"):
        update(project)
    assert (project / "docs/results.md").read_text(encoding="utf-8") == spoiled
    assert (project / "README.md").read_text(encoding="utf-8") == README
    assert not (project / "images").exists()


@pytest.mark.parametrize(
    "text",
    ["<!-- a: generated -->\nno end", "<!-- a: end -->\nswapped\n<!-- a: generated -->",
     block("a", "x") + "\n" + block("a", "x")],
)  # fmt: skip
def test_markers_that_are_not_there_exactly_once_are_refused(tmp_path, text):
    (tmp_path / "page.md").write_text(text)
    with pytest.raises(FprcError):
        with_blocks(str(tmp_path / "page.md"), {"a": "new"})


@pytest.mark.parametrize(
    ("shown", "found"),
    [
        ("Of 9 claims 4 hold: 12.4 kPa", 0),
        ("Of 9 claims 4 hold: 12.5 kPa", 0),  # rounded the other way
        ("Of 9 claims 4 hold: 12.6 kPa", 1),
        ("Of 9 claims 6 hold: 12.4 kPa", 1),
        ("Of 9 claims 4 fail: 12.4 kPa", 1),
        ("Of 9 claims 4 hold: 12.4 kPa\nand more", 1),
    ],
)
def test_page_whose_numbers_differ_is_named(tmp_path, monkeypatch, shown, found):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "page.md").write_text(block("outcome", shown))
    lines = [*different_lines("page.md", {"outcome": "Of 9 claims 4 hold: 12.4 kPa\n"})]
    assert len(lines) == found
    assert all("page.md" in line for line in lines)


def test_verdicts_and_numbers_that_differ_are_reported_at_once(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    claims = [{"id": "C1", "verdict": "reproduced", "rig": "fitted"}]
    (tmp_path / "claims.json").write_text(json.dumps({"claims": claims}))
    declared = tmp_path / "known.yaml"
    declared.write_text(yaml.safe_dump({"claims": {"C1": {"verdict": "reproduced"}}}))
    (tmp_path / "a.md").write_text("FPRC 11.9 kPa")
    (tmp_path / "README.md").write_text(block("a", "FPRC 11.9 kPa"))
    check_results("claims.json", "known.yaml", ["a.md"])
    (tmp_path / "README.md").write_text(block("a", "FPRC 12.9 kPa"))
    declared.write_text(yaml.safe_dump({"claims": {"C1": {"verdict": "undecided"}}}))
    with pytest.raises(FprcError, match=r"(?s)C1.*README\.md"):
        check_results("claims.json", "known.yaml", ["a.md"])
