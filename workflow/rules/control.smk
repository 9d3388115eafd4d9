# Sec. IV: closed-loop runs on the rig, recorded as raw logs.

if PLAN.on_simulated_rig:

    rule track:
        input:
            models=[PATHS.judged("sweep", model)["fitted"] for model in PLAN.feedforward],
        output:
            raw=[PATHS.log(run_log("{reference}", controller)) for controller in PLAN.controllers],
        log:
            PATHS.messages("track_{reference}"),
        params:
            **pick(SETTINGS, "control", "rig", "seed"),
            **stage("stages.track.track", *PLAN.feedforward),
            tracking=lambda wildcards: tracking(SETTINGS, wildcards.reference),
            reference="{reference}",
            names=PLAN.feedforward,
            controllers=PLAN.controllers,
            classes=pick(SETTINGS["models"], "others"),
        message:
            "Closed loop: {wildcards.reference}"
        script:
            "../scripts/stage.py"
