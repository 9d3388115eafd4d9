# The figures, drawn from result files only.


#: The runs of Figs. 12 to 15 that have logs; they share the range of the errors.
FOLLOWED = [
    run
    for number, _ in enumerate(REFERENCES, start=12)
    if f"fig{number}" not in PLAN.unavailable
    for run in BY_NAME[f"fig{number}"].logs
]


def drawing_of(name):
    """Return the PDF and the PNG of a figure that shows no data."""
    stem = Path(BY_NAME[name].files[0]).stem
    return [DRAWINGS / f"{stem}.{kind}" for kind in ("pdf", "png")]


#: What is peculiar to each figure, by its name in ``fprc.plan.results``.
ROWS = {
    **{
        name: {
            "given": {"drawing": drawing_of(name)},
            **stage("stages.copy_drawing.copy_drawing"),
        }
        for name in ("fig1", "fig2", "fig3", "fig6", "fig7")  # they show no data
    },
    "fig4": {
        "given": {log: PATHS.data(log) for log in EXPERIMENTS},
        **stage("stages.draw.draw_actuator_hysteresis"),
    },
    "fig5": {
        "given": {log: PATHS.data(log) for log in EXPERIMENTS},
        **stage("stages.draw.draw_reservoir_hysteresis"),
    },
    "fig8": {
        "given": pick(PATHS.judged("sweep", "fprc"), "fits", "predictions"),
        **stage("stages.draw.draw_training"),
        "statistics": True,
    },
    "fig9": {
        "given": {"weights": PATHS.below("weights/fprc.json"), "published": PUBLISHED},
        **stage("stages.draw.draw_weights"),
        "statistics": True,
    },
    "fig10": {
        "given": {"grids": PLAN.grids, "times": PATHS.below("timing/times_over_n_c.json")},
        **stage("stages.draw.draw_settings"),
        "statistics": True,
        "priority": LONG,  # its execution times are measured last, and the report waits for it
    },
    "fig11": {
        "given": {"grids": PLAN.grids, "published": PUBLISHED},
        **stage("stages.draw.draw_taps"),
        "statistics": True,
    },
    **{
        f"fig{number}": {
            "given": {
                "open_loop": PATHS.log(run_log(reference, "fprc")),
                "closed_loop": PATHS.log(run_log(reference, "fprc_pd")),
                "runs": [PATHS.log(run) for run in FOLLOWED],
            },
            **stage("stages.draw_tracking.draw_following"),
            "statistics": True,
        }
        for number, reference in enumerate(REFERENCES, start=12)
    },
    "fig16": {
        "given": {"runs": [PATHS.log(run) for run in BY_NAME["fig16"].logs]},
        **stage("stages.draw_tracking.draw_loops"),
    },
    "fig17": {
        "given": {"run": PATHS.log(BY_NAME["fig17"].logs[0])},
        **stage("stages.draw_tracking.draw_disturbance"),
        "statistics": True,
        "quiet_s": SETTINGS["tracking"]["pushes"]["quiet_s"],
    },
}

#: Figures by their rules.
FIGURES = {
    f"draw_{name}": figure_spec(BY_NAME[name].files[0].removesuffix(".pdf"), **row)
    for name, row in ROWS.items()
}
