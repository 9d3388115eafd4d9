# Sec. IV: closed-loop runs on the rig, each a raw log like any other.

TRACKING = {
    "control": SETTINGS["control"],
    "rig": SETTINGS["rig"],
    "seed": SETTINGS["seed"],
}


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
