# Sec. IV: closed-loop runs on the rig, each a raw log like any other.

TRACKING = {
    "control": SETTINGS["control"],
    "rig": SETTINGS["rig"],
    "seed": SETTINGS["seed"],
}


if ON_RIG:

    rule identify_gain:
        input:
            model=f"{RESULTS}/models/sweep_fprc.h5",
        output:
            gains=f"{RESULTS}/control/gains.json",
        log:
            f"{RESULTS}/logs/identify_gain.log",
        params:
            **TRACKING,
            tracking=tracking_of("disturbance", "printed_gains", "candidate_kp_kpa_per_deg"),
            code=code_of("identify_gain", "fprc"),
        message:
            "P gain with the least error on a reference outside Table IV"
        script:
            "../scripts/identify_gain.py"

    rule track:
        input:
            model=f"{RESULTS}/models/sweep_fprc.h5",
            gains=f"{RESULTS}/control/gains.json",
        output:
            raw=[tracked("{reference}", controller) for controller in CONTROLLERS],
        log:
            f"{RESULTS}/logs/track_{{reference}}.log",
        params:
            **TRACKING,
            tracking=lambda wildcards: tracking_of(
                wildcards.reference, *(["pushes"] if wildcards.reference == "disturbance" else [])
            ),
            reference="{reference}",
            controllers=CONTROLLERS,
            code=code_of("track", "fprc"),
        message:
            "Closed loop: {wildcards.reference}"
        script:
            "../scripts/track.py"

elif RECORDS:

    rule identify_gain_from_logs:
        input:
            raw=[f"{RAW}/{name}.h5" for name in IDENTIFY],
        output:
            gains=GAINS,
        log:
            f"{RESULTS}/logs/identify_gain_from_logs.log",
        params:
            tracking={"printed_gains": SETTINGS["tracking"]["printed_gains"]},
            code=code_of("identify_gain_from_logs"),
        message:
            "P gain with the least error in the logs of the candidates"
        script:
            "../scripts/identify_gain_from_logs.py"

else:

    rule read_gains:
        input:
            runs=[f"{RAW}/{run}.h5" for run in RUNS],
        output:
            gains=f"{RESULTS}/control/gains.json",
        log:
            f"{RESULTS}/logs/read_gains.log",
        params:
            code=code_of("read_gains"),
        message:
            "Gains that the closed-loop logs name"
        script:
            "../scripts/read_gains.py"
