# Tables, figures, claims and the report, made from result files. Each named output is a target.

import sys
from difflib import get_close_matches


rule draw_without_data:
    output:
        fig1=figure("fig01_actuator"),
        fig2=figure("fig02_reservoir"),
        fig3=figure("fig03_apparatus"),
        fig6=figure("fig06_esn_system"),
        fig7=figure("fig07_fprc_system"),
        table1=table("tables/table1"),
    log:
        f"{RESULTS}/logs/draw_without_data.log",
    params:
        stage="stages.tabulate.tabulate_settings",
        code=SHOWS,
        models=SETTINGS["models"],
    message:
        "Table I, and Figs. 1, 2, 3, 6 and 7, which show no data"
    script:
        "../scripts/stage.py"


rule tabulate_models:
    input:
        **{log: [PLAN.judged(log, model)["errors"] for model in PLAN.models] for log in EXPERIMENTS},
        quality=[f"{RESULTS}/quality/{log}.json" for log in EXPERIMENTS],
        made_from=PLAN.data,
    output:
        **PLAN.possible(table2=table("tables/table2"), table3=table("tables/table3")),
    log:
        f"{RESULTS}/logs/tabulate_models.log",
    params:
        stage="stages.tabulate.tabulate_models",
        code=SHOWS,
        left_out=PLAN.left_out,
    message:
        "Tables II and III"
    script:
        "../scripts/stage.py"


rule draw_loops:
    input:
        runs=[PLAN.log(run) for run in PLAN.runs],
        made_from=[*(PLAN.data if PLAN.records else []), *DRIVEN_BY],
    output:
        **PLAN.possible(
            table4=table("tables/table4"),
            fig12=figure("fig12_sine_0p2", "csv"),
            fig13=figure("fig13_sine_0p5", "csv"),
            fig14=figure("fig14_sweep", "csv"),
            fig15=figure("fig15_complex", "csv"),
            fig16=figure("fig16_loops"),
            fig17=figure("fig17_disturbance", "csv"),
        ),
    log:
        f"{RESULTS}/logs/draw_loops.log",
    params:
        stage="stages.draw.draw_loops",
        code=SHOWS,
        left_out=[run for run in PLAN.every_run if run not in PLAN.contents],
        limits=SETTINGS["quality"],
        feedback=plan.feedback_in_words(SETTINGS),
        quiet_s=SETTINGS["tracking"]["pushes"]["quiet_s"],
    message:
        "Closed loops: Table IV and Figs. 12 to 17"
    script:
        "../scripts/stage.py"


rule tabulate_times:
    input:
        times=f"{RESULTS}/timing/times.json",
        made_from=PLAN.data,
    output:
        **PLAN.possible(timing=table("timing/table2_timing")),
    log:
        f"{RESULTS}/logs/tabulate_times.log",
    params:
        stage="stages.tabulate.tabulate_times",
        code=SHOWS,
        left_out=PLAN.left_out,
    message:
        "Table II, execution times"
    script:
        "../scripts/stage.py"


rule show_seeds:
    input:
        grids=PLAN.replicates("grids") or [f"{RESULTS}/grids.json"],
        times=f"{RESULTS}/timing/times.json",
        times_over_n_c=f"{RESULTS}/timing/times_over_n_c.json",
        models=PLAN.replicates("models"),
        controls=PLAN.replicates("control"),
        made_from=PLAN.data,
    output:
        **PLAN.possible(
            seeds=sum((table(f"tables/table{n}_seeds") for n in (2, 3, 4)), []),
            fig10=figure("fig10_settings", "csv"),
            fig11=figure("fig11_taps", "csv"),
            claims=[f"{RESULTS}/claims.json", f"{RESULTS}/claims.csv"],
        ),
    log:
        f"{RESULTS}/logs/show_seeds.log",
    priority: LONG  # the execution times are measured last, and the report waits for this
    params:
        stage="stages.tabulate.show_seeds",
        code=SHOWS,
        feedback=plan.feedback_in_words(SETTINGS),
        fitted=SETTINGS["fitted"],
    message:
        "Figs. 10 and 11; Tables II to IV over further seeds, and claims C1 to C22"
    script:
        "../scripts/stage.py"


