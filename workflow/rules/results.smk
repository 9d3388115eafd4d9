# Tables, figures, claims and the report, made from result files. Each named output is a target.

#: Figures that show no data, by their targets.
SCHEMATICS = {
    "fig1": "fig01_actuator",
    "fig2": "fig02_reservoir",
    "fig3": "fig03_apparatus",
    "fig6": "fig06_esn_system",
    "fig7": "fig07_fprc_system",
}
#: Tables and figures of closed loops.
LOOPS = {
    "table4": table("tables/table4"),
    **{
        f"fig{number}": figure(f"fig{number}_{reference}", "csv")
        for number, reference in enumerate(REFERENCES, start=12)
    },
    "fig16": figure("fig16_loops"),
    "fig17": figure("fig17_disturbance", "csv"),
}


rule draw_without_data:
    output:
        **{target: figure(name) for target, name in SCHEMATICS.items()},
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


rule tabulate_times:
    input:
        times=f"{RESULTS}/timing/times.json",
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


rule tabulate_seeds:
    input:
        models=PLAN.replicates("models"),
        loops=PLAN.replicates("control"),
    output:
        **PLAN.possible(seeds=sum((table(f"tables/table{n}_seeds") for n in (2, 3, 4)), [])),
    log:
        f"{RESULTS}/logs/tabulate_seeds.log",
    params:
        stage="stages.tabulate.tabulate_seeds",
        code=SHOWS,
        feedback=feedback_in_words(SETTINGS),
    message:
        "Tables II to IV over further seeds"
    script:
        "../scripts/stage.py"


rule draw_hysteresis:
    input:
        **BOTH_LOGS,
    output:
        **PLAN.possible(
            fig4=figure("fig04_hysteresis_actuator"), fig5=figure("fig05_hysteresis_reservoir")
        ),
    log:
        f"{RESULTS}/logs/draw_hysteresis.log",
    params:
        stage="figures.hysteresis.draw_hysteresis",
        code=SHOWS,
    message:
        "Figs. 4 and 5: hysteresis of actuator and reservoir"
    script:
        "../scripts/stage.py"


rule draw_training:
    input:
        **pick(PLAN.judged("sweep", "fprc"), "fits", "predictions"),
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


rule draw_weights:
    input:
        train=f"{RESULTS}/data/sweep.h5",
    output:
        **PLAN.possible(fig9=figure("fig09_weights", "csv")),
    log:
        f"{RESULTS}/logs/draw_weights.log",
    params:
        stage="stages.draw.draw_weights",
        code=[computes("fprc"), SHOWS],
        validation=validation(SETTINGS, "fprc"),
    message:
        "Fig. 9: weights of FPRC"
    script:
        "../scripts/stage.py"


rule draw_grids:
    input:
        grids=PLAN.grids,
        times=f"{RESULTS}/timing/times_over_n_c.json",
    output:
        **PLAN.possible(fig10=figure("fig10_settings", "csv"), fig11=figure("fig11_taps", "csv")),
    log:
        f"{RESULTS}/logs/draw_grids.log",
    priority: LONG  # its execution times are measured last, and the report waits for it
    params:
        stage="figures.grids.draw_grids",
        code=SHOWS,
    message:
        "Figs. 10 and 11: errors and times over the settings of FPRC"
    script:
        "../scripts/stage.py"


rule draw_loops:
    input:
        runs=[f"{RAW}/{run}.h5" for run in PLAN.runs],
    output:
        **PLAN.possible(**LOOPS),
    log:
        f"{RESULTS}/logs/draw_loops.log",
    params:
        stage="stages.draw.draw_loops",
        code=SHOWS,
        left_out=[run for run in PLAN.every_run if run not in PLAN.contents],
        limits=SETTINGS["quality"],
        feedback=feedback_in_words(SETTINGS),
        quiet_s=SETTINGS["tracking"]["pushes"]["quiet_s"],
    message:
        "Closed loops: Table IV and Figs. 12 to 17"
    script:
        "../scripts/stage.py"


rule ledger:
    input:
        replicates=PLAN.replicates("models"),
        grids=PLAN.replicates("grids"),
        controls=PLAN.replicates("control"),
        times=f"{RESULTS}/timing/times.json",
        times_over_n_c=f"{RESULTS}/timing/times_over_n_c.json",
    output:
        **PLAN.possible(claims=[f"{RESULTS}/claims.json", f"{RESULTS}/claims.csv"]),
    log:
        f"{RESULTS}/logs/ledger.log",
    params:
        stage="claims.paper.write_ledger",
        code=SHOWS,
        fitted=SETTINGS["fitted"],
    message:
        "Claims C1 to C22"
    script:
        "../scripts/stage.py"


#: Rules whose named outputs are targets, in the order of the report; and what they are made from,
#: beside their inputs. Otherwise a result of an earlier run would count as complete after a job has
#: failed, since Snakemake removes only the outputs of that job.
SHOWN = {
    "draw_without_data": [],
    "tabulate_models": PLAN.data,
    "draw_loops": [*(PLAN.data if PLAN.records else []), *DRIVEN_BY],
    "tabulate_times": PLAN.data,
    "tabulate_seeds": [],
    **dict.fromkeys(
        "draw_hysteresis draw_training draw_weights draw_grids ledger".split(), PLAN.data
    ),
}
MADE, TARGETS, CAPTIONS = {}, {}, {}
for name, behind in SHOWN.items():
    shown = getattr(rules, name)
    for target, files in shown.output.items():
        CAPTIONS[target] = shown.params.get("caption", "")
        MADE[target], TARGETS[target] = list(files), [*files, *shown.input, *behind]
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
        missing={title_of_result(name): PLAN.unavailable[name] for name in PLAN.unavailable},
        settings=SETTINGS,
    message:
        "Report: claims, tables, figures and settings on one page"
    script:
        "../scripts/stage.py"


TARGETS["report"] = [f"{RESULTS}/report.html", *sorted(set(sum(TARGETS.values(), [])))]
TARGETS["logs"] = [f"{RAW}/{experiment}.h5" for experiment in PLAN.experiments]

for target, files in TARGETS.items():

    rule:
        name:
            target
        input:
            files,
        localrule: True
        message:
            f"Target {target}"


for target in PLAN.unavailable:

    rule:
        name:
            target
        log:
            f"{RESULTS}/logs/{target}.log",
        localrule: True
        message:
            PLAN.refusal(target)
        shell:
            "exit 1"
