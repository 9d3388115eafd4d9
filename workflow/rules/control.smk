# Sec. IV: closed-loop runs on the rig, recorded as raw logs.

TRACKED = [*REFERENCES, DISTURBANCE]
#: The models that drive the runs; logs that were recorded elsewhere need none.
DRIVEN_BY = (
    [PATHS.judged("sweep", model)["fitted"] for model in PLAN.feedforward] if PLAN.records else []
)


if PLAN.on_simulated_rig:

    rule track:
        input:
            models=DRIVEN_BY,
        output:
            raw=[
                PATHS.log(run_log(reference, controller))
                for reference in TRACKED
                for controller in PLAN.controllers
            ],
        log:
            PATHS.messages("track"),
        params:
            **pick(SETTINGS, "tracking", "control", "rig", "seed"),
            stage="stages.track.track",
            code=computes(*PLAN.feedforward),
            references=TRACKED,
            names=PLAN.feedforward,
            controllers=PLAN.controllers,
            classes=pick(SETTINGS["models"], "others"),
        message:
            "Closed loops: every reference with every controller"
        script:
            "../scripts/stage.py"
