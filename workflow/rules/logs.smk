# Raw logs, and what is selected from them: the hysteresis experiments of Sec. II-B and the closed
# loops of Sec. IV.

#: The models that drive the closed loops; logs that were recorded elsewhere need none.
DRIVEN_BY = (
    [PLAN.judged("sweep", model)["fitted"] for model in PLAN.feedforward] if PLAN.records else []
)


if PLAN.on_simulated_rig:

    rule record:
        output:
            raw=[PLAN.log(experiment) for experiment in EXPERIMENTS],
        log:
            f"{RESULTS}/logs/record.log",
        params:
            **plan.pick(SETTINGS, "rig", "seed"),
            stage="stages.record.record",
            code=computes(),
            signals=SETTINGS["experiments"],
            control=plan.of_pressures(SETTINGS),
        message:
            "Hysteresis experiments on the simulated rig"
        script:
            "../scripts/stage.py"

    rule track:
        input:
            models=DRIVEN_BY,
        output:
            raw=[
                PLAN.log(run_log(reference, controller))
                for reference in (*REFERENCES, DISTURBANCE)
                for controller in PLAN.controllers
            ],
        log:
            f"{RESULTS}/logs/track.log",
        params:
            **plan.pick(SETTINGS, "tracking", "control", "rig", "seed"),
            stage="stages.record.track",
            code=computes(*PLAN.feedforward),
            others=SETTINGS["models"]["others"],
        message:
            "Closed loops: every reference with every controller"
        script:
            "../scripts/stage.py"


if SETTINGS["source"] == "rig":

    rule record_on_rig:
        input:
            lambda wildcards: PLAN.driver(wildcards.name),
        output:
            raw=PLAN.log("{name}"),
        log:
            f"{RESULTS}/logs/record_on_rig_{{name}}.log",
        # no rule for a log that exists: it is neither recorded again nor overwritten
        wildcard_constraints:
            name="|".join(name for name in PLAN.every_log if name not in PLAN.existing) or "none",
        threads: workflow.cores
        params:
            stage="apparatus.command.record",
            name="{name}",
            settings=SETTINGS,
            armed=ARMED,
            model=lambda wildcards, input: next(iter(input), ""),
        message:
            "Experiment {wildcards.name} on the real rig"
        script:
            "../scripts/stage.py"


rule preprocess:
    input:
        **{experiment: PLAN.logs_of(experiment) for experiment in PLAN.experiments},
    output:
        data=[f"{RESULTS}/data/{experiment}.h5" for experiment in PLAN.experiments],
        quality=[f"{RESULTS}/quality/{experiment}.json" for experiment in PLAN.experiments],
    log:
        f"{RESULTS}/logs/preprocess.log",
    params:
        stage="experiments.data.preprocess",
        code=computes(),
        target=SETTINGS["evaluation"]["target"],
        sample_rate_hz=SETTINGS["control"]["sample_rate_hz"],
        limits=SETTINGS["quality"],
    message:
        "Quality and channels of the experiments' logs"
    script:
        "../scripts/stage.py"
