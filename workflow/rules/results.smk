# Tables, figures, claims and the report, made from result files. Each named output is a target.

import sys
from difflib import get_close_matches


rule draw_without_data:
    output:
        fig1=figure("fig01_actuator"),
        fig2=figure("fig02_reservoir"),
        fig3=figure("fig03_apparatus"),
        fig6=figure("fig06_esn_system"),
        fig7=figure("fig07_fprc_system"),
        table1=table("tables/table1"),
    log:
        f"{RESULTS}/logs/draw_without_data.log",
    params:
        stage="stages.tabulate.tabulate_settings",
        code=SHOWS,
        models=SETTINGS["models"],
        captions={
            "fig1": """The soft bending actuator. (a) Its parts. (b) Pressurised: the metal plate
                keeps its length while the bladder on its inner side shortens and bulges. (c) Vented,
                and straight again. The proportions are ours, since the paper prints none.""",
            "fig2": """The reservoir, two bladders on one plate. (a) Its parts: PAM A is driven, PAM
                B is pre-pressurised and closed by a hand valve (PAM: pneumatic artificial muscle). (b)
                At rest. (c) PAM A inflated: the fabric squeezes PAM B, and P_o rises. (d) The mapping
                F_r from P_i to P_o that is used as a reservoir; z⁻¹ is a delay of one sample. The
                fuller a colour, the higher the pressure. The proportions are ours.""",
            "fig3": """The apparatus. Thick grey: pneumatic lines, black: electrical lines. One
                computer drives two proportional valves and reads one bend sensor and three pressure
                sensors at 200 Hz. A sensor has the colour of the chamber or the angle that it measures.
                Not to scale.""",
            "fig6": """Control with the ESN (echo state network) as feedforward model: theta_d
                drives a random network of r nodes, whose state x gives P_ff; a PD controller adds P_fb,
                and a PI controller makes the pressure P_d. Bold theta: the last n_y values of theta_d.
                Weights of the input, the network and the output are w_in, W_r and w_out; gamma, rho and
                f_input are settings of Table I. Sand-coloured: soft bodies; a line in colour is the
                signal written at it.""",
            "fig7": """Control with the FPRC (fuzzy pneumatic physical reservoir) as feedforward
                model: theta_d drives the physical reservoir (on the simulated rig, its model) through
                K_in and a PI pressure controller. The last n_u values of the low-passed P_o (bold p)
                and the last n_y values of theta_d (bold theta) are the state that a Takagi-Sugeno (T-S)
                fuzzy readout takes: its memberships in n_c rules weight the rules' outputs, which give
                P_ff. Sand-coloured: soft bodies; a line in colour is the signal written at it.""",
        },
    message:
        "Table I, and Figs. 1, 2, 3, 6 and 7, which show no data"
    script:
        "../scripts/stage.py"


rule tabulate_models:
    input:
        **{log: [PLAN.judged(log, model)["errors"] for model in PLAN.models] for log in EXPERIMENTS},
        quality=[f"{RESULTS}/quality/{log}.json" for log in EXPERIMENTS],
        made_from=PLAN.data,
    output:
        **PLAN.possible(table2=table("tables/table2"), table3=table("tables/table3")),
    log:
        f"{RESULTS}/logs/tabulate_models.log",
    params:
        stage="stages.tabulate.tabulate_models",
        code=SHOWS,
        left_out=PLAN.left_out,
    message:
        "Tables II and III"
    script:
        "../scripts/stage.py"


