# Sec. II-B: the two hysteresis experiments, recorded and checked.


if SETTINGS["source"] == "sim":

    rule record:
        output:
            raw=f"{RAW}/{{experiment}}.h5",
        log:
            f"{RESULTS}/logs/record_{{experiment}}.log",
        params:
            experiment="{experiment}",
            signal=lambda wildcards: SETTINGS["experiments"][wildcards.experiment],
            control=SETTINGS["control"],
            rig=SETTINGS["rig"],
            seed=SETTINGS["seed"],
            code=code_of("record"),
        message:
            "Experiment {wildcards.experiment} on the simulated rig"
        script:
            "../scripts/record.py"


if SETTINGS["source"] == "hardware":

    rule record_on_rig:
        input:
            lambda wildcards: needed_on_rig(wildcards.name),
        output:
            raw=f"{RAW}/{{name}}.h5",
        log:
            f"{RESULTS}/logs/record_on_rig_{{name}}.log",
        # a log that is there has no rule: nothing runs again on it, nothing overwrites it
        wildcard_constraints:
            name="|".join(name for name in RIG_LOGS if not exists(name)) or "none",
        threads: workflow.cores
        params:
            name="{name}",
            settings=SETTINGS,
            armed=ARMED,
            model=f"{RESULTS}/models/sweep_fprc.h5",
            gains=GAINS,
        message:
            "Experiment {wildcards.name} on the real rig"
        script:
            "../scripts/record_on_rig.py"


if DRIVEN:

    rule add_reservoir:
        input:
            raw=f"{RAW}/{{experiment}}.h5",
        output:
            driven=f"{RESULTS}/reservoir/{{experiment}}.h5",
        log:
            f"{RESULTS}/logs/add_reservoir_{{experiment}}.log",
        params:
            experiment="{experiment}",
            sample_rate_hz=SETTINGS["control"]["sample_rate_hz"],
            rate_tolerance=SETTINGS["quality"]["rate_tolerance"],
            zero_deg=SETTINGS["evaluation"]["reservoir_zero_deg"],
            control=SETTINGS["control"],
            rig=SETTINGS["rig"],
            seed=SETTINGS["seed"],
            code=code_of("add_reservoir"),
        message:
            "Simulated reservoir, driven by theta of the {wildcards.experiment} log"
        script:
            "../scripts/add_reservoir.py"


rule preprocess:
    input:
        raw=complete("{experiment}"),
    output:
        data=f"{RESULTS}/data/{{experiment}}.h5",
        quality=f"{RESULTS}/quality/{{experiment}}.json",
    log:
        f"{RESULTS}/logs/preprocess_{{experiment}}.log",
    params:
        experiment="{experiment}",
        target=SETTINGS["evaluation"]["target"],
        sample_rate_hz=SETTINGS["control"]["sample_rate_hz"],
        limits=SETTINGS["quality"],
        code=code_of("preprocess"),
    message:
        "Quality and channels of the {wildcards.experiment} log"
    script:
        "../scripts/preprocess.py"
