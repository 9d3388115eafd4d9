def test_page_holds_what_the_tests_found(whole_matrix, page):
    def compared(lines):
        return [line.split(" | ")[:-1] for line in lines]

    assert compared(page) == compared(whole_matrix.lines()), "run `make fault-matrix`"
