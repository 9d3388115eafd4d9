# The ledger of the paper's claims.


rule ledger:
    input:
        published=PUBLISHED,
        replicates=PLAN.replicates("models"),
        grids=PLAN.replicates("grids"),
        controls=PLAN.replicates("control"),
        times=PATHS.below("timing/times.json"),
        times_over_n_c=PATHS.below("timing/times_over_n_c.json"),
        untested=str(VERDICTS),
        made_from=PLAN.data,
        members=str(MEMBERS),
    output:
        **PLAN.possible(claims=[PATHS.below("claims.json"), PATHS.below("claims.md")]),
    log:
        PATHS.messages("ledger"),
    params:
        stage="stages.claims.write_ledger",
        code=SHOWS,
        fitted=SETTINGS["fitted"],
    message:
        "Claims C1 to C22"
    script:
        "../scripts/stage.py"


SHOWN += [rules.ledger]
