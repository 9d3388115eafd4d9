# How the simulated rig was set, and what depends on it. None of this is part of `all`.

STANDIN = {key: SETTINGS["calibration"][key] for key in ("stride", "esn_nodes")}
CHUNKS = {
    first: list(range(first, min(first + ENSEMBLE["chunk"], ENSEMBLE["rigs"])))
    for first in range(0, ENSEMBLE["rigs"], ENSEMBLE["chunk"])
}
CHUNK_FILES = [f"{RESULTS}/ensemble/rigs_{first}.json" for first in CHUNKS]


rule fit_rig:
    input:
        published="config/published.yaml",
    output:
        fitted=f"{RESULTS}/calibration/rig.yaml",
        report=f"{RESULTS}/calibration/fit.json",
    log:
        f"{RESULTS}/logs/fit_rig.log",
    threads: workflow.cores
    params:
        **EXPERIMENTS_ON_RIG,
        **JUDGEMENT,
        models=SETTINGS["models"],
        calibration=SETTINGS["calibration"],
        workers=lambda wildcards, threads: threads,
        checkpoint=f"{RESULTS}/calibration/search.partial.jsonl",
        version=code_of("fit_rig"),
    message:
        "Fit of the rig to Tables II and III"
    script:
        "../scripts/fit_rig.py"


rule ensemble_chunk:
    output:
        rigs=f"{RESULTS}/ensemble/rigs_{{chunk}}.json",
    log:
        f"{RESULTS}/logs/ensemble_{{chunk}}.log",
    resources:
        mem_mb=2000,
    params:
        **EXPERIMENTS_ON_RIG,
        **JUDGEMENT,
        models=SETTINGS["models"],
        tracking=SETTINGS["tracking"],
        numbers=lambda wildcards: CHUNKS[int(wildcards.chunk)],
        ensemble={key: ENSEMBLE[key] for key in ("seed", "angle_deg", "p_o_swing_kpa")},
        paths=SETTINGS["calibration"]["free"],
        ranges=SETTINGS["calibration"]["ranges"],
        checkpoint=f"{RESULTS}/ensemble/rigs_{{chunk}}.partial.jsonl",
        version=code_of("ensemble_chunk"),
    message:
        "Ensemble: rigs from number {wildcards.chunk} through Tables II to IV"
    script:
        "../scripts/ensemble_chunk.py"


rule ensemble_summary:
    input:
        published="config/published.yaml",
        chunks=CHUNK_FILES,
    output:
        summary=f"{RESULTS}/ensemble/summary.json",
    log:
        f"{RESULTS}/logs/ensemble_summary.log",
    params:
        code=code_of("ensemble_summary"),
    message:
        "Ensemble: claims rig by rig"
    script:
        "../scripts/ensemble_summary.py"


rule ensemble_table:
    input:
        summary=f"{RESULTS}/ensemble/summary.json",
    output:
        **table("ensemble/claims"),
    log:
        f"{RESULTS}/logs/ensemble_table.log",
    params:
        code=code_of("ensemble_table"),
    message:
        "Ensemble: table"
    script:
        "../scripts/ensemble_table.py"


rule ensemble_figure:
    input:
        summary=f"{RESULTS}/ensemble/summary.json",
    output:
        pdf=f"{RESULTS}/ensemble/claims.pdf",
        png=f"{RESULTS}/ensemble/claims.png",
        sidecar=f"{RESULTS}/ensemble/claims.json",
    log:
        f"{RESULTS}/logs/ensemble_figure.log",
    params:
        code=code_of("ensemble_figure"),
    message:
        "Ensemble: figure"
    script:
        "../scripts/ensemble_figure.py"


rule measure_sensitivity:
    output:
        effects=f"{RESULTS}/calibration/sensitivity.json",
    log:
        f"{RESULTS}/logs/measure_sensitivity.log",
    threads: workflow.cores
    params:
        **EXPERIMENTS_ON_RIG,
        models=SETTINGS["models"],
        paths=SETTINGS["calibration"]["free"],
        steps=ENSEMBLE["sensitivity_steps"],
        seeds=SEEDS[:2],
        standin=STANDIN,
        workers=lambda wildcards, threads: threads,
        checkpoint=f"{RESULTS}/calibration/sensitivity.partial.jsonl",
        version=code_of("measure_sensitivity"),
    message:
        "Sensitivity of the errors to each parameter of the rig"
    script:
        "../scripts/measure_sensitivity.py"


rule sensitivity_table:
    input:
        effects=f"{RESULTS}/calibration/sensitivity.json",
    output:
        **table("calibration/sensitivity"),
    log:
        f"{RESULTS}/logs/sensitivity_table.log",
    params:
        code=code_of("sensitivity_table"),
    message:
        "Sensitivity: table"
    script:
        "../scripts/sensitivity_table.py"


rule targets_table:
    input:
        published="config/published.yaml",
        replicates=replicated("models", "command", "measured"),
        controls=replicated("control", "command", "measured"),
    output:
        **table("calibration/targets"),
    log:
        f"{RESULTS}/logs/targets_table.log",
    params:
        names=["command", "measured"],
        code=code_of("targets_table"),
    message:
        "Commanded against measured pressure as the models' target"
    script:
        "../scripts/targets_table.py"


rule calibration_page:
    input:
        fit="config/rig.json",
        seeds=[path.replace(".md", ".csv") for path in SEEDS_TABLES[:2]],
        pages=[
            SEEDS_TABLES[2],
            f"{RESULTS}/ensemble/claims.md",
            f"{RESULTS}/calibration/sensitivity.md",
            f"{RESULTS}/calibration/targets.md",
        ],
        figure=f"{RESULTS}/ensemble/claims.png",
        made_from=[
            *CHUNK_FILES,
            f"{RESULTS}/ensemble/summary.json",
            f"{RESULTS}/calibration/sensitivity.json",
            *replicated("models", "command", "measured"),
            *replicated("control", "command", "measured"),
        ],
    log:
        f"{RESULTS}/logs/calibration_page.log",
    localrule: True
    params:
        page="docs/calibration.md",
        picture="docs/images/ensemble.png",
        rig=SETTINGS["rig"],
        code=code_of("calibration_page"),
    message:
        "Numbers and picture of docs/calibration.md, from the results"
    script:
        "../scripts/calibration_page.py"


rule calibrate:
    input:
        f"{RESULTS}/calibration/rig.yaml",
        f"{RESULTS}/calibration/fit.json",
    localrule: True


rule ensemble:
    input:
        f"{RESULTS}/ensemble/claims.md",
        f"{RESULTS}/ensemble/claims.pdf",
        f"{RESULTS}/ensemble/summary.json",
        CHUNK_FILES,
    localrule: True


rule sensitivity:
    input:
        f"{RESULTS}/calibration/sensitivity.md",
        f"{RESULTS}/calibration/sensitivity.json",
    localrule: True


rule targets:
    input:
        f"{RESULTS}/calibration/targets.md",
        replicated("models", "command", "measured"),
        replicated("control", "command", "measured"),
    localrule: True
