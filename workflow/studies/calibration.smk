# Calibration of the simulated rig, and what depends on it. None of this is part of `all`.

DRAWN, BEYOND = SETTINGS["drawn"], SETTINGS["beyond"]
TARGET_NAMES = ["command", "measured"]
SURROGATE = pick(SETTINGS["calibration"], "stride", "esn_nodes")
#: The rig, and how the paper's models are judged on it, with any seed.
EVERY_SEED = {
    "on_rig": on_rig(SETTINGS),
    "judgement": judgement(SETTINGS, without="seed", models=paper_models(SETTINGS)),
}
FREE = {"paths": SETTINGS["calibration"]["free"], "ranges": SETTINGS["calibration"]["ranges"]}


rule fit_rig:
    input:
        published=PUBLISHED,
    output:
        fitted=PATHS.below("calibration/rig.yaml"),
        report=PATHS.below("calibration/fit.json"),
    log:
        PATHS.messages("fit_rig"),
    threads: workflow.cores
    resources:
        mem_mb=memory_of,
        runtime=480,
    params:
        **stage("studies.calibrate.calibrate", *MODELS, key="version"),
        **EVERY_SEED,
        calibration=SETTINGS["calibration"],
        grids=pick(SETTINGS["grids"], "epsilon", "n_c"),
        tracking=SETTINGS["tracking"],
        workers=lambda wildcards, threads: threads,
        checkpoint=placed(PATHS.below("calibration/search.partial.jsonl")),
    message:
        "Fit of the rig to Tables II and III"
    script:
        "../scripts/stage.py"


rule measure_sensitivity:
    output:
        effects=PATHS.below("calibration/sensitivity.json"),
    log:
        PATHS.messages("measure_sensitivity"),
    threads: workflow.cores
    resources:
        mem_mb=memory_of,
        runtime=240,
    params:
        **stage("studies.sensitivity.measure_sensitivity", *MODELS, key="version"),
        on_rig=on_rig(SETTINGS),
        paths=SETTINGS["calibration"]["free"],
        steps=DRAWN["sensitivity_steps"],
        seeds=SETTINGS["evaluation"]["replicate_seeds"][:2],
        how={
            "models": paper_models(SETTINGS),
            "tracking": SETTINGS["tracking"],
            "surrogate": SURROGATE,
        },
        workers=lambda wildcards, threads: threads,
        checkpoint=placed(PATHS.below("calibration/sensitivity.partial.jsonl")),
    message:
        "Sensitivity of all numbers to each parameter of the rig"
    script:
        "../scripts/stage.py"


rule sensitivity_table:
    input:
        effects=PATHS.below("calibration/sensitivity.json"),
    output:
        **PATHS.table("calibration/sensitivity"),
    log:
        PATHS.messages("sensitivity_table"),
    params:
        **stage("studies.sensitivity.tabulate_sensitivity"),
    message:
        "Sensitivity: table"
    script:
        "../scripts/stage.py"


rule sensitivity_figure:
    input:
        table=PATHS.below("calibration/sensitivity.csv"),
    output:
        **drawn(PATHS.below("calibration/sensitivity_figure")),
    log:
        PATHS.messages("sensitivity_figure"),
    params:
        **stage("studies.sensitivity.draw_sensitivity"),
    message:
        "Sensitivity: figure"
    script:
        "../scripts/stage.py"


rule measure_stop:
    output:
        judged=PATHS.below("calibration/stop.json"),
    log:
        PATHS.messages("measure_stop"),
    threads: workflow.cores
    resources:
        mem_mb=memory_of,
        runtime=60,
    params:
        **stage("studies.sensitivity.measure_stop", *MODELS, key="version"),
        **EVERY_SEED,
        seeds=SETTINGS["evaluation"]["replicate_seeds"],
        workers=lambda wildcards, threads: threads,
        checkpoint=placed(PATHS.below("calibration/stop.partial.jsonl")),
    message:
        "Errors at the stop of the actuator"
    script:
        "../scripts/stage.py"


rule stop_table:
    input:
        judged=PATHS.below("calibration/stop.json"),
    output:
        **PATHS.table("calibration/stop"),
    log:
        PATHS.messages("stop_table"),
    params:
        **stage("studies.sensitivity.tabulate_stop"),
    message:
        "Errors at the stop: table"
    script:
        "../scripts/stage.py"


rule targets_table:
    input:
        published=PUBLISHED,
        replicates=PLAN.replicates("models", TARGET_NAMES),
        controls=PLAN.replicates("control", TARGET_NAMES),
    output:
        **PATHS.table("calibration/targets"),
    log:
        PATHS.messages("targets_table"),
    params:
        **stage("studies.families.tabulate_targets"),
        names=TARGET_NAMES,
    message:
        "Commanded compared with measured pressure as the models' target"
    script:
        "../scripts/stage.py"


rule calibrate:
    input:
        PATHS.below("calibration/rig.yaml"),
        PATHS.below("calibration/fit.json"),
    localrule: True


rule sensitivity:
    input:
        PATHS.below("calibration/sensitivity.md"),
        PATHS.below("calibration/sensitivity_figure.pdf"),
        PATHS.below("calibration/stop.md"),
    localrule: True


rule targets:
    input:
        PATHS.below("calibration/targets.md"),
        PLAN.replicates("models", TARGET_NAMES),
        PLAN.replicates("control", TARGET_NAMES),
    localrule: True


rule channels_figure:
    input:
        sweep=PATHS.log("sweep"),
    output:
        **drawn(PATHS.below("calibration/channels"), statistics=True),
    log:
        PATHS.messages("channels_figure"),
    params:
        **stage("draw.draw_channels"),
    message:
        "C18: loops over the commanded and over the measured pressure"
    script:
        "../scripts/stage.py"
