from fprc.studies.pages import replace_block


def test_page_holds_what_the_tests_found(whole_matrix, request):
    def compared(text):
        # what was measured, the last column, differs from run to run
        return [line.split(" | ")[:6] for line in text.splitlines() if line.count(" | ") == 6]

    page = request.path.parents[2] / "docs/hardware.md"
    text = page.read_text(encoding="utf-8")
    if request.config.getoption("write_matrix", False):
        text = replace_block(text, "faults", whole_matrix, page.name)
        page.write_text(text, encoding="utf-8")
    assert compared(text) == compared(whole_matrix), "run `pytest tests/faults --write-matrix`"


def test_only_two_faults_leave_a_valve_that_does_not_vent(whole_matrix):
    cells = [line.strip("| ").split(" | ") for line in whole_matrix.splitlines()]
    unsafe = {row[0].partition(":")[0] for row in cells if row[3].startswith("no")}
    assert unsafe == {"a valve stays open", "every driver call fails from then on"}
