# Pages of the documentation that show results; the check of verdicts, pictures and README.
# Both look at the paper and at its studies.

#: The documentation shows the results of the paper's settings, in the checkout.
SHOWN = RESULTS == "results" and IN_CHECKOUT
#: By rule: pages of the documentation, their tables by the blocks, their figures by the pictures in
#: docs, and the targets that make these.
SHOWN_ON = {
    "calibration_page": SimpleNamespace(
        pages=["docs/calibration.md"],
        tables=by_block("families", FAMILY_TABLES),
        figures={},
        targets=["families"],
    ),
    "beyond_page": SimpleNamespace(
        pages=["docs/beyond.md", "docs/benchmark.md", "docs/beyond-details.md"],
        tables=by_block("beyond", PAGES_BEYOND),
        figures={"docs/images/beyond_pairs.png": PATHS.below("beyond/figure_pairs.png")},
        targets=["beyond"],
    ),
    "drift_page": SimpleNamespace(
        pages=["docs/drift.md"],
        tables=by_block("online", ("verdicts", "errors")),
        figures={"docs/images/drift.png": PATHS.below("online/figure.png")},
        targets=["online"],
    ),
}

# the README gives the numbers of the simulated rig, and the declared verdicts are of it too
if PLAN.on_simulated_rig:
    SHOWN_ON["readme"] = SimpleNamespace(
        pages=["README.md", "docs/results.md"],
        tables={
            **{Path(page).stem: page for page in PLAN.pages[1:]},
            "verdicts": PATHS.below("claims.json"),
        },
        figures={},
        targets=["report"],
    )

for rule_name, shown in SHOWN_ON.items():

    rule:
        name:
            rule_name
        input:
            **shown.tables,
            figures=list(shown.figures.values()),
            made_from=[(STUDY_TARGETS | TARGETS)[target] for target in shown.targets],
        log:
            PATHS.messages(rule_name),
        localrule: True
        params:
            **stage("studies.stages.documents.update_pages"),
            pages=shown.pages,
            pictures=list(shown.figures),
        message:
            f"{', '.join(shown.pages)}: numbers and pictures from the results"
        script:
            "../scripts/stage.py"


PICTURES = dict(pair for shown in SHOWN_ON.values() for pair in shown.figures.items())

if PLAN.on_simulated_rig:

    rule check:
        input:
            ledger=PATHS.below("claims.json"),
            pages=PLAN.pages[1:] if SHOWN else [],
            verdicts=str(VERDICTS),
        log:
            PATHS.messages("check"),
        localrule: True
        params:
            **stage("studies.stages.check.check_results"),
            pictures=lambda wildcards: PICTURES if SHOWN else {},
        message:
            "Check of the declared verdicts, of pictures in docs, of README.md"
        script:
            "../scripts/stage.py"
