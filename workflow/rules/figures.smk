# Figures 4, 5 and 8.


rule actuator_hysteresis:
    input:
        sweep=f"{RESULTS}/data/sweep.h5",
        complex=f"{RESULTS}/data/complex.h5",
    output:
        **figure("fig04_hysteresis_actuator"),
    log:
        f"{RESULTS}/logs/fig04.log",
    params:
        code=fingerprint("fprc.stages.draw"),
    message:
        "Fig. 4: hysteresis of the actuator"
    script:
        "../scripts/fig04.py"


rule reservoir_hysteresis:
    input:
        sweep=f"{RESULTS}/data/sweep.h5",
        complex=f"{RESULTS}/data/complex.h5",
    output:
        **figure("fig05_hysteresis_reservoir"),
    log:
        f"{RESULTS}/logs/fig05.log",
    params:
        code=fingerprint("fprc.stages.draw"),
    message:
        "Fig. 5: hysteresis of the reservoir"
    script:
        "../scripts/fig05.py"


rule training:
    input:
        fit=f"{RESULTS}/predictions/sweep_fprc_train.h5",
        prediction=f"{RESULTS}/predictions/sweep_fprc_test.h5",
    output:
        **figure("fig08_training"),
    log:
        f"{RESULTS}/logs/fig08.log",
    params:
        code=fingerprint("fprc.stages.draw"),
    message:
        "Fig. 8: FPRC on training and test data"
    script:
        "../scripts/fig08.py"
