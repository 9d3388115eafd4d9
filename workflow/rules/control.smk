# Sec. IV: closed-loop runs on the rig, each a raw log like any other.

TRACKING = pick(SETTINGS, "control", "rig", "seed")


if PLAN.on_simulated_rig:

    rule identify_gain:
        input:
            model=PATHS.model("sweep", "fprc"),
        output:
            gains=GAINS,
        log:
            PATHS.messages("identify_gain"),
        params:
            **TRACKING,
            **stage("track.identify_gain", "fprc"),
            tracking=tracking(SETTINGS, "disturbance", "printed_gains", "candidate_kp_kpa_per_deg"),
        message:
            "Identification of the P gain on a reference outside Table IV"
        script:
            "../scripts/stage.py"

    rule track:
        input:
            models=[PATHS.model("sweep", model) for model in PLAN.feedforward],
            gains=GAINS,
        output:
            raw=[PATHS.log(run_log("{reference}", each)) for each in PLAN.controllers],
        log:
            PATHS.messages("track_{reference}"),
        params:
            **TRACKING,
            **stage("track.track", *PLAN.feedforward),
            tracking=lambda wildcards: tracking(
                SETTINGS,
                wildcards.reference,
                *(["pushes"] if wildcards.reference == "disturbance" else []),
            ),
            reference="{reference}",
            names=PLAN.feedforward,
            controllers=PLAN.controllers,
            classes=pick(SETTINGS["models"], "others"),
        message:
            "Closed loop: {wildcards.reference}"
        script:
            "../scripts/stage.py"

elif PLAN.records:

    rule identify_gain_from_logs:
        input:
            raw=[PATHS.log(name) for name in IDENTIFY],
        output:
            gains=GAINS,
        log:
            PATHS.messages("identify_gain_from_logs"),
        params:
            **stage("track.identify_gain_from_logs"),
            tracking=pick(SETTINGS["tracking"], "printed_gains"),
        message:
            "Identification of the P gain from the logs of the candidates"
        script:
            "../scripts/stage.py"

else:

    rule read_gains:
        input:
            runs=[PATHS.log(run) for run in PLAN.runs],
        output:
            gains=GAINS,
        log:
            PATHS.messages("read_gains"),
        params:
            **stage("track.read_gains"),
        message:
            "PD gains stated in the closed-loop logs"
        script:
            "../scripts/stage.py"