rule draw_loops:
    input:
        runs=[PLAN.log(run) for run in PLAN.runs],
        made_from=[*(PLAN.data if PLAN.records else []), *DRIVEN_BY],
    output:
        **PLAN.possible(
            table4=table("tables/table4"),
            fig12=figure("fig12_sine_0p2", "csv"),
            fig13=figure("fig13_sine_0p5", "csv"),
            fig14=figure("fig14_sweep", "csv"),
            fig15=figure("fig15_complex", "csv"),
            fig16=figure("fig16_loops"),
            fig17=figure("fig17_disturbance", "csv"),
        ),
    log:
        f"{RESULTS}/logs/draw_loops.log",
    params:
        stage="stages.draw.draw_loops",
        code=[computes(), SHOWS],  # logs that were recorded elsewhere are not made again
        left_out=[run for run in PLAN.every_run if run not in PLAN.contents],
        limits=SETTINGS["quality"],
        feedback=plan.feedback_in_words(SETTINGS),
        quiet_s=SETTINGS["tracking"]["pushes"]["quiet_s"],
        captions={
            "fig12": """Tracking a sine of 0.2 Hz: (a) feedforward alone, (b) with the PD
                controller, (c) errors theta_d - theta of both, (d) outputs of feedforward and feedback
                in (b). On the right: the last 5 s. Figs. 12 to 15 share the axes of the errors and of
                P_fb; larger errors while the rig settles are cut off. RMSE: after the settling time
                (hatched).""",
            "fig13": "Tracking a sine of 0.5 Hz; panels as in Fig. 12.",
            "fig14": "Tracking a sweep from 0.05 to 0.95 Hz; panels as in Fig. 12.",
            "fig15": "Tracking a sum of five sines; panels as in Fig. 12.",
            "fig16": """Actual angle over reference after the settling time, PD alone (grey) against
                FPRC+PD (black): (a) sine of 0.5 Hz, (b) sweep. Dashed: actual angle equal to the
                reference.""",
            "fig17": """Tracking a sine of 0.3 Hz while random forces bend the reservoir: (a)
                tracking and its error theta_d - theta, (b) input, bending and output of the reservoir.
                Hatched: settling, not judged; yellow: no pushes; grey: the reservoir is pushed. How far
                that moves its bending and P_o is C17, against the same run without pushes.""",
        },
    message:
        "Closed loops: Table IV and Figs. 12 to 17"
    script:
        "../scripts/stage.py"


rule tabulate_times:
    input:
        times=f"{RESULTS}/timing/times.json",
        made_from=PLAN.data,
    output:
        **PLAN.possible(timing=table("timing/table2_timing")),
    log:
        f"{RESULTS}/logs/tabulate_times.log",
    params:
        stage="stages.tabulate.tabulate_times",
        code=SHOWS,
        left_out=PLAN.left_out,
    message:
        "Table II, execution times"
    script:
        "../scripts/stage.py"


rule show_seeds:
    input:
        grids=PLAN.replicates("grids") or [f"{RESULTS}/grids.json"],
        times=f"{RESULTS}/timing/times.json",
        times_over_n_c=f"{RESULTS}/timing/times_over_n_c.json",
        models=PLAN.replicates("models"),
        controls=PLAN.replicates("control"),
        made_from=PLAN.data,
    output:
        **PLAN.possible(
            seeds=sum((table(f"tables/table{n}_seeds") for n in (2, 3, 4)), []),
            fig10=figure("fig10_settings", "csv"),
            fig11=figure("fig11_taps", "csv"),
            claims=[f"{RESULTS}/claims.json", f"{RESULTS}/claims.csv"],
        ),
    log:
        f"{RESULTS}/logs/show_seeds.log",
    priority: LONG  # the execution times are measured last, and the report waits for this
    params:
        stage="stages.tabulate.show_seeds",
        code=SHOWS,
        feedback=plan.feedback_in_words(SETTINGS),
        fitted=SETTINGS["fitted"],
        captions={
            "fig10": """Errors over the filter factor epsilon (a) and the number of rules n_c (b),
                and batch execution times (c). On the simulated rig, errors are means over further
                seeds, on the first fold only, as C9 and C11 are judged (on each seed the clustering
                begins elsewhere); on recorded logs, both are over five folds, and a test error, one
                value, has no band. Bars in (c): standard deviation over repeats. Training and
                validation errors nearly coincide: a dot in a square. A band or bar that is smaller than
                its line or marker is hidden by it.""",
            "fig11": """Errors over the tap sizes n_u of P_o and n_y of theta_d. On the simulated
                rig they are means over further seeds, on each of which the clustering begins elsewhere,
                on the first fold only, as C12 is judged; on recorded logs, training and validation are
                means over five folds. The numbers are the errors of the framed cells: the lowest of
                each phase, then that of the paper's setting.""",
        },
    message:
        "Figs. 10 and 11; Tables II to IV over further seeds, and claims C1 to C22"
    script:
        "../scripts/stage.py"


