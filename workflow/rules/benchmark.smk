# How fast we are beside other libraries. No part of `all`: `make benchmark` installs what it needs.

BENCHMARK = f"{RESULTS}/benchmark"
WHOLE = f"{BENCHMARK}/all.json"
#: Rules of `all`, and no others.
IN_ALL = [
    each.name
    for each in workflow.rules
    if Path(each.snakefile).stem not in ("calibration", "scaling", "benchmark")
]
SIZES = {
    "r": [100, 200, 400, 800, 1600, 3200],
    "samples": [1500, 3000, 6000, 12000, 24000],
    "clusters": [2, 4, 8, 16, 32],
    "cells": [1, 2, 4, 8],
    "workers": [1, 2],
    "rigs": [1, 2, 4, 8],
    "taps": [3, 8],
}


rule measure_benchmark:
    input:
        train=f"{RESULTS}/data/sweep.h5",
        test=f"{RESULTS}/data/complex.h5",
    output:
        report=f"{BENCHMARK}/benchmark.json",
    log:
        f"{RESULTS}/logs/measure_benchmark.log",
    threads: workflow.cores
    resources:
        mem_mb=4000,
    params:
        models=SETTINGS["models"],
        signals=SETTINGS["experiments"],
        tracking=SETTINGS["tracking"],
        control=SETTINGS["control"],
        rig=SETTINGS["rig"],
        sizes=SIZES,
        rounds=9,
        seed=SETTINGS["seed"],
        code=code_of("measure_benchmark"),
    message:
        "Speed beside other libraries, alone on the machine"
    script:
        "../scripts/measure_benchmark.py"


# Half an hour or so, and only worth it when the machine is left alone: `make benchmark-all`.
rule measure_all:
    output:
        report=WHOLE,
    log:
        f"{RESULTS}/logs/measure_all.log",
    threads: workflow.cores
    params:
        code=code_of("measure_benchmark"),
    message:
        "`all` beside the same rules with plain implementations"
    shell:
        "python tests/plain.py {output.report:q} --cores {threads} > {log:q} 2>&1"


rule benchmark_table:
    input:
        report=f"{BENCHMARK}/benchmark.json",
        rules=f"{BENCHMARK}/rules.csv",
    output:
        csv=f"{BENCHMARK}/benchmark.csv",
        growth_csv=f"{BENCHMARK}/growth.csv",
        md=f"{BENCHMARK}/benchmark.md",
        rules_md=f"{BENCHMARK}/rules.md",
    log:
        f"{RESULTS}/logs/benchmark_table.log",
    params:
        whole=WHOLE,  # no input: it is not made anew for an edit
        code=code_of("benchmark_table"),
    message:
        "Speed beside other libraries: table"
    script:
        "../scripts/benchmark_table.py"


rule benchmark_figure:
    input:
        report=f"{BENCHMARK}/benchmark.json",
    output:
        pdf=f"{BENCHMARK}/growth.pdf",
        png=f"{BENCHMARK}/growth.png",
        sidecar=f"{BENCHMARK}/growth.json",
    log:
        f"{RESULTS}/logs/benchmark_figure.log",
    params:
        code=code_of("benchmark_figure"),
    message:
        "Growth of the cost: figure"
    script:
        "../scripts/benchmark_figure.py"


rule rule_times:
    output:
        csv=f"{BENCHMARK}/rules.csv",
    log:
        f"{RESULTS}/logs/rule_times.log",
    localrule: True
    params:
        logs=f"{RESULTS}/logs",
        rules=IN_ALL,
        code=code_of("rule_times"),
    message:
        "What each rule took when it last ran"
    script:
        "../scripts/rule_times.py"


rule performance_page:
    input:
        page=f"{BENCHMARK}/benchmark.md",
        rules=f"{BENCHMARK}/rules.md",
        figure=f"{BENCHMARK}/growth.png",
    log:
        f"{RESULTS}/logs/performance_page.log",
    localrule: True
    params:
        readme="README.md",
        performance="docs/performance.md",
        picture="docs/images/growth.png",
        code=code_of("performance_page"),
    message:
        "Benchmark in README.md and docs/performance.md, from the results"
    script:
        "../scripts/performance_page.py"


rule benchmark:
    input:
        f"{BENCHMARK}/benchmark.md",
        f"{BENCHMARK}/growth.pdf",
    localrule: True
