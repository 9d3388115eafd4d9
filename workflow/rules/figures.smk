# The figures, drawn from result files only.


#: The runs of Figs. 12 to 15 that have logs; they share the range of the errors.
FOLLOWED = [
    run
    for number, _ in enumerate(REFERENCES, start=12)
    if f"fig{number}" not in PLAN.unavailable
    for run in BY_NAME[f"fig{number}"].logs
]

#: The figures that show no data.
DRAWN = {
    1: "the bending actuator",
    2: "the physical reservoir",
    3: "the apparatus",
    6: "control with the ESN",
    7: "control with the FPRC",
}


def drawing_of(number):
    """Return the PDF and the PNG of a figure that shows no data."""
    stem = Path(BY_NAME[f"fig{number}"].files[0]).stem
    return [DRAWINGS / f"{stem}.{kind}" for kind in ("pdf", "png")]


#: The paper's figures by their numbers.
PAPER_FIGURES = {
    **{
        number: {
            "words": words,
            "given": {"drawing": drawing_of(number)},
            **stage("copy_drawing.copy_drawing"),
        }
        for number, words in DRAWN.items()
    },
    4: {
        "words": "hysteresis of the actuator",
        "given": {log: PATHS.data(log) for log in EXPERIMENTS},
        **stage("draw.draw_actuator_hysteresis"),
    },
    5: {
        "words": "hysteresis of the reservoir",
        "given": {log: PATHS.data(log) for log in EXPERIMENTS},
        **stage("draw.draw_reservoir_hysteresis"),
    },
    8: {
        "words": "FPRC on training and test data",
        "given": pick(PATHS.judged("sweep", "fprc"), "fits", "predictions"),
        **stage("draw.draw_training"),
        "statistics": True,
    },
    9: {
        "words": "weight contributions",
        "given": {"weights": PATHS.below("weights/fprc.json"), "published": PUBLISHED},
        **stage("draw.draw_weights"),
        "statistics": True,
    },
    10: {
        "words": "epsilon and n_c",
        "given": {"grids": PLAN.grids, "times": PATHS.below("timing/times_over_n_c.json")},
        **stage("draw.draw_settings"),
        "statistics": True,
        "priority": LONG,  # its execution times are measured last, and the report waits for it
    },
    11: {
        "words": "tap sizes",
        "given": {"grids": PLAN.grids, "published": PUBLISHED},
        **stage("draw.draw_taps"),
        "statistics": True,
    },
    **{
        number: {
            "words": f"tracking {reference}",
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
        "words": "PD against FPRC+PD",
        "given": {"runs": [PATHS.log(run) for run in BY_NAME["fig16"].logs]},
        **stage("draw_tracking.draw_loops"),
    },
    17: {
        "words": "the reservoir disturbed",
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
        "{wildcards.other} on training and test data",
        pick(PATHS.judged("sweep", "{other}"), "fits", "predictions"),
        **stage("draw.draw_training"),
        statistics=True,
    ),
}
