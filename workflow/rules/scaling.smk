# Cost of a rig, a cell and a job, for docs/scaling.md. None of this is part of `all`.


rule measure_scale:
    output:
        scale=PATHS.below("timing/scale.json"),
    log:
        PATHS.messages("measure_scale"),
    threads: workflow.cores
    params:
        **stage("benchmark.measure_scale", *MODELS),
        on_rig=on_rig(SETTINGS),
        judgement=judgement(SETTINGS, without="seed", models=paper_models(SETTINGS)),
        tracking=SETTINGS["tracking"],
        rigs=2,
        jobs=[100, 1000, 10000],
        ensemble=DRAWN,
        free=FREE,
        taps=[{"n_u": n_u, "n_y": n_y} for n_u in (1, 10) for n_y in (1, 10)],
        chunk=ENSEMBLE["chunk"],
        seed=SETTINGS["seed"],
    message:
        "Cost of a rig, a grid cell, a closed-loop second and a plan; takes some minutes"
    script:
        "../scripts/stage.py"


rule scaling_page:
    input:
        scale=PATHS.below("timing/scale.json"),
    log:
        PATHS.messages("scaling_page"),
    localrule: True
    params:
        **stage("documents.update_scaling_page"),
        page="docs/scaling.md",
    message:
        "docs/scaling.md: numbers from the results"
    script:
        "../scripts/stage.py"
