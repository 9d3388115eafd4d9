# The figures, each from result files alone.


rule actuator:
    input:
        raw=f"{RAW}/sweep.h5",
    output:
        **figure("fig01_actuator"),
    log:
        f"{RESULTS}/logs/fig01.log",
    params:
        code=code_of("fig01"),
    message:
        "Fig. 1: the bending actuator"
    script:
        "../scripts/fig01.py"


rule reservoir:
    input:
        raw=complete("sweep"),
    output:
        **figure("fig02_reservoir"),
    log:
        f"{RESULTS}/logs/fig02.log",
    params:
        k_in_kpa_per_deg=SETTINGS["control"]["k_in_kpa_per_deg"],
        code=code_of("fig02"),
    message:
        "Fig. 2: the physical reservoir"
    script:
        "../scripts/fig02.py"


rule apparatus:
    output:
        **figure("fig03_apparatus"),
    log:
        f"{RESULTS}/logs/fig03.log",
    params:
        code=code_of("fig03"),
    message:
        "Fig. 3: the apparatus"
    script:
        "../scripts/fig03.py"


rule actuator_hysteresis:
    input:
        sweep=f"{RESULTS}/data/sweep.h5",
        complex=f"{RESULTS}/data/complex.h5",
    output:
        **figure("fig04_hysteresis_actuator"),
    log:
        f"{RESULTS}/logs/fig04.log",
    params:
        code=code_of("fig04"),
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
        code=code_of("fig05"),
    message:
        "Fig. 5: hysteresis of the reservoir"
    script:
        "../scripts/fig05.py"


rule esn_system:
    output:
        **figure("fig06_esn_system"),
    log:
        f"{RESULTS}/logs/fig06.log",
    params:
        models=settings_of("esn"),
        code=code_of("fig06"),
    message:
        "Fig. 6: control with the ESN"
    script:
        "../scripts/fig06.py"


rule fprc_system:
    output:
        **figure("fig07_fprc_system"),
    log:
        f"{RESULTS}/logs/fig07.log",
    params:
        models=settings_of("fprc"),
        control=SETTINGS["control"],
        code=code_of("fig07"),
    message:
        "Fig. 7: control with the FPRC"
    script:
        "../scripts/fig07.py"


rule training:
    input:
        fit=f"{RESULTS}/predictions/sweep_fprc_train.h5",
        prediction=f"{RESULTS}/predictions/sweep_fprc_test.h5",
    output:
        **figure("fig08_training", statistics=True),
    log:
        f"{RESULTS}/logs/fig08.log",
    params:
        code=code_of("fig08"),
    message:
        "Fig. 8: FPRC on training and test data"
    script:
        "../scripts/fig08.py"


rule weights:
    input:
        weights=f"{RESULTS}/weights/fprc.json",
    output:
        **figure("fig09_weights", statistics=True),
    log:
        f"{RESULTS}/logs/fig09.log",
    params:
        code=code_of("fig09"),
    message:
        "Fig. 9: weight contributions"
    script:
        "../scripts/fig09.py"


rule settings:
    input:
        **({"epsilon": SWEEPS["epsilon"]} if "fig10a" not in UNAVAILABLE else {}),
        n_c=f"{RESULTS}/sweeps/n_c.json",
        times=f"{RESULTS}/timing/times_over_n_c.json",
    output:
        **figure("fig10_settings", statistics=True),
    log:
        f"{RESULTS}/logs/fig10.log",
    priority: LONG  # its times come last, and the report waits for it
    params:
        code=code_of("fig10"),
    message:
        "Fig. 10: epsilon and n_c"
    script:
        "../scripts/fig10.py"


rule taps:
    input:
        taps=f"{RESULTS}/sweeps/taps.json",
    output:
        **figure("fig11_taps", statistics=True),
    log:
        f"{RESULTS}/logs/fig11.log",
    params:
        code=code_of("fig11"),
    message:
        "Fig. 11: tap sizes"
    script:
        "../scripts/fig11.py"


for number, reference in zip((12, 13, 14, 15), TABLE_IV):

    rule:
        name:
            f"following_{reference}"
        input:
            open_loop=tracked(reference, "fprc"),
            closed_loop=tracked(reference, "fprc_pd_identified"),
        output:
            **figure(f"fig{number}_{reference}"),
        log:
            f"{RESULTS}/logs/fig{number}.log",
        params:
            code=code_of("following"),
        message:
            f"Fig. {number}: tracking {reference}"
        script:
            "../scripts/following.py"


rule loops:
    input:
        runs=[
            tracked(reference, f"{controller}_{gain}")
            for reference in ("sine_0p5", "sweep")
            for controller in ("pd", "fprc_pd")
            for gain in ("printed", "identified")
        ],
    output:
        **figure("fig16_loops"),
    log:
        f"{RESULTS}/logs/fig16.log",
    params:
        code=code_of("fig16"),
    message:
        "Fig. 16: PD against FPRC+PD"
    script:
        "../scripts/fig16.py"


rule disturbance:
    input:
        run=tracked("disturbance", "fprc_pd_identified"),
    output:
        **figure("fig17_disturbance"),
    log:
        f"{RESULTS}/logs/fig17.log",
    params:
        quiet_s=SETTINGS["tracking"]["pushes"]["quiet_s"],
        code=code_of("fig17"),
    message:
        "Fig. 17: the reservoir disturbed"
    script:
        "../scripts/fig17.py"


rule readout_figure:
    input:
        cells=f"{RESULTS}/readout/cells.json",
    output:
        pdf=f"{RESULTS}/readout/readout.pdf",
        png=f"{RESULTS}/readout/readout.png",
        sidecar=f"{RESULTS}/readout/readout.json",
    log:
        f"{RESULTS}/logs/readout_figure.log",
    params:
        code=code_of("readout_figure"),
    message:
        "What the readout is worth: figure"
    script:
        "../scripts/readout_figure.py"
