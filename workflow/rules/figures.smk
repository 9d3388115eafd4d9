# The figures, drawn from result files only.


#: The runs of Figs. 12 to 15 that have logs; they share the range of the errors.
FOLLOWED = [
    run
    for number, _ in enumerate(REFERENCES, start=12)
    if f"fig{number}" not in PLAN.unavailable
    for run in BY_NAME[f"fig{number}"].logs
]


def drawing_of(number):
    """Return the PDF and the PNG of a figure that shows no data."""
    stem = Path(BY_NAME[f"fig{number}"].files[0]).stem
    return [DRAWINGS / f"{stem}.{kind}" for kind in ("pdf", "png")]


#: The paper's figures by their numbers.
PAPER_FIGURES = {
    **{
        number: {
            "given": {"drawing": drawing_of(number)},
            **stage("copy_drawing.copy_drawing"),
        }
        for number in (1, 2, 3, 6, 7)  # they show no data
    },
    4: {
        "given": {log: PATHS.data(log) for log in EXPERIMENTS},
        **stage("draw.draw_actuator_hysteresis"),
    },
    5: {
        "given": {log: PATHS.data(log) for log in EXPERIMENTS},
        **stage("draw.draw_reservoir_hysteresis"),
    },
    8: {
        "given": pick(PATHS.judged("sweep", "fprc"), "fits", "predictions"),
        **stage("draw.draw_training"),
        "statistics": True,
    },
    9: {
        "given": {"weights": PATHS.below("weights/fprc.json"), "published": PUBLISHED},
        **stage("draw.draw_weights"),
        "statistics": True,
    },
    10: {
        "given": {"grids": PLAN.grids, "times": PATHS.below("timing/times_over_n_c.json")},
        **stage("draw.draw_settings"),
        "statistics": True,
        "priority": LONG,  # its execution times are measured last, and the report waits for it
    },
    11: {
        "given": {"grids": PLAN.grids, "published": PUBLISHED},
        **stage("draw.draw_taps"),
        "statistics": True,
    },
    **{
        number: {
            "given": {
                "open_loop": PATHS.log(run_log(reference, "fprc")),
                "closed_loop": PATHS.log(run_log(reference, "fprc_pd")),
                "runs": [PATHS.log(run) for run in FOLLOWED],
            },
            **stage("draw_tracking.draw_following"),
            "statistics": True,
        }
        for number, reference in enumerate(REFERENCES, start=12)
    },
    16: {
        "given": {"runs": [PATHS.log(run) for run in BY_NAME["fig16"].logs]},
        **stage("draw_tracking.draw_loops"),
    },
    17: {
        "given": {"run": PATHS.log(BY_NAME["fig17"].logs[0])},
        **stage("draw_tracking.draw_disturbance"),
        "statistics": True,
        "quiet_s": SETTINGS["tracking"]["pushes"]["quiet_s"],
    },
}

#: Figures by their rules.
FIGURES = {
    **{
        f"draw_fig{number}": paper_figure_spec(number, **PAPER_FIGURES[number])
        for number in PAPER_FIGURES
    },
    "draw_training": figure_spec(
        "figures/training_{other}",
        pick(PATHS.judged("sweep", "{other}"), "fits", "predictions"),
        **stage("draw.draw_training"),
        statistics=True,
    ),
}
