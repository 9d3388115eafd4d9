# Tables I to III.


rule configuration_table:
    input:
        published="config/published.yaml",
    output:
        **table("tables/table1"),
    log:
        f"{RESULTS}/logs/table1.log",
    params:
        models=SETTINGS["models"],
        code=code_of("configuration_table"),
    message:
        "Table I"
    script:
        "../scripts/configuration_table.py"


rule comparison_table:
    input:
        published="config/published.yaml",
        errors=lambda wildcards: expand(
            "{results}/crossval/{experiment}_{model}.json",
            results=RESULTS,
            experiment=TRAINED_ON[wildcards.number],
            model=MODELS,
        ),
    output:
        **table("tables/table{number}"),
    log:
        f"{RESULTS}/logs/table{{number}}.log",
    params:
        left_out=LEFT_OUT,
        code=code_of("comparison_table"),
    message:
        "Table {wildcards.number}"
    script:
        "../scripts/comparison_table.py"


rule seeds_table:
    input:
        published="config/published.yaml",
        replicates=REPLICATES,
    output:
        **table("tables/table{number}_seeds"),
    log:
        f"{RESULTS}/logs/table{{number}}_seeds.log",
    params:
        trained_on=lambda wildcards: TRAINED_ON[wildcards.number],
        code=code_of("seeds_table"),
    message:
        "Table {wildcards.number} over further seeds"
    script:
        "../scripts/seeds_table.py"


rule orders_table:
    input:
        replicates=REPLICATES,
    output:
        csv=f"{RESULTS}/tables/orders.csv",
    log:
        f"{RESULTS}/logs/orders.log",
    params:
        code=code_of("orders_table"),
    message:
        "Orders of Tables 2 and 3 on every seed"
    script:
        "../scripts/orders_table.py"


rule timing_table:
    input:
        published="config/published.yaml",
        times=f"{RESULTS}/timing/times.json",
    output:
        **table("timing/table2_timing"),
    log:
        f"{RESULTS}/logs/table2_timing.log",
    params:
        left_out=LEFT_OUT,
        code=code_of("timing_table"),
    message:
        "Execution times of Table II"
    script:
        "../scripts/timing_table.py"


rule tracking_table:
    input:
        published="config/published.yaml",
        gains=f"{RESULTS}/control/gains.json",
        runs=[f"{RAW}/{run}.h5" for run in RUNS],
    output:
        **table("tables/table4"),
    log:
        f"{RESULTS}/logs/table4.log",
    params:
        left_out=[run for run in ALL_RUNS if run not in HELD],
        limits=SETTINGS["quality"],
        code=code_of("tracking_table"),
    message:
        "Table 4"
    script:
        "../scripts/tracking_table.py"


rule tracking_seeds_table:
    input:
        published="config/published.yaml",
        replicates=REPLICATED_CONTROL,
    output:
        **table("tables/table4_seeds"),
    log:
        f"{RESULTS}/logs/table4_seeds.log",
    params:
        code=code_of("tracking_seeds_table"),
    message:
        "Table 4 over further seeds"
    script:
        "../scripts/tracking_seeds_table.py"


rule steps_table:
    input:
        steps=f"{RESULTS}/timing/steps.json",
    output:
        **table("timing/step_cost"),
    log:
        f"{RESULTS}/logs/step_cost.log",
    params:
        left_out=LEFT_OUT,
        code=code_of("steps_table"),
    message:
        "Cost of a control step"
    script:
        "../scripts/steps_table.py"


rule readout_table:
    input:
        cells=f"{RESULTS}/readout/cells.json",
    output:
        **table("readout/readout"),
    log:
        f"{RESULTS}/logs/readout_table.log",
    params:
        code=code_of("readout_table"),
    message:
        "What the readout is worth: table"
    script:
        "../scripts/readout_table.py"
