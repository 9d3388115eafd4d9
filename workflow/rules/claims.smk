# The ledger of the paper's claims; the check of its verdicts and of the files in the folders.


rule ledger:
    input:
        published=PUBLISHED,
        replicates=PLAN.replicates("models"),
        grids=PLAN.replicates("grids"),
        controls=PLAN.replicates("control"),
        times=PATHS.below("timing/times.json"),
        times_over_n_c=PATHS.below("timing/times_over_n_c.json"),
    output:
        json=PATHS.below("claims.json"),
        md=PATHS.below("claims.md"),
    log:
        PATHS.messages("ledger"),
    params:
        **stage("claims.write_ledger"),
        fitted=SETTINGS["fitted"],
    message:
        "Claims C1 to C18"
    script:
        "../scripts/stage.py"


if "check" not in PLAN.unavailable:

    rule check:
        input:
            ledger=PATHS.below("claims.json"),
            verdicts=own("../../config/verdicts.yaml"),
        log:
            PATHS.messages("check"),
        localrule: True
        params:
            **stage("check.check_results"),
            folders=FOLDERS,
            made=lambda wildcards: made_by_rules(),
            # the documentation shows the results of the paper's settings in the checkout only
            pictures=lambda wildcards: (
                pictures_of_docs() if RESULTS == "results" and IN_CHECKOUT else {}
            ),
        message:
            "Check of the verdicts in config/verdicts.yaml, of files, of pictures in docs"
        script:
            "../scripts/stage.py"
