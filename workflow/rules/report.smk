# The report.

#: Tables of the report; the claims have a place of their own.
PAGES = [
    file
    for target in MADE
    for file in MADE[target]
    if file.endswith(".json") and target != "claims"
]
#: Figures of the report, with the sources of their data.
DRAWN = {
    file: PLAN.source_of(target)
    for target in sorted(MADE, key=lambda target: target[3:].zfill(2))
    for file in MADE[target]
    if file.endswith(".png")
}


rule report_page:
    input:
        template=[file_of_workflow(f"../report/page.{kind}.j2") for kind in ("html", "css")],
        ledger=[PATHS.below("claims.json")] if "claims" in MADE else [],
        tables=PAGES,
        figures=list(DRAWN),
        captions=file_of_workflow("../report/captions.yaml"),
    output:
        html=PATHS.below("report.html"),
    log:
        PATHS.messages("report_page"),
    params:
        stage="stages.report.write_report",
        code=SHOWS,
        sources=list(DRAWN.values()),
        missing={title_of_result(name): PLAN.unavailable[name] for name in PLAN.unavailable},
        settings=SETTINGS,
    message:
        "Report: claims, tables, figures and settings on one page"
    script:
        "../scripts/stage.py"
