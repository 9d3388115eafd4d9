# Speed compared with other libraries. Not part of `all`; `make benchmark` installs the libraries.

BENCHMARK = PATHS.below("benchmark")
WHOLE = f"{BENCHMARK}/all.json"
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
        train=PATHS.below("data/sweep.h5"),
        test=PATHS.below("data/complex.h5"),
    output:
        report=f"{BENCHMARK}/benchmark.json",
    log:
        PATHS.messages("measure_benchmark"),
    threads: workflow.cores
    resources:
        mem_mb=4000,
    params:
        **stage("benchmark.measure_benchmark", *MODELS),
        models=paper_models(SETTINGS),
        on_rig=on_rig(SETTINGS),
        tracking=SETTINGS["tracking"],
        sizes=SIZES,
        rounds=9,
        seed=SETTINGS["seed"],
    message:
        "Speed compared with other libraries (no other job runs meanwhile)"
    script:
        "../scripts/stage.py"


# Takes about half an hour, and the machine must be idle: `make benchmark-all`.
rule measure_all:
    output:
        report=WHOLE,
    log:
        PATHS.messages("measure_all"),
    threads: workflow.cores
    params:
        code=code_of("benchmark.measure_benchmark", *MODELS),
    message:
        "Time of `all` compared with the same rules in plain implementations"
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
        PATHS.messages("benchmark_table"),
    params:
        **stage("show_benchmark.tabulate_benchmark"),
        whole=placed(WHOLE),  # not an input, so that an edit does not rerun it
    message:
        "Speed compared with other libraries: table"
    script:
        "../scripts/stage.py"


rule benchmark_figure:
    input:
        report=f"{BENCHMARK}/benchmark.json",
    output:
        **drawn(f"{BENCHMARK}/growth"),
    log:
        PATHS.messages("benchmark_figure"),
    params:
        **stage("show_benchmark.draw_benchmark"),
    message:
        "Growth of the cost: figure"
    script:
        "../scripts/stage.py"


rule rule_times:
    output:
        csv=f"{BENCHMARK}/rules.csv",
    log:
        PATHS.messages("rule_times"),
    localrule: True
    params:
        **stage("show_benchmark.tabulate_rules"),
        files=[*map(placed, TARGETS["report"])],
    message:
        "Time of the last run of each rule"
    script:
        "../scripts/stage.py"


rule performance_page:
    input:
        page=f"{BENCHMARK}/benchmark.md",
        rules=f"{BENCHMARK}/rules.md",
        figure=f"{BENCHMARK}/growth.png",
    log:
        PATHS.messages("performance_page"),
    localrule: True
    params:
        **stage("documents.update_performance"),
        performance="docs/performance.md",
        picture="docs/images/growth.png",
    message:
        "docs/performance.md: benchmark from the results"
    script:
        "../scripts/stage.py"


rule benchmark:
    input:
        f"{BENCHMARK}/benchmark.md",
        f"{BENCHMARK}/growth.pdf",
    localrule: True
