# Tables I to IV, the same over further seeds, and tables that the paper does not have.

TRAINED_ON = {"2": "sweep", "3": "complex"}


rule configuration_table:
    input:
        published=PUBLISHED,
    output:
        **PATHS.table("tables/table1"),
    log:
        PATHS.messages("table1"),
    params:
        **stage("tabulate.tabulate_configuration"),
        models=SETTINGS["models"],
    message:
        "Table I: settings of the models"
    script:
        "../scripts/stage.py"


rule comparison_table:
    input:
        published=PUBLISHED,
        errors=lambda wildcards: [
            PATHS.errors(TRAINED_ON[wildcards.number], model) for model in PLAN.models
        ],
    output:
        **PATHS.table("tables/table{number}"),
    log:
        PATHS.messages("table{number}"),
    params:
        **stage("tabulate.tabulate_comparison"),
        left_out=PLAN.left_out,
    message:
        "Errors of the models: table{wildcards.number}"
    script:
        "../scripts/stage.py"


rule seeds_table:
    input:
        published=PUBLISHED,
        replicates=PLAN.replicates("models"),
    output:
        **PATHS.table("tables/table{number}_seeds"),
    log:
        PATHS.messages("table{number}_seeds"),
    params:
        **stage("tabulate.tabulate_seeds"),
        trained_on=lambda wildcards: TRAINED_ON[wildcards.number],
    message:
        "Errors of the models over further seeds: table{wildcards.number}_seeds"
    script:
        "../scripts/stage.py"


rule timing_table:
    input:
        published=PUBLISHED,
        times=PATHS.below("timing/times.json"),
    output:
        **PATHS.table("timing/table2_timing"),
    log:
        PATHS.messages("table2_timing"),
    params:
        **stage("tabulate.tabulate_times"),
        left_out=PLAN.left_out,
    message:
        "Execution times of Table II"
    script:
        "../scripts/stage.py"


rule tracking_table:
    input:
        published=PUBLISHED,
        runs=[PATHS.log(run) for run in PLAN.runs],
    output:
        **PATHS.table("tables/table4"),
    log:
        PATHS.messages("table4"),
    params:
        **stage("tabulate.tabulate_tracking"),
        left_out=[run for run in PLAN.every_run if run not in PLAN.contents],
        limits=SETTINGS["quality"],
        feedback=feedback_in_words(SETTINGS),
    message:
        "Table IV: errors of the closed-loop runs"
    script:
        "../scripts/stage.py"


rule tracking_seeds_table:
    input:
        published=PUBLISHED,
        replicates=PLAN.replicates("control"),
    output:
        **PATHS.table("tables/table4_seeds"),
    log:
        PATHS.messages("table4_seeds"),
    params:
        **stage("tabulate.tabulate_tracking_seeds"),
        feedback=feedback_in_words(SETTINGS),
    message:
        "Table IV over further seeds"
    script:
        "../scripts/stage.py"


rule steps_table:
    input:
        steps=PATHS.below("timing/steps.json"),
    output:
        **PATHS.table("timing/step_cost"),
    log:
        PATHS.messages("step_cost"),
    params:
        **stage("tabulate.tabulate_steps"),
        left_out=PLAN.left_out,
    message:
        "Cost of a control step"
    script:
        "../scripts/stage.py"


rule readout_table:
    input:
        cells=PATHS.below("readout/cells.json"),
    output:
        **PATHS.table("readout/readout"),
    log:
        PATHS.messages("readout_table"),
    params:
        **stage("tabulate.tabulate_readout"),
    message:
        "Value of the readout: table"
    script:
        "../scripts/stage.py"