rule draw_experiments:
    input:
        **{log: f"{RESULTS}/data/{log}.h5" for log in PLAN.experiments},
        made_from=PLAN.data,
    output:
        **PLAN.possible(
            fig4=figure("fig04_hysteresis_actuator"),
            fig5=figure("fig05_hysteresis_reservoir"),
            fig9=figure("fig09_weights", "csv"),
        ),
    log:
        f"{RESULTS}/logs/draw_experiments.log",
    params:
        stage="stages.draw.draw_experiments",
        code=[computes("fprc"), SHOWS],
        validation=plan.validation(SETTINGS, "fprc"),
        captions={
            "fig4": """Pressure commands of the two hysteresis experiments (a, c) and the bending
                angle that follows (b, d). Each loop in (b) is the mean over the cycles of a band of 0.1
                Hz; the path in (d) is a moving mean over 0.1 s. Only the sweep has a frequency: the
                complex command is a sum of five sines. Black: the start from rest, before the command
                turns for the first time, which is no part of a loop. Whether the loops depend on
                frequency is claim C18.""",
            "fig5": """Pressure P_o in the sealed chamber of the reservoir over the bending angle
                that drives it, in both experiments; means and start as in Fig. 4.""",
            "fig9": """Share of each feature in the normalised weights of each fuzzy rule, after
                training on data scaled to 0-1; the paler, the older the tap, from the present sample k
                on. On the right: our mean over the rules, and the mean that the paper prints. Ours
                depends on where the clustering begins; claim C8a has it over further seeds.""",
        },
    message:
        "Figs. 4 and 5: hysteresis of actuator and reservoir; Fig. 9: weights of FPRC"
    script:
        "../scripts/stage.py"


rule draw_training:
    input:
        **plan.pick(PLAN.judged("sweep", "fprc"), "fits", "predictions"),
        made_from=PLAN.data,
    output:
        **PLAN.possible(fig8=figure("fig08_training", "csv")),
    log:
        f"{RESULTS}/logs/draw_training.log",
    params:
        stage="figures.hysteresis.draw_training",
        code=SHOWS,
        captions={
            "fig8": """FPRC of the best fold: P_ff, P_exp as applied, and below them their
                difference, (a) in the first and in the last tenth of its training log, (b) on the test
                log. The RMSE are over the whole logs.""",
        },
    message:
        "Fig. 8: FPRC on its training and test logs"
    script:
        "../scripts/stage.py"


#: Rules whose named outputs are targets, in the order of the report. A target asks also for what
#: its files are made from.
SHOWN = """draw_without_data tabulate_models draw_loops tabulate_times show_seeds draw_experiments
    draw_training"""
MADE, TARGETS, CAPTIONS = {}, {}, {}
for shown in (getattr(rules, name) for name in SHOWN.split()):
    CAPTIONS |= shown.params.get("captions", {})
    for target, files in shown.output.items():
        MADE[target], TARGETS[target] = list(files), [*files, *shown.input]
#: Tables of the report; the claims have a place of their own.
PAGES = [file for name in MADE if name != "claims" for file in MADE[name] if file.endswith(".json")]
#: Figures of the report, with the sources of their data.
DRAWN = {
    file: PLAN.source_of(target)
    for target in sorted(MADE, key=lambda target: target[3:].zfill(2))
    for file in MADE[target]
    if file.endswith(".png")
}


rule report_page:
    input:
        ledger=[f"{RESULTS}/claims.json"] if "claims" in MADE else [],
        tables=PAGES,
        figures=list(DRAWN),
    output:
        html=f"{RESULTS}/report.html",
    log:
        f"{RESULTS}/logs/report_page.log",
    params:
        stage="stages.report.write_report",
        code=SHOWS,
        sources=list(DRAWN.values()),
        caption_of=CAPTIONS,
        missing={plan.title_of_result(name): why for name, why in PLAN.unavailable.items()},
        settings=SETTINGS,
    message:
        "Report: claims, tables, figures and settings on one page"
    script:
        "../scripts/stage.py"


TARGETS["report"] = [f"{RESULTS}/report.html", *sorted(set(sum(TARGETS.values(), [])))]
TARGETS["logs"] = [PLAN.log(experiment) for experiment in PLAN.experiments]

for target, files in TARGETS.items():

    rule:
        name:
            target
        input:
            files,
        localrule: True
        message:
            f"Target {target}"


for target, why in PLAN.unavailable.items():

    rule:
        name:
            target
        log:
            f"{RESULTS}/logs/{target}.log",
        localrule: True
        message:
            f"{target}: not available for this data: {plan.title_of_result(target)} {why}"
        shell:
            "exit 1"


# Snakemake itself says only that no rule makes a mistyped target. Options, their settings and files
# are no targets.
for word in sys.argv[1:]:
    if word.isalnum() and word not in ("all", *TARGETS, *PLAN.unavailable):
        for near in get_close_matches(word, TARGETS, n=1, cutoff=0.75):
            print(f"{word}: did you mean {near}?", file=sys.stderr)
