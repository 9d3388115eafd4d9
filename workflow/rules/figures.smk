# The figures, drawn from result files only.


rule draw_fig1:
    input:
        raw=PATHS.log("sweep"),
    output:
        **figure(1),
    log:
        PATHS.messages("fig01"),
    params:
        **stage("draw_schematics.draw_actuator"),
    message:
        "Fig. 1: the bending actuator"
    script:
        "../scripts/stage.py"


rule draw_fig2:
    input:
        raw=PLAN.logs_of("sweep")[0],
    output:
        **figure(2),
    log:
        PATHS.messages("fig02"),
    params:
        **stage("draw_schematics.draw_reservoir"),
        k_in_kpa_per_deg=SETTINGS["control"]["k_in_kpa_per_deg"],
    message:
        "Fig. 2: the physical reservoir"
    script:
        "../scripts/stage.py"


rule draw_fig3:
    output:
        **figure(3),
    log:
        PATHS.messages("fig03"),
    params:
        **stage("draw_schematics.draw_apparatus"),
    message:
        "Fig. 3: the apparatus"
    script:
        "../scripts/stage.py"


rule draw_fig4:
    input:
        sweep=PATHS.data("sweep"),
        complex=PATHS.data("complex"),
    output:
        **figure(4),
    log:
        PATHS.messages("fig04"),
    params:
        **stage("draw.draw_actuator_hysteresis"),
    message:
        "Fig. 4: hysteresis of the actuator"
    script:
        "../scripts/stage.py"


rule draw_fig5:
    input:
        sweep=PATHS.data("sweep"),
        complex=PATHS.data("complex"),
    output:
        **figure(5),
    log:
        PATHS.messages("fig05"),
    params:
        **stage("draw.draw_reservoir_hysteresis"),
    message:
        "Fig. 5: hysteresis of the reservoir"
    script:
        "../scripts/stage.py"


rule draw_fig6:
    output:
        **figure(6),
    log:
        PATHS.messages("fig06"),
    params:
        **stage("draw_schematics.draw_esn_system"),
        models=settings_of("esn", SETTINGS["models"]),
    message:
        "Fig. 6: control with the ESN"
    script:
        "../scripts/stage.py"


rule draw_fig7:
    output:
        **figure(7),
    log:
        PATHS.messages("fig07"),
    params:
        **stage("draw_schematics.draw_fprc_system"),
        models=settings_of("fprc", SETTINGS["models"]),
        control=pick(SETTINGS["control"], "k_in_kpa_per_deg"),
    message:
        "Fig. 7: control with the FPRC"
    script:
        "../scripts/stage.py"


rule draw_fig8:
    input:
        fit=PATHS.prediction("sweep", "fprc", "train"),
        prediction=PATHS.prediction("sweep", "fprc", "test"),
    output:
        **figure(8, statistics=True),
    log:
        PATHS.messages("fig08"),
    params:
        **stage("draw.draw_training"),
    message:
        "Fig. 8: FPRC on training and test data"
    script:
        "../scripts/stage.py"


rule draw_training:
    input:
        fit=PATHS.prediction("sweep", "{other}", "train"),
        prediction=PATHS.prediction("sweep", "{other}", "test"),
    output:
        **drawn(PATHS.below("figures/training_{other}"), statistics=True),
    log:
        PATHS.messages("training_{other}"),
    wildcard_constraints:
        other="|".join(PLAN.others) or "none",
    params:
        **stage("draw.draw_training"),
    message:
        "{wildcards.other} on training and test data"
    script:
        "../scripts/stage.py"


rule draw_fig9:
    input:
        weights=PATHS.below("weights/fprc.json"),
        published=PUBLISHED,
    output:
        **figure(9, statistics=True),
    log:
        PATHS.messages("fig09"),
    params:
        **stage("draw.draw_weights"),
    message:
        "Fig. 9: weight contributions"
    script:
        "../scripts/stage.py"


#: On the simulated rig, errors over the settings are means over the further seeds.
GRIDS_OVER_SEEDS = PLAN.replicates("grids") if PLAN.on_simulated_rig else []


rule draw_fig10:
    input:
        **({"epsilon": PATHS.grid("epsilon")} if "fig10a" not in PLAN.unavailable else {}),
        n_c=PATHS.grid("n_c"),
        times=PATHS.below("timing/times_over_n_c.json"),
        seeds=GRIDS_OVER_SEEDS,
    output:
        **figure(10, statistics=True),
    log:
        PATHS.messages("fig10"),
    priority: LONG  # its execution times are measured last, and the report waits for it
    params:
        **stage("draw.draw_settings"),
    message:
        "Fig. 10: epsilon and n_c"
    script:
        "../scripts/stage.py"


rule draw_fig11:
    input:
        taps=PATHS.grid("taps"),
        published=PUBLISHED,
        seeds=GRIDS_OVER_SEEDS,
    output:
        **figure(11, statistics=True),
    log:
        PATHS.messages("fig11"),
    params:
        **stage("draw.draw_taps"),
    message:
        "Fig. 11: tap sizes"
    script:
        "../scripts/stage.py"


#: The runs of these figures that have logs; they share the range of the errors.
FOLLOWED = [
    run
    for number, _ in enumerate(REFERENCES, start=12)
    if f"fig{number}" not in PLAN.unavailable
    for run in BY_NAME[f"fig{number}"].logs
]

for number, reference in enumerate(REFERENCES, start=12):

    rule:
        name:
            f"draw_fig{number}"
        input:
            open_loop=PATHS.log(run_log(reference, "fprc")),
            closed_loop=PATHS.log(run_log(reference, "fprc_pd")),
            runs=[PATHS.log(run) for run in FOLLOWED],
        output:
            **figure(number, statistics=True),
        log:
            PATHS.messages(f"fig{number}"),
        params:
            **stage("draw_tracking.draw_following"),
        message:
            f"Fig. {number}: tracking {reference}"
        script:
            "../scripts/stage.py"


rule draw_fig16:
    input:
        runs=[PATHS.log(run) for run in BY_NAME["fig16"].logs],
    output:
        **figure(16),
    log:
        PATHS.messages("fig16"),
    params:
        **stage("draw_tracking.draw_loops"),
    message:
        "Fig. 16: PD against FPRC+PD"
    script:
        "../scripts/stage.py"


rule draw_fig17:
    input:
        run=PATHS.log(BY_NAME["fig17"].logs[0]),
    output:
        **figure(17, statistics=True),
    log:
        PATHS.messages("fig17"),
    params:
        **stage("draw_tracking.draw_disturbance"),
        quiet_s=SETTINGS["tracking"]["pushes"]["quiet_s"],
    message:
        "Fig. 17: the reservoir disturbed"
    script:
        "../scripts/stage.py"


rule draw_readout:
    input:
        cells=PATHS.below("readout/cells.json"),
    output:
        **drawn(PATHS.below("readout/readout")),
    log:
        PATHS.messages("readout_figure"),
    params:
        **stage("draw.draw_readout"),
    message:
        "Value of the readout: figure"
    script:
        "../scripts/stage.py"
