# Sec. III-D: cross-validation, test and execution times of the models.
# Result files are named after the training log; Table III trains on `complex`.

TRAIN_AND_TEST = {"train": PATHS.data("sweep"), "test": PATHS.data("complex")}


rule judge:
    input:
        **{log: PATHS.data(log) for log in EXPERIMENTS},
    output:
        **{
            kind: [PATHS.judged(log, "{model}")[kind] for log in EXPERIMENTS]
            for kind in ("errors", "fitted", "fits", "predictions")
        },
    log:
        PATHS.messages("judge_{model}"),
    resources:
        mem_mb=2000,
    params:
        name="{model}",
        validation=lambda wildcards: validation(SETTINGS, wildcards.model),
        stage="stages.judge.judge",
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
    resources:
        mem_mb=2000,
        runtime=60,
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
        **TRAIN_AND_TEST,
    output:
        times=PATHS.below("timing/times.json"),
        times_over_n_c=PATHS.below("timing/times_over_n_c.json"),
    log:
        PATHS.messages("measure_times"),
    priority: ALONE
    threads: workflow.cores
    resources:
        mem_mb=2000,
    params:
        stage="stages.timing.measure_times",
        code=computes(*PLAN.models),
        models=SETTINGS["models"],
        n_c=SETTINGS["grids"]["n_c"],
        repeats=SETTINGS["evaluation"]["timing_repeats"],
        seed=SETTINGS["seed"],
    message:
        "Execution times (no other job runs meanwhile)"
    script:
        "../scripts/stage.py"


rule weigh:
    input:
        train=PATHS.data("sweep"),
    output:
        weights=PATHS.below("weights/fprc.json"),
    log:
        PATHS.messages("weigh"),
    params:
        stage="stages.grid.weigh",
        code=computes("fprc"),
        validation=validation(SETTINGS, "fprc"),
    message:
        "Weight contributions of the FPRC"
    script:
        "../scripts/stage.py"


rule grid:
    input:
        **TRAIN_AND_TEST,
    output:
        cells=PATHS.below("grids.json"),
    log:
        PATHS.messages("grid"),
    priority: LONG
    resources:
        mem_mb=2000,
    params:
        stage="stages.grid.judge",
        code=computes("fprc", "fuzzy_linear"),
        values=SETTINGS["grids"],
        validation=validation(SETTINGS, "fprc"),
    message:
        "Grids of epsilon, n_c and taps"
    script:
        "../scripts/stage.py"
