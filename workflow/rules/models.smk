# Sec. III-D: cross-validation, test and execution times of the three models.
# The log that trains names a result's file; the reversed data set trains on `complex`.

JUDGEMENT = {
    "folds": SETTINGS["evaluation"]["folds"],
    "split": SETTINGS["evaluation"]["split"],
}

#: Models of each sweep, which decide on the code and the settings that it depends on.
SWEPT = {"epsilon": ["fprc"], "n_c": ["fprc", "fuzzy_linear"], "taps": ["fprc"]}
VALUES = {"epsilon": ["epsilon"], "n_c": ["n_c"], "taps": ["n_u", "n_y"]}


#: Priorities: of what takes long or is waited for, so that it is not left to the end, and of what
#: wants the whole machine, which begins as soon as no job runs. The scheduler adds up what it begins
#: at once: one that is alone outweighs a long one on every core.
LONG, ALONE = 1, workflow.cores + 1


rule judge:
    input:
        **{log: f"{RESULTS}/data/{log}.h5" for log in EXPERIMENTS},
    output:
        errors=[f"{RESULTS}/crossval/{log}_{{model}}.json" for log in EXPERIMENTS],
        fitted=[f"{RESULTS}/models/{log}_{{model}}.h5" for log in EXPERIMENTS],
        fits=[f"{RESULTS}/predictions/{log}_{{model}}_train.h5" for log in EXPERIMENTS],
        predictions=[f"{RESULTS}/predictions/{log}_{{model}}_test.h5" for log in EXPERIMENTS],
    log:
        f"{RESULTS}/logs/judge_{{model}}.log",
    resources:
        mem_mb=2000,
    params:
        **JUDGEMENT,
        models=lambda wildcards: settings_of(wildcards.model),
        name="{model}",
        seed=SETTINGS["seed"],
        code=lambda wildcards: code_of("judge", wildcards.model),
    message:
        "Cross-validation and test of {wildcards.model}, and with the logs reversed"
    script:
        "../scripts/judge.py"


rule replicate:
    output:
        compared=f"{RESULTS}/replicates/{{target}}/models_{{seed}}.json",
        cells=f"{RESULTS}/replicates/{{target}}/sweeps_{{seed}}.json",
        measures=f"{RESULTS}/replicates/{{target}}/control_{{seed}}.json",
    log:
        f"{RESULTS}/logs/replicate_{{target}}_{{seed}}.log",
    priority: LONG
    resources:
        mem_mb=2000,
    params:
        **JUDGEMENT,
        **EXPERIMENTS_ON_RIG | {"target": "{target}"},
        models=SETTINGS["models"],
        values=swept("epsilon", "n_c", "replicate_taps"),
        tracking=SETTINGS["tracking"],
        seed=lambda wildcards: int(wildcards.seed),
        code=code_of("replicate"),
    message:
        "Tables, sweeps and closed loops again with seed {wildcards.seed}"
    script:
        "../scripts/replicate.py"


rule measure_times:
    input:
        train=f"{RESULTS}/data/sweep.h5",
        test=f"{RESULTS}/data/complex.h5",
    output:
        times=f"{RESULTS}/timing/times.json",
        steps=f"{RESULTS}/timing/steps.json",
    log:
        f"{RESULTS}/logs/measure_times.log",
    priority: ALONE
    threads: workflow.cores
    resources:
        mem_mb=2000,
    params:
        models=SETTINGS["models"],
        control=SETTINGS["control"],
        tracking={key: SETTINGS["tracking"][key] for key in ("printed_gains", "pressure_limit_kpa")},
        repeats=SETTINGS["evaluation"]["timing_repeats"],
        seed=SETTINGS["seed"],
        code=code_of("measure_times"),
    message:
        "Execution times, and the cost of a control step, alone on the machine"
    script:
        "../scripts/measure_times.py"


rule weigh:
    input:
        train=f"{RESULTS}/data/sweep.h5",
    output:
        weights=f"{RESULTS}/weights/fprc.json",
    log:
        f"{RESULTS}/logs/weigh.log",
    params:
        **JUDGEMENT,
        models=settings_of("fprc"),
        seed=SETTINGS["seed"],
        code=code_of("weigh", "fprc"),
    message:
        "Weight contributions of the FPRC"
    script:
        "../scripts/weigh.py"


