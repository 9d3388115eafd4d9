# Pages of the documentation that show results; the check of verdicts, results, pictures and README.
# Both look at the paper and at its studies.

#: The documentation shows the results of the paper's settings, in the checkout.
SHOWN = RESULTS == "results" and IN_CHECKOUT
OF_README = {"pages": PLAN.pages[1:], "ledger": PATHS.below("claims.json")}
#: Figures in README.md and docs/idea.md, by their pictures.
IN_DOCS = {
    **{
        f"docs/images/moving.{kind}": PATHS.below(f"figures/moving.{kind}")
        for kind in ("gif", "png")
    },
    **{
        f"docs/images/fig{number:02}.png": PATHS.below(
            BY_NAME[f"fig{number}"].files[0].replace(".pdf", ".png")
        )
        for number in (1, 2, 7)
    },
}

if "readme" not in PLAN.unavailable:

    rule moving_picture:
        input:
            run=PATHS.log("track_sine_0p5_fprc_pd"),
            alone=PATHS.log("track_sine_0p5_pd"),
        output:
            gif=PATHS.below("figures/moving.gif"),
            png=PATHS.below("figures/moving.png"),
        log:
            PATHS.messages("moving_picture"),
        params:
            **stage("studies.moving_picture.draw_moving_picture"),
        message:
            "Moving picture: actuator, reservoir and tracking"
        script:
            "../scripts/stage.py"

    rule readme:
        input:
            **OF_README,
            figures=list(IN_DOCS.values()),
            made_from=TARGETS["report"],
        log:
            PATHS.messages("readme"),
        localrule: True
        params:
            **stage("studies.documents.update_readme"),
            readme="README.md",
            results="docs/results.md",
            pictures=list(IN_DOCS),
        message:
            "README.md and docs/results.md: numbers from the results; pictures of docs/"
        script:
            "../scripts/stage.py"


#: By rule: pages of the documentation, their tables, and their figures by the pictures in docs.
SHOWN_ON = {
    "calibration_page": SimpleNamespace(
        pages=["docs/calibration.md"],
        tables=[
            *expand(PATHS.below("families/{table}.md"), table=FAMILY_TABLES),
            *expand(
                PATHS.below("calibration/{table}.md"), table=("targets", "sensitivity", "stop")
            ),
        ],
        figures={
            "docs/images/families.png": PATHS.below("families/figure.png"),
            "docs/images/sensitivity.png": PATHS.below("calibration/sensitivity_figure.png"),
            "docs/images/channels.png": PATHS.below("calibration/channels.png"),
        },
        made_from=[
            *CHUNK_FILES.values(),
            PATHS.below("calibration/sensitivity.json"),
            *PLAN.replicates("models", TARGET_NAMES),
            *PLAN.replicates("control", TARGET_NAMES),
        ],
    ),
    "beyond_page": SimpleNamespace(
        pages=["docs/beyond.md", "docs/benchmark.md", "docs/beyond-details.md"],
        tables=expand(PATHS.below("beyond/{page}.md"), page=PAGES_BEYOND),
        figures={
            f"docs/images/beyond_{name}.png": PATHS.below(f"beyond/figure_{name}.png")
            for name in FIGURES_BEYOND
        },
        made_from=[],
    ),
    "drift_page": SimpleNamespace(
        pages=["docs/drift.md"],
        tables=expand(PATHS.below("online/{table}.md"), table=("verdicts", "errors")),
        figures={"docs/images/drift.png": PATHS.below("online/figure.png")},
        made_from=expand(PATHS.below("online/{world}.json"), world=FAMILIES),
    ),
}

for rule_name, shown in SHOWN_ON.items():

    rule:
        name:
            rule_name
        input:
            tables=shown.tables,
            figures=list(shown.figures.values()),
            made_from=shown.made_from,
        log:
            PATHS.messages(rule_name),
        localrule: True
        params:
            **stage("studies.documents.update_tables"),
            pages=shown.pages,
            pictures=list(shown.figures),
        message:
            f"{', '.join(shown.pages)}: numbers and pictures from the results"
        script:
            "../scripts/stage.py"


PICTURES = IN_DOCS | dict(pair for shown in SHOWN_ON.values() for pair in shown.figures.items())

if "check" not in PLAN.unavailable:

    rule check:
        input:
            **{**OF_README, **({} if SHOWN else {"pages": []})},
            verdicts=str(SENTENCES),
        log:
            PATHS.messages("check"),
        localrule: True
        params:
            **stage("studies.check.check_results"),
            results=lambda wildcards: RESULTS,
            pictures=lambda wildcards: PICTURES if SHOWN else {},
        message:
            "Check of the declared verdicts, of results, of pictures in docs, of README.md"
        script:
            "../scripts/stage.py"
