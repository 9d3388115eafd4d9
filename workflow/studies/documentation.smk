# Pages of the documentation that show results; the check of verdicts and README.
# Both look at the paper and at its studies.

# an unrelated folder may have docs/images too
IN_CHECKOUT = os.path.normpath(FOLDER) == "workflow/studies"


rule beyond_page:
    input:
        # each table by its block in the documentation
        **{f"beyond_{name}": PATHS.below(f"beyond/{name}.md") for name in PAGES_BEYOND},
        figures=[PATHS.below("beyond/figure_pairs.png")],
        made_from=STUDY_TARGETS["beyond"],
    log:
        PATHS.messages("beyond_page"),
    localrule: True
    params:
        stage="studies.pages.update_pages",
        code=SHOWS,
        pages=["README.md", "docs/beyond.md", "docs/benchmark.md", "docs/beyond-details.md"],
        pictures=["docs/images/beyond_pairs.png"],
    message:
        "Numbers and pictures of the pages on models beyond the paper's"
    script:
        "../scripts/stage.py"


use rule beyond_page as drift_page with:
    input:
        online_verdicts=PATHS.below("online/verdicts.md"),
        online_errors=PATHS.below("online/errors.md"),
        figures=[PATHS.below("online/figure.png")],
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
            figures=[PATHS.below("claims.csv")],
            made_from=TARGETS["report"],
        log:
            PATHS.messages("readme"),
        params:
            pages=["README.md", "docs/results.md"],
            pictures=["docs/claims.csv"],
        message:
            "Numbers of README.md and docs/results.md"

    rule check:
        input:
            ledger=PATHS.below("claims.json"),
            # README shows the results of the paper's settings, in the checkout
            pages=list(SHOWN_IN_README.values()) if IN_CHECKOUT and RESULTS == "results" else [],
            verdicts=str(TEXTS),
        log:
            PATHS.messages("check"),
        localrule: True
        params:
            stage="studies.pages.check_results",
            code=SHOWS,
        message:
            "Check of the declared verdicts and of README.md"
        script:
            "../scripts/stage.py"
