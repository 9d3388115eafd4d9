# Sec. III-D: cross-validation, test and execution times of the models.
# The log that trains names a result's file; the reversed data set trains on `complex`.

TRAIN_AND_TEST = {"train": PATHS.data("sweep"), "test": PATHS.data("complex")}


rule judge:
    input:
        **{log: PATHS.data(log) for log in EXPERIMENTS},
    output:
        errors=[PATHS.errors(log, "{model}") for log in EXPERIMENTS],
        fitted=[PATHS.model(log, "{model}") for log in EXPERIMENTS],
        fits=[PATHS.prediction(log, "{model}", "train") for log in EXPERIMENTS],
        predictions=[PATHS.prediction(log, "{model}", "test") for log in EXPERIMENTS],
    log:
        PATHS.messages("judge_{model}"),
    resources:
        mem_mb=2000,
    params:
        name="{model}",
        judgement=lambda wildcards: judgement(wildcards.model),
        stage="judge.judge",
        code=lambda wildcards: stage("judge.judge", wildcards.model)["code"],
    message:
        "Cross-validation and test of {wildcards.model}, and with the logs reversed"
    script:
        "../scripts/stage.py"


rule replicate:
    output:
        compared=PATHS.replicate("models", "{target}", "{seed}"),
        cells=PATHS.replicate("sweeps", "{target}", "{seed}"),
        measures=PATHS.replicate("control", "{target}", "{seed}"),
    log:
        PATHS.messages("replicate_{target}_{seed}"),
    priority: LONG
    resources:
        mem_mb=2000,
    params:
        **stage("replicate.replicate", *PLAN.models),
        on_rig=lambda wildcards: ON_RIG | {"target": wildcards.target},
        judgement=lambda wildcards: judgement(seed=int(wildcards.seed)),
        values=swept("epsilon", "n_c", "replicate_taps"),
        tracking=SETTINGS["tracking"],
    message:
        "Tables, sweeps and closed loops again with seed {wildcards.seed}"
    script:
        "../scripts/stage.py"


rule measure_times:
    input:
        **TRAIN_AND_TEST,
    output:
        times=PATHS.below("timing/times.json"),
        steps=PATHS.below("timing/steps.json"),
    log:
        PATHS.messages("measure_times"),
    priority: ALONE
    threads: workflow.cores
    resources:
        mem_mb=2000,
    params:
        **stage("timing.measure_times", *PLAN.models),
        models=SETTINGS["models"],
        control=SETTINGS["control"],
        tracking={key: SETTINGS["tracking"][key] for key in ("printed_gains", "pressure_limit_kpa")},
        repeats=EVALUATION["timing_repeats"],
        seed=SETTINGS["seed"],
    message:
        "Execution times, and the cost of a control step, alone on the machine"
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
        **stage("sweep.weigh", "fprc"),
        judgement=judgement("fprc"),
    message:
        "Weight contributions of the FPRC"
    script:
        "../scripts/stage.py"


SWEEP = {
    "stage": "sweep.sweep_settings",
    "sweep": "{sweep}",
    "values": lambda wildcards: swept(*SWEPT_SETTINGS[wildcards.sweep]),
    "judgement": judgement("fprc"),
    "workers": lambda wildcards, threads: threads,
    "version": lambda wildcards: stage("sweep.sweep_settings", *SWEPT[wildcards.sweep])["code"],
}

if SWEEP_CHUNKS == 1:

    rule sweep:
        input:
            **TRAIN_AND_TEST,
        output:
            results=PATHS.sweep("{sweep}"),
        log:
            PATHS.messages("sweep_{sweep}"),
        priority: LONG
        threads: workers_of
        resources:
            mem_mb=2000,
        params:
            **SWEEP,
            checkpoint=PATHS.below("sweeps/{sweep}.partial.jsonl"),
        message:
            "Sweep over {wildcards.sweep}, workers: {threads}"
        script:
            "../scripts/stage.py"

else:

    rule sweep_chunk:
        input:
            **TRAIN_AND_TEST,
        output:
            results=temp(PATHS.sweep("{sweep}_{chunk}")),
        log:
            PATHS.messages("sweep_{sweep}_{chunk}"),
        wildcard_constraints:
            chunk="|".join(map(str, range(SWEEP_CHUNKS))),
        priority: LONG
        threads: workers_of
        resources:
            mem_mb=2000,
        params:
            **SWEEP,
            chunk=lambda wildcards: int(wildcards.chunk),
            chunks=SWEEP_CHUNKS,
            checkpoint=PATHS.below("sweeps/{sweep}_{chunk}.partial.jsonl"),
        message:
            "Sweep over {wildcards.sweep}, chunk {wildcards.chunk}, workers: {threads}"
        script:
            "../scripts/stage.py"

    rule sweep_joined:
        input:
            chunks=[PATHS.sweep(f"{{sweep}}_{chunk}") for chunk in range(SWEEP_CHUNKS)],
        output:
            results=PATHS.sweep("{sweep}"),
        log:
            PATHS.messages("sweep_{sweep}"),
        localrule: True
        params:
            **stage("sweep.join_sweep"),
        message:
            "Sweep over {wildcards.sweep}: all chunks"
        script:
            "../scripts/stage.py"


rule measure_times_over_n_c:
    input:
        **TRAIN_AND_TEST,
    output:
        times=PATHS.below("timing/times_over_n_c.json"),
    log:
        PATHS.messages("measure_times_over_n_c"),
    priority: ALONE
    threads: workflow.cores
    resources:
        mem_mb=2000,
    params:
        **stage("timing.measure_times_over_n_c", *SWEPT["n_c"]),
        models=SETTINGS["models"],
        values=SETTINGS["sweeps"]["n_c"],
        repeats=EVALUATION["timing_repeats"],
        seed=SETTINGS["seed"],
    message:
        "Execution times over n_c, alone on the machine"
    script:
        "../scripts/stage.py"


rule measure_readout:
    input:
        **TRAIN_AND_TEST,
    output:
        cells=PATHS.below("readout/cells.json"),
    log:
        PATHS.messages("measure_readout"),
    priority: LONG
    # about as many cells: two splits and three readouts over each value
    threads: workers_for(6 * sum(map(len, swept("epsilon", "replicate_taps").values())))
    resources:
        mem_mb=2000,
    params:
        **stage("readout.measure_readout", "fprc", "fuzzy_linear", key="version"),
        judgement=judgement("fprc"),
        epsilon=SETTINGS["sweeps"]["epsilon"],
        n_u=SETTINGS["sweeps"]["replicate_taps"],
        workers=lambda wildcards, threads: threads,
        checkpoint=PATHS.below("readout/cells.partial.jsonl"),
    message:
        "FPRC with and without P_o, and with stand-ins for it"
    script:
        "../scripts/stage.py"
