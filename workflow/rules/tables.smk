# Tables I and II.


rule configuration_table:
    input:
        published="config/published.yaml",
    output:
        **table("tables/table1"),
    log:
        f"{RESULTS}/logs/table1.log",
    params:
        models={**SETTINGS["models"], "shared": SETTINGS["models"]},
        code=fingerprint("fprc.stages.tabulate"),
    message:
        "Table I"
    script:
        "../scripts/configuration_table.py"


rule comparison_table:
    input:
        published="config/published.yaml",
        errors=expand("{results}/crossval/{model}.json", results=RESULTS, model=MODELS),
    output:
        **table("tables/table2"),
    log:
        f"{RESULTS}/logs/table2.log",
    params:
        code=fingerprint("fprc.stages.tabulate"),
    message:
        "Table II"
    script:
        "../scripts/comparison_table.py"


rule seeds_table:
    input:
        published="config/published.yaml",
        replicates=expand("{results}/replicates/seed_{seed}.json", results=RESULTS, seed=SEEDS),
    output:
        **table("tables/table2_seeds"),
        orders=f"{RESULTS}/tables/table2_orders.csv",
    log:
        f"{RESULTS}/logs/table2_seeds.log",
    params:
        code=fingerprint("fprc.stages.tabulate"),
    message:
        "Table II over further seeds"
    script:
        "../scripts/seeds_table.py"


rule timing_table:
    input:
        published="config/published.yaml",
        times=f"{RESULTS}/timing/times.json",
    output:
        **table("timing/table2_timing"),
    log:
        f"{RESULTS}/logs/table2_timing.log",
    params:
        code=fingerprint("fprc.stages.tabulate"),
    message:
        "Execution times of Table II"
    script:
        "../scripts/timing_table.py"