rule draw_experiments:
    input:
        **{log: f"{RESULTS}/data/{log}.h5" for log in PLAN.experiments},
        made_from=PLAN.data,
    output:
        **PLAN.possible(
            fig4=figure("fig04_hysteresis_actuator"),
            fig5=figure("fig05_hysteresis_reservoir"),
            fig9=figure("fig09_weights", "csv"),
        ),
    log:
        f"{RESULTS}/logs/draw_experiments.log",
    params:
        stage="stages.draw.draw_experiments",
        code=[computes("fprc"), SHOWS],
        validation=plan.validation(SETTINGS, "fprc"),
    message:
        "Figs. 4 and 5: hysteresis of actuator and reservoir; Fig. 9: weights of FPRC"
    script:
        "../scripts/stage.py"


rule draw_training:
    input:
        **plan.pick(PLAN.judged("sweep", "fprc"), "fits", "predictions"),
        made_from=PLAN.data,
    output:
        **PLAN.possible(fig8=figure("fig08_training", "csv")),
    log:
        f"{RESULTS}/logs/draw_training.log",
    params:
        stage="figures.hysteresis.draw_training",
        code=SHOWS,
    message:
        "Fig. 8: FPRC on its training and test logs"
    script:
        "../scripts/stage.py"


#: Rules whose named outputs are targets, in the order of the report. A target asks also for what
#: its files are made from.
SHOWN = """draw_without_data tabulate_models draw_loops tabulate_times show_seeds draw_experiments
    draw_training"""
MADE, TARGETS, CAPTIONS = {}, {}, {}
for shown in (getattr(rules, name) for name in SHOWN.split()):
    for target, files in shown.output.items():
        CAPTIONS[target] = shown.params.get("caption", "")
        MADE[target], TARGETS[target] = list(files), [*files, *shown.input]
#: Tables of the report; the claims have a place of their own.
PAGES = [file for name in MADE if name != "claims" for file in MADE[name] if file.endswith(".json")]
#: Figures of the report, with the sources of their data.
DRAWN = {
    file: PLAN.source_of(target)
    for target in sorted(MADE, key=lambda target: target[3:].zfill(2))
    for file in MADE[target]
    if file.endswith(".png")
}


rule report_page:
    input:
        ledger=[f"{RESULTS}/claims.json"] if "claims" in MADE else [],
        tables=PAGES,
        figures=list(DRAWN),
    output:
        html=f"{RESULTS}/report.html",
    log:
        f"{RESULTS}/logs/report_page.log",
    params:
        stage="stages.report.write_report",
        code=SHOWS,
        sources=list(DRAWN.values()),
        captions=CAPTIONS,
        missing={plan.title_of_result(name): why for name, why in PLAN.unavailable.items()},
        settings=SETTINGS,
    message:
        "Report: claims, tables, figures and settings on one page"
    script:
        "../scripts/stage.py"


TARGETS["report"] = [f"{RESULTS}/report.html", *sorted(set(sum(TARGETS.values(), [])))]
TARGETS["logs"] = [PLAN.log(experiment) for experiment in PLAN.experiments]

for target, files in TARGETS.items():

    rule:
        name:
            target
        input:
            files,
        localrule: True
        message:
            f"Target {target}"


for target, why in PLAN.unavailable.items():

    rule:
        name:
            target
        log:
            f"{RESULTS}/logs/{target}.log",
        localrule: True
        message:
            f"{target}: not available for this data: {plan.title_of_result(target)} {why}"
        shell:
            "exit 1"


# Snakemake itself says only that no rule makes a mistyped target. Options, their settings and files
# are no targets.
for word in sys.argv[1:]:
    if word.isalnum() and word not in ("all", *TARGETS, *PLAN.unavailable):
        for near in get_close_matches(word, TARGETS, n=1, cutoff=0.75):
            print(f"{word}: did you mean {near}?", file=sys.stderr)
