# Everything on one page, and what could not be made.


rule list_unavailable:
    output:
        **MISSING,
    log:
        f"{RESULTS}/logs/list_unavailable.log",
    params:
        reasons=UNAVAILABLE,
        code=code_of("list_unavailable"),
    message:
        "What the data do not allow, and why"
    script:
        "../scripts/list_unavailable.py"


rule report_page:
    input:
        template="workflow/report/page.html.j2",
        ledger=CLAIMS,
        missing=MISSING["csv"],
        tables=PAGES,
        pictures=[path.replace(".pdf", ".png") for path in SHOWN.values()],
        sidecars=[path.replace(".pdf", ".json") for path in SHOWN.values()],
        captions=[f"workflow/report/fig{number:02}.rst" for number in SHOWN],
    output:
        html=report(
            f"{RESULTS}/report.html",
            caption="../report/page.rst",
            category="The whole reproduction",
            labels={"page": "report", "data": DATA},
        ),
    log:
        f"{RESULTS}/logs/report_page.log",
    params:
        settings=SETTINGS,
        code=code_of("page"),
    message:
        "Report: claims, tables, figures and settings on one page"
    script:
        "../scripts/page.py"
