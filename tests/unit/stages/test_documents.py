import pytest

from fprc.errors import FprcError
from fprc.stages.documents import replace_block, update_readme

ORDERS = """\
seed,fprc_lowest_test,fprc_below_fuzzy_linear,esn_over_fprc_training,training_within_30_percent,\
fprc_lowest_reversed_test,reversed_tests_worse
101,True,True,0.952,True,True,True
102,False,True,1.118,True,False,True
103,True,True,1.0,True,False,True
"""


DEVIATIONS = """\
model,metric,mean,published_mean
fprc,train_rmse,{},10.0
esn,test_rmse,{},20.0
fuzzy_linear,validation_rmse,{},20.0
"""

LEDGER = (
    '{"note": "On the rig dry.", "claims": [{"id": "C1", "claim": "It is so.", "ours": "1", '
    '"verdict": "reproduced"}]}'
)


def block(name, content):
    return f"<!-- {name}: generated -->\n{content}\n<!-- {name}: end -->"


README = "\n".join(
    [
        "# Title",
        "",
        block("table2", "old"),
        "Between.",
        block("table2_seeds", "old"),
        block("orders", "old"),
        block("deviations", "old"),
        block("verdicts", "old"),
        block("table2_timing", "old"),
        "",
        "The end.",
        "",
    ]
)


@pytest.fixture
def project(tmp_path):
    """A README and the results that go into it."""
    contents = {
        "README.md": README,
        "table2.md": "Table II.\n\n| a |\n|---|\n| 1 ± 2 \\d |\n",
        "table2_seeds.md": "Over seeds.\n",
        "orders.csv": ORDERS,
        "ii.csv": DEVIATIONS.format(12.0, 11.0, 16.5),
        "iii.csv": DEVIATIONS.format(9.0, 26.2, 20.0),
        "claims.json": LEDGER,
        "table2_timing.md": "Times.\n",
    }
    for name, text in contents.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    (tmp_path / "figure.png").write_bytes(b"\x89PNG picture")
    return tmp_path


def update(project):
    pages = ("table2.md", "table2_seeds.md", "table2_timing.md")
    update_readme(
        [str(project / name) for name in pages],
        str(project / "orders.csv"),
        [str(project / "ii.csv"), str(project / "iii.csv")],
        str(project / "claims.json"),
        str(project / "figure.png"),
        readme=str(project / "README.md"),
        picture=str(project / "docs" / "picture.png"),
    )
    return (project / "README.md").read_text(encoding="utf-8")


def test_blocks_are_replaced_and_everything_else_is_kept(project):
    expected = README
    for name, new in (
        ("table2", "Table II.\n\n| a |\n|---|\n| 1 ± 2 \\d |"),
        ("table2_seeds", "Over seeds."),
        ("table2_timing", "Times."),
    ):
        expected = expected.replace(block(name, "old"), block(name, new))
    head, tail = expected.split(block("orders", "old"))
    text = update(project)
    assert text.startswith(head)
    assert text.endswith(tail.split(block("verdicts", "old"))[1])
    assert "old" not in text


def test_sentence_counts_the_seeds_on_which_the_order_holds(project):
    text = update(project)
    assert "- FPRC has the lowest test RMSE: on 2 of 3" in text
    assert "training, validation and test: on 3 of 3" in text
    assert "with the logs reversed, FPRC has the lowest test RMSE: on 1 of 3" in text
    assert "0.95 to 1.12" in text


def test_deviations_from_print_are_counted_over_both_tables(project):
    # +20, -45, -17.5, -10, +31 and 0 %
    text = update(project)
    assert (
        "The 6 means of Tables II and III deviate from the printed numbers by 19 % in the median"
        in text
    )
    assert "by 45 % at most (Table II, ESN, Test RMSE: 11 against 20 kPa)" in text


def test_every_claim_is_shown_with_its_verdict(project):
    assert "| C1   | It is so. | reproduced |" in update(project)


def test_picture_is_copied_into_a_folder_that_is_made(project):
    update(project)
    assert (project / "docs" / "picture.png").read_bytes() == b"\x89PNG picture"


def test_second_update_changes_nothing(project):
    assert update(project) == update(project)


def test_missing_marker_leaves_the_readme_as_it_was(project):
    spoiled = README.replace("<!-- table2_timing: end -->", "")
    (project / "README.md").write_text(spoiled, encoding="utf-8")
    with pytest.raises(FprcError, match="table2_timing"):
        update(project)
    assert (project / "README.md").read_text(encoding="utf-8") == spoiled
    assert not (project / "docs").exists()


def test_block_may_hold_what_looks_like_a_group_reference():
    assert replace_block(block("a", "x"), "a", r"\1 \g<0>") == block("a", r"\1 \g<0>")


def test_name_that_begins_another_name_is_not_mixed_up_with_it():
    text = block("table2_seeds", "x") + "\n" + block("table2", "y")
    expected = block("table2_seeds", "x") + "\n" + block("table2", "new")
    assert replace_block(text, "table2", "new") == expected


@pytest.mark.parametrize(
    "text",
    [
        "no markers",
        "<!-- a: generated -->\nno end",
        "no begin\n<!-- a: end -->",
        "<!-- a: end -->\nthe wrong way round\n<!-- a: generated -->",
        block("a", "x") + "\n" + block("a", "x"),
        "<!-- a: generated -->\nfrom before\n" + block("a", "x"),
        block("a", "x") + "\n<!-- a: end -->",
    ],
    ids=["none", "no end", "no begin", "swapped", "twice", "begins twice", "ends twice"],
)
def test_markers_that_are_not_there_exactly_once_are_refused(text):
    with pytest.raises(FprcError, match="<!-- a: generated --> and <!-- a: end -->"):
        replace_block(text, "a", "new")
