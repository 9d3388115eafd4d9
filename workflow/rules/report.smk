# The report, and the list of results that cannot be made.


rule list_unavailable:
    output:
        csv=PATHS.below("not_available.csv"),
        md=PATHS.below("not_available.md"),
    log:
        PATHS.messages("list_unavailable"),
    params:
        **stage("tabulate.tabulate_unavailable"),
        reasons=PLAN.unavailable_results,
    message:
        "Results that the data do not allow, and why"
    script:
        "../scripts/stage.py"


rule report_page:
    input:
        template=[file_of_workflow(f"../report/page.{kind}.j2") for kind in ("html", "css")],
        ledger=[PATHS.below("claims.json")] if "claims" in PLAN.targets else [],
        missing=PATHS.below("not_available.csv"),
        tables=PLAN.pages,
        figures=[f"{stem}.{kind}" for stem in PLAN.figures for kind in ("png", "json")],
        captions=file_of_workflow("../report/captions.yaml"),
    output:
        html=PATHS.below("report.html"),
    log:
        PATHS.messages("report_page"),
    params:
        **stage("report.write_report"),
        settings=SETTINGS,
    message:
        "Report: claims, tables, figures and settings on one page"
    script:
        "../scripts/stage.py"
