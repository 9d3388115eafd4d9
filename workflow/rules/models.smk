# Sec. III-D: cross-validation, test and execution times of the models.
# Result files are named after the training log; Table III trains on `complex`.

BOTH_LOGS = {log: PATHS.data(log) for log in EXPERIMENTS}


rule judge:
    input:
        **BOTH_LOGS,
    output:
        **{
            kind: [PATHS.judged(log, "{model}")[kind] for log in EXPERIMENTS]
            for kind in ("errors", "fitted", "fits", "predictions")
        },
    log:
        PATHS.messages("judge_{model}"),
    params:
        name="{model}",
        validation=lambda wildcards: validation(SETTINGS, wildcards.model),
        stage="stages.models.judge",
        code=lambda wildcards: computes(wildcards.model),
    message:
        "Cross-validation and test of {wildcards.model}, also with the logs reversed"
    script:
        "../scripts/stage.py"


rule replicate:
    output:
        compared=PATHS.replicate("models", "{seed}"),
        cells=PATHS.replicate("grids", "{seed}"),
        measures=PATHS.replicate("control", "{seed}"),
    log:
        PATHS.messages("replicate_{seed}"),
    priority: LONG
    params:
        stage="stages.replicate.replicate",
        code=computes(*PLAN.models),
        on_rig=on_rig(SETTINGS),
        validation=lambda wildcards: validation(SETTINGS, seed=int(wildcards.seed)),
        values=SETTINGS["grids"],
        tracking=SETTINGS["tracking"],
    message:
        "Tables, grids and closed loops again with seed {wildcards.seed}"
    script:
        "../scripts/stage.py"


rule measure_times:
    input:
        **BOTH_LOGS,
    output:
        times=PATHS.below("timing/times.json"),
        times_over_n_c=PATHS.below("timing/times_over_n_c.json"),
    log:
        PATHS.messages("measure_times"),
    priority: ALONE
    threads: workflow.cores
    params:
        stage="stages.models.measure_times",
        code=computes(*PLAN.models),
        models=SETTINGS["models"],
        n_c=SETTINGS["grids"]["n_c"],
        repeats=SETTINGS["evaluation"]["timing_repeats"],
        seed=SETTINGS["seed"],
    message:
        "Execution times (no other job runs meanwhile)"
    script:
        "../scripts/stage.py"


rule grid:  # of logs that have no further seeds
    input:
        **BOTH_LOGS,
    output:
        cells=PATHS.below("grids.json"),
    log:
        PATHS.messages("grid"),
    priority: LONG
    params:
        stage="stages.models.grid",
        code=computes("fprc", "fuzzy_linear"),
        values=SETTINGS["grids"],
        validation=validation(SETTINGS, "fprc"),
    message:
        "Grids of epsilon, n_c and taps"
    script:
        "../scripts/stage.py"
