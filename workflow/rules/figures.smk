# The figures, drawn from result files only. Each named output is a target.

#: Figures that show no data, by their targets.
SCHEMATICS = {
    "fig1": figure("fig01_actuator"),
    "fig2": figure("fig02_reservoir"),
    "fig3": figure("fig03_apparatus"),
    "fig6": figure("fig06_esn_system"),
    "fig7": figure("fig07_fprc_system"),
}
#: Figures of closed loops.
LOOPS = {
    **{
        f"fig{number}": figure(f"fig{number}_{reference}", "csv")
        for number, reference in enumerate(REFERENCES, start=12)
    },
    "fig16": figure("fig16_loops"),
    "fig17": figure("fig17_disturbance", "csv"),
}


rule copy_schematics:
    input:
        [DRAWINGS / Path(file).name for file in sum(SCHEMATICS.values(), [])],
    output:
        **SCHEMATICS,
    log:
        PATHS.messages("copy_schematics"),
    params:
        folder=lambda wildcards, output: os.path.dirname(output.fig1[0]),
    message:
        "Figs. 1, 2, 3, 6 and 7: drawings without data"
    shell:
        "cp {input:q} {params.folder:q} 2> {log:q}"


rule draw_hysteresis:
    input:
        **{log: PATHS.data(log) for log in EXPERIMENTS},
        made_from=PLAN.data,
    output:
        **PLAN.possible(
            fig4=figure("fig04_hysteresis_actuator"), fig5=figure("fig05_hysteresis_reservoir")
        ),
    log:
        PATHS.messages("draw_hysteresis"),
    params:
        stage="stages.draw.draw_hysteresis",
        code=SHOWS,
    message:
        "Figs. 4 and 5: hysteresis of actuator and reservoir"
    script:
        "../scripts/stage.py"


rule draw_training:
    input:
        **pick(PATHS.judged("sweep", "fprc"), "fits", "predictions"),
        made_from=PLAN.data,
    output:
        **PLAN.possible(fig8=figure("fig08_training", "csv")),
    log:
        PATHS.messages("draw_training"),
    params:
        stage="stages.draw.draw_training",
        code=SHOWS,
    message:
        "Fig. 8: FPRC on its training and test logs"
    script:
        "../scripts/stage.py"


rule draw_weights:
    input:
        weights=PATHS.below("weights/fprc.json"),
        published=PUBLISHED,
        made_from=PLAN.data,
    output:
        **PLAN.possible(fig9=figure("fig09_weights", "csv")),
    log:
        PATHS.messages("draw_weights"),
    params:
        stage="stages.draw.draw_weights",
        code=SHOWS,
    message:
        "Fig. 9: weights of FPRC"
    script:
        "../scripts/stage.py"


rule draw_settings:
    input:
        grids=PLAN.grids,
        times=PATHS.below("timing/times_over_n_c.json"),
        made_from=PLAN.data,
    output:
        **PLAN.possible(fig10=figure("fig10_settings", "csv")),
    log:
        PATHS.messages("draw_settings"),
    priority: LONG  # its execution times are measured last, and the report waits for it
    params:
        stage="stages.draw.draw_settings",
        code=SHOWS,
    message:
        "Fig. 10: errors and times over the settings of FPRC"
    script:
        "../scripts/stage.py"


rule draw_taps:
    input:
        grids=PLAN.grids,
        published=PUBLISHED,
        made_from=PLAN.data,
    output:
        **PLAN.possible(fig11=figure("fig11_taps", "csv")),
    log:
        PATHS.messages("draw_taps"),
    params:
        stage="stages.draw.draw_taps",
        code=SHOWS,
    message:
        "Fig. 11: errors over the numbers of taps"
    script:
        "../scripts/stage.py"


rule draw_tracking:
    input:
        runs=[PATHS.log(run) for run in PLAN.runs_of(*LOOPS)],
        made_from=[*DRIVEN_BY, *PLAN.data] if PLAN.records else [],
    output:
        **PLAN.possible(**LOOPS),
    log:
        PATHS.messages("draw_tracking"),
    params:
        stage="stages.draw_tracking.draw_tracking",
        code=SHOWS,
        quiet_s=SETTINGS["tracking"]["pushes"]["quiet_s"],
    message:
        "Figs. 12 to 17: closed loops"
    script:
        "../scripts/stage.py"


SHOWN += [
    rules.copy_schematics,
    rules.draw_hysteresis,
    rules.draw_training,
    rules.draw_weights,
    rules.draw_settings,
    rules.draw_taps,
    rules.draw_tracking,
]
