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
        template=own("../report/page.html.j2"),
        ledger=[PATHS.below("claims.json")] if "claims" in PLAN.targets else [],
        missing=PATHS.below("not_available.csv"),
        tables=PLAN.pages,
        pictures=[f"{stem}.png" for stem in PLAN.figures.values()],
        sidecars=[f"{stem}.json" for stem in PLAN.figures.values()],
        captions=[own(f"../report/fig{number:02}.rst") for number in PLAN.figures],
    output:
        html=report(
            PATHS.below("report.html"),
            caption="../report/page.rst",
            category="The whole reproduction",
            labels={"page": "report", "data": PLAN.origin},
        ),
    log:
        PATHS.messages("report_page"),
    params:
        **stage("report.write_report"),
        settings=SETTINGS,
    message:
        "Report: claims, tables, figures and settings on one page"
    script:
        "../scripts/stage.py"
