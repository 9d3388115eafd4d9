# Sec. III-D: cross-validation, test and execution times of the models.
# Result files are named after the training log; Table III trains on `complex`.

BOTH_LOGS = {log: f"{RESULTS}/data/{log}.h5" for log in EXPERIMENTS}


rule judge:
    input:
        **BOTH_LOGS,
    output:
        **{
            kind: [PLAN.judged(log, "{model}")[kind] for log in EXPERIMENTS]
            for kind in ("errors", "fitted", "fits", "predictions")
        },
    log:
        f"{RESULTS}/logs/judge_{{model}}.log",
    params:
        name="{model}",
        validation=lambda wildcards: plan.validation(SETTINGS, wildcards.model),
        stage="stages.models.judge",
        code=lambda wildcards: computes(wildcards.model),
    message:
        "Cross-validation and test of {wildcards.model}, also with the logs reversed"
    script:
        "../scripts/stage.py"


rule replicate:
    output:
        compared=f"{RESULTS}/replicates/models_{{seed}}.json",
        cells=f"{RESULTS}/replicates/grids_{{seed}}.json",
        measures=f"{RESULTS}/replicates/control_{{seed}}.json",
    log:
        f"{RESULTS}/logs/replicate_{{seed}}.log",
    priority: LONG
    params:
        stage="stages.models.replicate",
        code=computes(*PLAN.models),
        on_rig=plan.on_rig(SETTINGS),
        validation=lambda wildcards: plan.validation(SETTINGS, seed=int(wildcards.seed)),
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
        times=f"{RESULTS}/timing/times.json",
        times_over_n_c=f"{RESULTS}/timing/times_over_n_c.json",
    log:
        f"{RESULTS}/logs/measure_times.log",
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
        cells=f"{RESULTS}/grids.json",
    log:
        f"{RESULTS}/logs/grid.log",
    priority: LONG
    params:
        stage="stages.models.grid",
        code=computes("fprc", "fuzzy_linear"),
        values=SETTINGS["grids"],
        validation=plan.validation(SETTINGS, "fprc"),
    message:
        "Grids of epsilon, n_c and taps"
    script:
        "../scripts/stage.py"
