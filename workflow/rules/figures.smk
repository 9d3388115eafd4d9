# The figures, drawn from result files only.


#: On the simulated rig, errors over the settings are means over the further seeds.
GRIDS_OVER_SEEDS = PLAN.replicates("grids") if PLAN.on_simulated_rig else []

#: The runs of Figs. 12 to 15 that have logs; they share the range of the errors.
FOLLOWED = [
    run
    for number, _ in enumerate(REFERENCES, start=12)
    if f"fig{number}" not in PLAN.unavailable
    for run in BY_NAME[f"fig{number}"].logs
]

#: The paper's figures by their numbers.
FIGURES = {
    1: figure_spec(
        "the bending actuator",
        {"raw": PATHS.log("sweep")},
        **stage("draw_schematics.draw_actuator"),
    ),
    2: figure_spec(
        "the physical reservoir",
        {"raw": PLAN.logs_of("sweep")[0]},
        **stage("draw_schematics.draw_reservoir"),
        k_in_kpa_per_deg=SETTINGS["control"]["k_in_kpa_per_deg"],
    ),
    3: figure_spec("the apparatus", **stage("draw_schematics.draw_apparatus")),
    4: figure_spec(
        "hysteresis of the actuator",
        {log: PATHS.data(log) for log in EXPERIMENTS},
        **stage("draw.draw_actuator_hysteresis"),
    ),
    5: figure_spec(
        "hysteresis of the reservoir",
        {log: PATHS.data(log) for log in EXPERIMENTS},
        **stage("draw.draw_reservoir_hysteresis"),
    ),
    6: figure_spec(
        "control with the ESN",
        **stage("draw_schematics.draw_esn_system"),
        models=settings_of("esn", SETTINGS["models"]),
    ),
    7: figure_spec(
        "control with the FPRC",
        **stage("draw_schematics.draw_fprc_system"),
        models=settings_of("fprc", SETTINGS["models"]),
        control=pick(SETTINGS["control"], "k_in_kpa_per_deg"),
    ),
    8: figure_spec(
        "FPRC on training and test data",
        {
            "fit": PATHS.prediction("sweep", "fprc", "train"),
            "prediction": PATHS.prediction("sweep", "fprc", "test"),
        },
        **stage("draw.draw_training"),
        statistics=True,
    ),
    9: figure_spec(
        "weight contributions",
        {"weights": PATHS.below("weights/fprc.json"), "published": PUBLISHED},
        **stage("draw.draw_weights"),
        statistics=True,
    ),
    10: figure_spec(
        "epsilon and n_c",
        {
            **({"epsilon": PATHS.grid("epsilon")} if "fig10a" not in PLAN.unavailable else {}),
            "n_c": PATHS.grid("n_c"),
            "times": PATHS.below("timing/times_over_n_c.json"),
            "seeds": GRIDS_OVER_SEEDS,
        },
        **stage("draw.draw_settings"),
        statistics=True,
        priority=LONG,  # its execution times are measured last, and the report waits for it
    ),
    11: figure_spec(
        "tap sizes",
        {"taps": PATHS.grid("taps"), "published": PUBLISHED, "seeds": GRIDS_OVER_SEEDS},
        **stage("draw.draw_taps"),
        statistics=True,
    ),
    **{
        number: figure_spec(
            f"tracking {reference}",
            {
                "open_loop": PATHS.log(run_log(reference, "fprc")),
                "closed_loop": PATHS.log(run_log(reference, "fprc_pd")),
                "runs": [PATHS.log(run) for run in FOLLOWED],
            },
            **stage("draw_tracking.draw_following"),
            statistics=True,
        )
        for number, reference in enumerate(REFERENCES, start=12)
    },
    16: figure_spec(
        "PD against FPRC+PD",
        {"runs": [PATHS.log(run) for run in BY_NAME["fig16"].logs]},
        **stage("draw_tracking.draw_loops"),
    ),
    17: figure_spec(
        "the reservoir disturbed",
        {"run": PATHS.log(BY_NAME["fig17"].logs[0])},
        **stage("draw_tracking.draw_disturbance"),
        statistics=True,
        quiet_s=SETTINGS["tracking"]["pushes"]["quiet_s"],
    ),
}

for number, shown in FIGURES.items():

    rule:
        name:
            f"draw_fig{number}"
        input:
            **shown.given,
        output:
            **figure(number, shown.statistics),
        log:
            PATHS.messages(f"fig{number:02}"),
        priority: shown.priority
        params:
            **shown.params,
        message:
            f"Fig. {number}: {shown.words}"
        script:
            "../scripts/stage.py"


rule draw_training:
    input:
        fit=PATHS.prediction("sweep", "{other}", "train"),
        prediction=PATHS.prediction("sweep", "{other}", "test"),
    output:
        **figure_files(PATHS.below("figures/training_{other}"), statistics=True),
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


rule draw_readout:
    input:
        cells=PATHS.below("readout/cells.json"),
    output:
        **figure_files(PATHS.below("readout/readout")),
    log:
        PATHS.messages("readout_figure"),
    params:
        **stage("draw.draw_readout"),
    message:
        "Value of the readout: figure"
    script:
        "../scripts/stage.py"
