# Tables I and II.


def table(name):
    """Return the three files of a table."""
    return {kind: f"{RESULTS}/{name}.{kind}" for kind in ("csv", "md", "tex")}


rule configuration_table:
    message:
        "Table I"
    input:
        published="config/published.yaml",
    output:
        **table("tables/table1"),
    params:
        models={**SETTINGS["models"], "shared": SETTINGS["models"]},
        code=fingerprint("fprc.stages.tabulate"),
    log:
        f"{RESULTS}/logs/table1.log",
    script:
        "../scripts/configuration_table.py"


rule comparison_table:
    message:
        "Table II"
    input:
        published="config/published.yaml",
        errors=expand("{results}/crossval/{model}.json", results=RESULTS, model=MODELS),
    output:
        **table("tables/table2"),
    params:
        code=fingerprint("fprc.stages.tabulate"),
    log:
        f"{RESULTS}/logs/table2.log",
    script:
        "../scripts/comparison_table.py"


rule seeds_table:
    message:
        "Table II over further seeds"
    input:
        published="config/published.yaml",
        replicates=expand("{results}/replicates/seed_{seed}.json", results=RESULTS, seed=SEEDS),
    output:
        **table("tables/table2_seeds"),
        orders=f"{RESULTS}/tables/table2_orders.csv",
    params:
        code=fingerprint("fprc.stages.tabulate"),
    log:
        f"{RESULTS}/logs/table2_seeds.log",
    script:
        "../scripts/seeds_table.py"


rule timing_table:
    message:
        "Execution times of Table II"
    input:
        published="config/published.yaml",
        times=f"{RESULTS}/timing/times.json",
    output:
        **table("timing/table2_timing"),
    params:
        code=fingerprint("fprc.stages.tabulate"),
    log:
        f"{RESULTS}/logs/table2_timing.log",
    script:
        "../scripts/timing_table.py"
