# Pages of the documentation that show results; the check of verdicts, results, pictures and README.
# Both look at the paper and at its studies.

#: The documentation shows the results of the paper's settings, in the checkout.
SHOWN = RESULTS == "results" and IN_CHECKOUT
OF_README = {"pages": PLAN.pages[1:], "ledger": PATHS.below("claims.json")}
#: Figures of the paper in docs/idea.md, by their pictures.
IN_DOCS = {
    f"docs/images/fig{number:02}.png": PATHS.below(
        BY_NAME[f"fig{number}"].files[0].replace(".pdf", ".png")
    )
    for number in (1, 2, 7)
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
            figures=[
                *expand(PATHS.below("figures/moving.{kind}"), kind=("gif", "png")),
                *IN_DOCS.values(),
            ],
            made_from=TARGETS["report"],
        log:
            PATHS.messages("readme"),
        localrule: True
        params:
            **stage("studies.documents.update_readme"),
            readme="README.md",
            results="docs/results.md",
            pictures=[*expand("docs/images/moving.{kind}", kind=("gif", "png")), *IN_DOCS],
        message:
            "README.md and docs/results.md: numbers from the results; pictures of docs/"
        script:
            "../scripts/stage.py"


rule calibration_page:
    input:
        tables=[
            *expand(PATHS.below("families/{table}.md"), table=FAMILY_TABLES),
            PATHS.below("calibration/targets.md"),
            PATHS.below("calibration/sensitivity.md"),
            PATHS.below("calibration/stop.md"),
        ],
        figures=[
            PATHS.below(f"{name}.png")
            for name in (
                "families/figure",
                "calibration/sensitivity_figure",
                "calibration/channels",
            )
        ],
        made_from=[
            *CHUNK_FILES.values(),
            PATHS.below("calibration/sensitivity.json"),
            *PLAN.replicates("models", TARGET_NAMES),
            *PLAN.replicates("control", TARGET_NAMES),
        ],
    log:
        PATHS.messages("calibration_page"),
    localrule: True
    params:
        **stage("studies.documents.update_tables"),
        pages=["docs/calibration.md"],
        pictures=[f"docs/images/{name}.png" for name in ("families", "sensitivity", "channels")],
    message:
        "docs/calibration.md: numbers and pictures from the results"
    script:
        "../scripts/stage.py"


rule beyond_page:
    input:
        tables=expand(PATHS.below("beyond/{page}.md"), page=PAGES_BEYOND),
        figures=expand(PATHS.below("beyond/figure_{name}.png"), name=FIGURES_BEYOND),
    log:
        PATHS.messages("beyond_page"),
    localrule: True
    params:
        **stage("studies.documents.update_tables"),
        pages=["docs/beyond.md", "docs/benchmark.md", "docs/beyond-details.md"],
        pictures=[f"docs/images/beyond_{name}.png" for name in FIGURES_BEYOND],
    message:
        "docs/beyond.md, its details and the leaderboard: numbers and pictures from the results"
    script:
        "../scripts/stage.py"


rule drift_page:
    input:
        tables=expand(PATHS.below("online/{table}.md"), table=("verdicts", "errors")),
        figures=[PATHS.below("online/figure.png")],
        made_from=expand(PATHS.below("online/{world}.json"), world=WORLDS),
    log:
        PATHS.messages("drift_page"),
    localrule: True
    params:
        **stage("studies.documents.update_tables"),
        pages=["docs/drift.md"],
        pictures=["docs/images/drift.png"],
    message:
        "docs/drift.md: numbers and picture from the results"
    script:
        "../scripts/stage.py"


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
            pictures=lambda wildcards: pictures_of_docs() if SHOWN else {},
        message:
            "Check of the declared verdicts, of results, of pictures in docs, of README.md"
        script:
            "../scripts/stage.py"
