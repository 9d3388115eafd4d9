# What a rig, a cell and a job cost, for docs/scaling.md. None of this is part of `all`.


rule measure_scale:
    output:
        scale=f"{RESULTS}/timing/scale.json",
    log:
        f"{RESULTS}/logs/measure_scale.log",
    threads: workflow.cores
    params:
        **EXPERIMENTS_ON_RIG,
        **JUDGEMENT,
        models=SETTINGS["models"],
        tracking=SETTINGS["tracking"],
        rigs=2,
        jobs=[100, 1000, 10000],
        ensemble={key: ENSEMBLE[key] for key in ("seed", "angle_deg", "p_o_swing_kpa")},
        paths=SETTINGS["calibration"]["free"],
        ranges=SETTINGS["calibration"]["ranges"],
        taps=[{"n_u": n_u, "n_y": n_y} for n_u in (1, 10) for n_y in (1, 10)],
        chunk=ENSEMBLE["chunk"],
        seed=SETTINGS["seed"],
        code=code_of("measure_scale"),
    message:
        "Cost of a rig, a sweep cell, a closed-loop second and a plan; alone, some minutes"
    script:
        "../scripts/measure_scale.py"


rule scaling_page:
    input:
        scale=f"{RESULTS}/timing/scale.json",
    log:
        f"{RESULTS}/logs/scaling_page.log",
    localrule: True
    params:
        page="docs/scaling.md",
        code=code_of("scaling_page"),
    message:
        "Numbers of docs/scaling.md, from the results"
    script:
        "../scripts/scaling_page.py"
