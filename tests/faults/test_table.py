def test_page_holds_what_the_tests_found(whole_matrix, page):
    def compared(text):
        # what was measured, the last of eight columns, differs from run to run
        lines = [line.split(" | ") for line in text.splitlines()]
        return [cells[:7] for cells in lines]

    assert compared(page) == compared(whole_matrix), "run `make fault-matrix`"
