# Figures 4, 5 and 8.


def figure(name):
    """Return the two files of a figure."""
    caption = f"../report/{name.split('_')[0]}.rst"
    pdf = report(f"{RESULTS}/figures/{name}.pdf", caption=caption, category="Figures")
    return {"pdf": pdf, "png": f"{RESULTS}/figures/{name}.png"}


rule actuator_hysteresis:
    message:
        "Fig. 4: hysteresis of the actuator"
    input:
        sweep=f"{RESULTS}/data/sweep.h5",
        complex=f"{RESULTS}/data/complex.h5",
    output:
        **figure("fig04_hysteresis_actuator"),
    params:
        code=fingerprint("fprc.stages.draw"),
    log:
        f"{RESULTS}/logs/fig04.log",
    script:
        "../scripts/fig04.py"


rule reservoir_hysteresis:
    message:
        "Fig. 5: hysteresis of the reservoir"
    input:
        sweep=f"{RESULTS}/data/sweep.h5",
        complex=f"{RESULTS}/data/complex.h5",
    output:
        **figure("fig05_hysteresis_reservoir"),
    params:
        code=fingerprint("fprc.stages.draw"),
    log:
        f"{RESULTS}/logs/fig05.log",
    script:
        "../scripts/fig05.py"


rule training:
    message:
        "Fig. 8: FPRC on training and test data"
    input:
        fit=f"{RESULTS}/predictions/fprc_train.h5",
        prediction=f"{RESULTS}/predictions/fprc_test.h5",
    output:
        **figure("fig08_training"),
    params:
        code=fingerprint("fprc.stages.draw"),
    log:
        f"{RESULTS}/logs/fig08.log",
    script:
        "../scripts/fig08.py"
