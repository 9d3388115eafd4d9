# The figures, each from result files alone.


rule actuator_hysteresis:
    input:
        sweep=f"{RESULTS}/data/sweep.h5",
        complex=f"{RESULTS}/data/complex.h5",
    output:
        **figure("fig04_hysteresis_actuator"),
    log:
        f"{RESULTS}/logs/fig04.log",
    params:
        code=code_of("draw"),
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
        code=code_of("draw"),
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
        code=code_of("draw"),
    message:
        "Fig. 8: FPRC on training and test data"
    script:
        "../scripts/fig08.py"


rule weights:
    input:
        weights=f"{RESULTS}/weights/fprc.json",
    output:
        **figure("fig09_weights"),
    log:
        f"{RESULTS}/logs/fig09.log",
    params:
        code=code_of("draw"),
    message:
        "Fig. 9: weight contributions"
    script:
        "../scripts/fig09.py"


rule settings:
    input:
        epsilon=f"{RESULTS}/sweeps/epsilon.json",
        n_c=f"{RESULTS}/sweeps/n_c.json",
        times=f"{RESULTS}/timing/times_over_n_c.json",
    output:
        **figure("fig10_settings"),
    log:
        f"{RESULTS}/logs/fig10.log",
    params:
        code=code_of("draw"),
    message:
        "Fig. 10: epsilon and n_c"
    script:
        "../scripts/fig10.py"


rule taps:
    input:
        taps=f"{RESULTS}/sweeps/taps.json",
    output:
        **figure("fig11_taps"),
    log:
        f"{RESULTS}/logs/fig11.log",
    params:
        code=code_of("draw"),
    message:
        "Fig. 11: tap sizes"
    script:
        "../scripts/fig11.py"


rule following_sine_0p2:
    input:
        open_loop=tracked("sine_0p2", "fprc"),
        closed_loop=tracked("sine_0p2", "fprc_pd_identified"),
    output:
        **figure("fig12_sine_0p2"),
    log:
        f"{RESULTS}/logs/fig12.log",
    params:
        code=code_of("draw_tracking"),
    message:
        "Fig. 12: tracking sine_0p2"
    script:
        "../scripts/following.py"


rule following_sine_0p5:
    input:
        open_loop=tracked("sine_0p5", "fprc"),
        closed_loop=tracked("sine_0p5", "fprc_pd_identified"),
    output:
        **figure("fig13_sine_0p5"),
    log:
        f"{RESULTS}/logs/fig13.log",
    params:
        code=code_of("draw_tracking"),
    message:
        "Fig. 13: tracking sine_0p5"
    script:
        "../scripts/following.py"


rule following_sweep:
    input:
        open_loop=tracked("sweep", "fprc"),
        closed_loop=tracked("sweep", "fprc_pd_identified"),
    output:
        **figure("fig14_sweep"),
    log:
        f"{RESULTS}/logs/fig14.log",
    params:
        code=code_of("draw_tracking"),
    message:
        "Fig. 14: tracking sweep"
    script:
        "../scripts/following.py"


rule following_complex:
    input:
        open_loop=tracked("complex", "fprc"),
        closed_loop=tracked("complex", "fprc_pd_identified"),
    output:
        **figure("fig15_complex"),
    log:
        f"{RESULTS}/logs/fig15.log",
    params:
        code=code_of("draw_tracking"),
    message:
        "Fig. 15: tracking complex"
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
        code=code_of("draw_tracking"),
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
        code=code_of("draw_tracking"),
    message:
        "Fig. 17: the reservoir disturbed"
    script:
        "../scripts/fig17.py"