SWEEP = {
    **JUDGEMENT,
    "models": settings_of("fprc"),
    "sweep": "{sweep}",
    "values": lambda wildcards: swept(*VALUES[wildcards.sweep]),
    "seed": SETTINGS["seed"],
    "workers": lambda wildcards, threads: threads,
    "version": lambda wildcards: code_of("sweep", *SWEPT[wildcards.sweep]),
}

if SWEEP_CHUNKS == 1:

    rule sweep:
        input:
            train=f"{RESULTS}/data/sweep.h5",
            test=f"{RESULTS}/data/complex.h5",
        output:
            results=f"{RESULTS}/sweeps/{{sweep}}.json",
        log:
            f"{RESULTS}/logs/sweep_{{sweep}}.log",
        priority: LONG
        threads: workers_of
        resources:
            mem_mb=2000,
        params:
            **SWEEP,
            checkpoint=f"{RESULTS}/sweeps/{{sweep}}.partial.jsonl",
        message:
            "Sweep over {wildcards.sweep}, workers: {threads}"
        script:
            "../scripts/sweep.py"

else:

    rule sweep_chunk:
        input:
            train=f"{RESULTS}/data/sweep.h5",
            test=f"{RESULTS}/data/complex.h5",
        output:
            results=temp(f"{RESULTS}/sweeps/{{sweep}}_{{chunk}}.json"),
        log:
            f"{RESULTS}/logs/sweep_{{sweep}}_{{chunk}}.log",
        wildcard_constraints:
            chunk=r"\d+",
        priority: LONG
        threads: workers_of
        resources:
            mem_mb=2000,
        params:
            **SWEEP,
            chunk=lambda wildcards: int(wildcards.chunk),
            chunks=SWEEP_CHUNKS,
            checkpoint=f"{RESULTS}/sweeps/{{sweep}}_{{chunk}}.partial.jsonl",
        message:
            "Sweep over {wildcards.sweep}, chunk {wildcards.chunk}, workers: {threads}"
        script:
            "../scripts/sweep.py"

    rule sweep_joined:
        input:
            chunks=[f"{RESULTS}/sweeps/{{sweep}}_{chunk}.json" for chunk in range(SWEEP_CHUNKS)],
        output:
            results=f"{RESULTS}/sweeps/{{sweep}}.json",
        log:
            f"{RESULTS}/logs/sweep_{{sweep}}.log",
        localrule: True
        params:
            code=code_of("join_sweep"),
        message:
            "Sweep over {wildcards.sweep}: all chunks"
        script:
            "../scripts/join_sweep.py"


rule measure_times_over_n_c:
    input:
        train=f"{RESULTS}/data/sweep.h5",
        test=f"{RESULTS}/data/complex.h5",
    output:
        times=f"{RESULTS}/timing/times_over_n_c.json",
    log:
        f"{RESULTS}/logs/measure_times_over_n_c.log",
    priority: ALONE
    threads: workflow.cores
    resources:
        mem_mb=2000,
    params:
        models=SETTINGS["models"],
        values=SETTINGS["sweeps"]["n_c"],
        repeats=SETTINGS["evaluation"]["timing_repeats"],
        seed=SETTINGS["seed"],
        code=code_of("measure_times_over_n_c", "fprc", "fuzzy_linear"),
    message:
        "Execution times over n_c, alone on the machine"
    script:
        "../scripts/measure_times_over_n_c.py"


rule measure_readout:
    input:
        train=f"{RESULTS}/data/sweep.h5",
        test=f"{RESULTS}/data/complex.h5",
    output:
        cells=f"{RESULTS}/readout/cells.json",
    log:
        f"{RESULTS}/logs/measure_readout.log",
    priority: LONG
    # about as many cells: two splits and three readouts over each value
    threads: workers_for(6 * sum(map(len, swept("epsilon", "replicate_taps").values())))
    resources:
        mem_mb=2000,
    params:
        models=settings_of("fprc"),
        epsilon=SETTINGS["sweeps"]["epsilon"],
        n_u=SETTINGS["sweeps"]["replicate_taps"],
        folds=SETTINGS["evaluation"]["folds"],
        seed=SETTINGS["seed"],
        workers=lambda wildcards, threads: threads,
        checkpoint=f"{RESULTS}/readout/cells.partial.jsonl",
        version=code_of("measure_readout", "fprc", "fuzzy_linear"),
    message:
        "FPRC with and without P_o, and with stand-ins for it"
    script:
        "../scripts/measure_readout.py"
