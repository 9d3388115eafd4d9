# The report.


rule report_page:
    input:
        template=[file_of_workflow(f"../report/page.{kind}.j2") for kind in ("html", "css")],
        ledger=[PATHS.below("claims.json")] if "claims" in PLAN.targets else [],
        tables=PLAN.pages,
        figures=list(PLAN.figures),
        captions=file_of_workflow("../report/captions.yaml"),
    output:
        html=PATHS.below("report.html"),
    log:
        PATHS.messages("report_page"),
    params:
        **stage("stages.report.write_report"),
        sources=list(PLAN.figures.values()),
        missing={BY_NAME[name].title: why for name, why in PLAN.unavailable.items()},
        settings=SETTINGS,
    message:
        "Report: claims, tables, figures and settings on one page"
    script:
        "../scripts/stage.py"
