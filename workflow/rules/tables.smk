# Tables I to IV, the same over further seeds, and the execution times. Each named output is a target.


rule tabulate_settings:
    input:
        published=PUBLISHED,
    output:
        table1=table("tables/table1"),
    log:
        PATHS.messages("tabulate_settings"),
    params:
        stage="stages.tabulate.tabulate_settings",
        code=SHOWS,
        models=SETTINGS["models"],
    message:
        "Table I"
    script:
        "../scripts/stage.py"


rule tabulate_models:
    input:
        **{
            log: [PATHS.judged(log, model)["errors"] for model in PLAN.models]
            for log in EXPERIMENTS
        },
        published=PUBLISHED,
        quality=[PATHS.quality(log) for log in EXPERIMENTS],
        made_from=PLAN.data,
    output:
        **PLAN.possible(table2=table("tables/table2"), table3=table("tables/table3")),
    log:
        PATHS.messages("tabulate_models"),
    params:
        stage="stages.tabulate.tabulate_models",
        code=SHOWS,
        left_out=PLAN.left_out,
    message:
        "Tables II and III"
    script:
        "../scripts/stage.py"


rule tabulate_tracking:
    input:
        published=PUBLISHED,
        runs=[PATHS.log(run) for run in PLAN.runs],
        made_from=[*DRIVEN_BY, *PLAN.data] if PLAN.records else [],
    output:
        **PLAN.possible(table4=table("tables/table4")),
    log:
        PATHS.messages("tabulate_tracking"),
    params:
        stage="stages.tabulate.tabulate_tracking",
        code=SHOWS,
        left_out=[run for run in PLAN.every_run if run not in PLAN.contents],
        limits=SETTINGS["quality"],
        feedback=feedback_in_words(SETTINGS),
    message:
        "Table IV"
    script:
        "../scripts/stage.py"


rule tabulate_times:
    input:
        published=PUBLISHED,
        times=PATHS.below("timing/times.json"),
        made_from=PLAN.data,
    output:
        **PLAN.possible(timing=table("timing/table2_timing")),
    log:
        PATHS.messages("tabulate_times"),
    params:
        stage="stages.tabulate.tabulate_times",
        code=SHOWS,
        left_out=PLAN.left_out,
    message:
        "Table II, execution times"
    script:
        "../scripts/stage.py"


rule tabulate_seeds:
    input:
        published=PUBLISHED,
        models=PLAN.replicates("models"),
        loops=PLAN.replicates("control"),
    output:
        **PLAN.possible(
            seeds=[
                file
                for name in ("table2_seeds", "table3_seeds", "table4_seeds")
                for file in table(f"tables/{name}")
            ]
        ),
    log:
        PATHS.messages("tabulate_seeds"),
    params:
        stage="stages.tabulate.tabulate_seeds",
        code=SHOWS,
        feedback=feedback_in_words(SETTINGS),
    message:
        "Tables II to IV over further seeds"
    script:
        "../scripts/stage.py"


SHOWN += [
    rules.tabulate_settings,
    rules.tabulate_models,
    rules.tabulate_tracking,
    rules.tabulate_times,
    rules.tabulate_seeds,
]
