# Pages of the documentation that show results; the check of verdicts and README.
# Both look at the paper and at its studies.

# an unrelated folder may have docs/images too
IN_CHECKOUT = os.path.normpath(FOLDER) == "workflow/studies"


rule beyond_page:
    input:
        # each table by its block in the documentation
        **{f"beyond_{name}": f"{RESULTS}/beyond/{name}.md" for name in PAGES_BEYOND},
        figures=[f"{RESULTS}/beyond/figure_pairs.png"],
        made_from=STUDY_TARGETS["beyond"],
    log:
        f"{RESULTS}/logs/beyond_page.log",
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
        online_verdicts=f"{RESULTS}/online/verdicts.md",
        online_errors=f"{RESULTS}/online/errors.md",
        figures=[f"{RESULTS}/online/figure.png"],
        made_from=STUDY_TARGETS["online"],
    log:
        f"{RESULTS}/logs/drift_page.log",
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
            verdicts=f"{RESULTS}/claims.json",
            figures=[f"{RESULTS}/claims.csv"],
            made_from=TARGETS["report"],
        log:
            f"{RESULTS}/logs/readme.log",
        params:
            pages=["README.md", "docs/results.md"],
            pictures=["docs/claims.csv"],
        message:
            "Numbers of README.md and docs/results.md"

    rule check:
        input:
            ledger=f"{RESULTS}/claims.json",
            # README shows the results of the paper's settings, in the checkout
            pages=list(SHOWN_IN_README.values()) if IN_CHECKOUT and RESULTS == "results" else [],
            verdicts=str(TEXTS),
        log:
            f"{RESULTS}/logs/check.log",
        localrule: True
        params:
            stage="studies.pages.check_results",
            code=SHOWS,
        message:
            "Check of the declared verdicts and of README.md"
        script:
            "../scripts/stage.py"
