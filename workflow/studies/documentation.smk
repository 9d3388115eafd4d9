# Pages of the documentation that show results; the check of verdicts, pictures and README.
# Both look at the paper and at its studies.

#: Pictures of the documentation, with the figures that they are copies of.
PICTURES = {
    "docs/images/beyond_pairs.png": PATHS.below("beyond/figure_pairs.png"),
    "docs/images/drift.png": PATHS.below("online/figure.png"),
}


rule beyond_page:
    input:
        **by_block("beyond", PAGES_BEYOND),
        figures=[PICTURES["docs/images/beyond_pairs.png"]],
        made_from=STUDY_TARGETS["beyond"],
    log:
        PATHS.messages("beyond_page"),
    localrule: True
    params:
        stage="studies.stages.documents.update_pages",
        code=SHOWS,
        pages=["README.md", "docs/beyond.md", "docs/benchmark.md", "docs/beyond-details.md"],
        pictures=["docs/images/beyond_pairs.png"],
    message:
        "Numbers and pictures of the pages on models beyond the paper's"
    script:
        "../scripts/stage.py"


use rule beyond_page as drift_page with:
    input:
        **by_block("online", ("verdicts", "errors")),
        figures=[PICTURES["docs/images/drift.png"]],
        made_from=STUDY_TARGETS["online"],
    log:
        PATHS.messages("drift_page"),
    params:
        pages=["docs/drift.md"],
        pictures=["docs/images/drift.png"],
    message:
        "Numbers and pictures of docs/drift.md"


# the README gives the numbers of the simulated rig, and the declared verdicts are of it too
if PLAN.on_simulated_rig:
    SHOWN_IN_README = {Path(page).stem: page.replace(".json", ".md") for page in PAGES[1:]}

    use rule beyond_page as readme with:
        input:
            **SHOWN_IN_README,
            verdicts=PATHS.below("claims.json"),
            figures=[],
            made_from=TARGETS["report"],
        log:
            PATHS.messages("readme"),
        params:
            pages=["README.md", "docs/results.md"],
            pictures=[],
        message:
            "Numbers of README.md and docs/results.md"

    rule check:
        input:
            ledger=PATHS.below("claims.json"),
            # the documentation shows the results of the paper's settings, in the checkout
            pages=list(SHOWN_IN_README.values()) if IN_CHECKOUT and RESULTS == "results" else [],
            verdicts=str(VERDICTS),
        log:
            PATHS.messages("check"),
        localrule: True
        params:
            stage="studies.stages.check.check_results",
            code=SHOWS,
            pictures=PICTURES if IN_CHECKOUT and RESULTS == "results" else {},
        message:
            "Check of the declared verdicts, of pictures in docs, of README.md"
        script:
            "../scripts/stage.py"
