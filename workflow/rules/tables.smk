# Tables I to IV, the same over further seeds, and tables that the paper does not have.

TRAINED_ON = {"2": "sweep", "3": "complex"}

#: Tables by their rules.
TABLES = {
    "configuration_table": table_spec(
        "tables/table1",
        {"published": PUBLISHED},
        **stage("stages.tabulate.tabulate_configuration"),
        models=SETTINGS["models"],
    ),
    "comparison_table": table_spec(
        "tables/table{number}",
        {
            "published": PUBLISHED,
            "errors": lambda wildcards: [
                PATHS.judged(TRAINED_ON[wildcards.number], model)["errors"] for model in PLAN.models
            ],
            "quality": [PATHS.quality(log) for log in TRAINED_ON.values()],
        },
        **stage("stages.tabulate.tabulate_comparison"),
        left_out=PLAN.left_out,
    ),
    "seeds_table": table_spec(
        "tables/table{number}_seeds",
        {"published": PUBLISHED, "replicates": PLAN.replicates("models")},
        **stage("stages.tabulate.tabulate_seeds"),
        trained_on=lambda wildcards: TRAINED_ON[wildcards.number],
    ),
    "timing_table": table_spec(
        "timing/table2_timing",
        {"published": PUBLISHED, "times": PATHS.below("timing/times.json")},
        **stage("stages.tabulate.tabulate_times"),
        left_out=PLAN.left_out,
    ),
    "tracking_table": table_spec(
        "tables/table4",
        {"published": PUBLISHED, "runs": [PATHS.log(run) for run in PLAN.runs]},
        **stage("stages.tabulate.tabulate_tracking"),
        left_out=[run for run in PLAN.every_run if run not in PLAN.contents],
        limits=SETTINGS["quality"],
        feedback=feedback_in_words(SETTINGS),
    ),
    "tracking_seeds_table": table_spec(
        "tables/table4_seeds",
        {"published": PUBLISHED, "replicates": PLAN.replicates("control")},
        **stage("stages.tabulate.tabulate_tracking_seeds"),
        feedback=feedback_in_words(SETTINGS),
    ),
}
