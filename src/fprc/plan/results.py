"""Every result of the paper: what it is called, which file it is, and what it is made of."""

from typing import NamedTuple

from fprc.paper import EXPERIMENTS, REFERENCES, run_log

_II = "II Pneumatic bending actuators"
_III = "III Feedforward hysteresis compensation"
_IV = "IV Experimental results"

_P_O = ("p_o_kpa",)
_RESERVOIR = ("p_i_kpa", "p_o_kpa", "phi_deg")


class Result(NamedTuple):
    """A result, which is also a target of the workflow; or a part of one.

    Attributes
    ----------
    name : str
        Of the target.
    title : str
        As a reader knows it.
    files : tuple of str
        Below the results folder; the first is what a person opens.
    made_of : tuple of str
        Files below the results folder that it is made of, ``{model}`` for each model;
        ``data`` stands for the raw logs and all that preprocessing makes of them, ``loops`` for
        what closed-loop runs come from, and ``seeds`` for the reports of the further seeds.
    logs : tuple of str
        Raw logs that it needs.
    channels : tuple of str
        Of those that an imported log may lack, what each of the logs must have.
    literal : tuple of str
        Channels that must be what their names say, because the result draws or
        prints them as such.
    on_rigs : str
        Why it needs a simulated rig, if it does.
    chapter : str
        Section of the paper that the figure stands in.
    part_of : str
        The target that this is a part of; a part is no target.
    """

    name: str
    title: str
    files: tuple[str, ...] = ()
    made_of: tuple[str, ...] = ()
    logs: tuple[str, ...] = ()
    channels: tuple[str, ...] = ()
    literal: tuple[str, ...] = ()
    on_rigs: str = ""
    chapter: str = ""
    part_of: str = ""


def _judged(experiment: str) -> tuple[str, ...]:
    """Return what judging every model on one log gives."""
    return (
        f"crossval/{experiment}_{{model}}.json",
        f"models/{experiment}_{{model}}.h5",
        f"predictions/{experiment}_{{model}}_train.h5",
        f"predictions/{experiment}_{{model}}_test.h5",
    )


def _following(number: int, reference: str) -> Result:
    """Return the figure of one of the references."""
    return Result(
        f"fig{number}",
        f"Fig. {number}",
        (f"figures/fig{number}_{reference}.pdf",),
        ("loops",),
        (run_log(reference, "fprc"), run_log(reference, "fprc_pd_identified")),
        chapter=_IV,
    )


_GAINS = "control/gains.json"
_SEEDS = tuple(f"tables/table{number}_seeds.md" for number in (2, 3, 4))

#: In the order in which a reader is told of them.
RESULTS = (
    Result("table1", "Table I", ("tables/table1.md",)),
    Result("table2", "Table II", ("tables/table2.md",), ("data", *_judged("sweep")), EXPERIMENTS),
    Result(
        "table3", "Table III", ("tables/table3.md",), ("data", *_judged("complex")), EXPERIMENTS
    ),
    Result("table4", "Table IV", ("tables/table4.md",), (_GAINS, "loops")),
    Result("table4_runs", "Table IV, some of its runs", part_of="table4"),
    Result(
        "timing",
        "Execution times",
        ("timing/table2_timing.md", "timing/step_cost.md"),
        ("data", "timing/times.json", "timing/steps.json"),
        EXPERIMENTS,
    ),
    Result(
        "fprc",
        "FPRC in Tables II and III and in the execution times",
        logs=EXPERIMENTS,
        channels=_P_O,
        part_of="table2",
    ),
    Result(
        "readout",
        "Readout value",
        ("readout/readout.md", "readout/readout.pdf"),
        ("data", "readout/cells.json"),
        EXPERIMENTS,
        _P_O,
    ),
    Result(
        "seeds",
        "Tables II to IV over further seeds",
        (*_SEEDS, "tables/orders.csv"),
        ("seeds",),
        on_rigs="needs source: sim: further seeds are further simulated rigs",
    ),
    Result(
        "claims",
        "Claims",
        ("claims.md",),
        ("seeds", "timing/times.json", "timing/times_over_n_c.json"),
        on_rigs="needs source: sim: the verdicts are taken over further simulated rigs",
    ),
    Result(
        "fig1",
        "Fig. 1",
        ("figures/fig01_actuator.pdf",),
        ("data",),
        ("sweep",),
        ("p_exp_kpa",),
        ("p_exp_kpa", "theta_deg"),
        chapter=_II,
    ),
    Result(
        "fig2",
        "Fig. 2",
        ("figures/fig02_reservoir.pdf",),
        ("data",),
        ("sweep",),
        _RESERVOIR,
        _RESERVOIR,
        chapter=_II,
    ),
    Result("fig3", "Fig. 3", ("figures/fig03_apparatus.pdf",), chapter=_II),
    Result(
        "fig4",
        "Fig. 4",
        ("figures/fig04_hysteresis_actuator.pdf",),
        ("data",),
        EXPERIMENTS,
        chapter=_II,
    ),
    Result(
        "fig5",
        "Fig. 5",
        ("figures/fig05_hysteresis_reservoir.pdf",),
        ("data",),
        EXPERIMENTS,
        _P_O,
        chapter=_II,
    ),
    Result("fig6", "Fig. 6", ("figures/fig06_esn_system.pdf",), chapter=_III),
    Result("fig7", "Fig. 7", ("figures/fig07_fprc_system.pdf",), chapter=_III),
    Result(
        "fig8",
        "Fig. 8",
        ("figures/fig08_training.pdf",),
        ("data", *_judged("sweep")),
        EXPERIMENTS,
        _P_O,
        chapter=_III,
    ),
    Result(
        "fig9",
        "Fig. 9",
        ("figures/fig09_weights.pdf",),
        ("data", "weights/fprc.json"),
        ("sweep",),
        _P_O,
        chapter=_III,
    ),
    Result(
        "fig10",
        "Fig. 10",
        ("figures/fig10_settings.pdf",),
        ("data", "sweeps/n_c.json", "timing/times_over_n_c.json"),
        EXPERIMENTS,
        chapter=_III,
    ),
    Result(
        "fig10a",
        "Fig. 10(a), and FPRC in (b) and (c)",
        made_of=("sweeps/epsilon.json",),
        logs=EXPERIMENTS,
        channels=_P_O,
        part_of="fig10",
    ),
    Result(
        "fig11",
        "Fig. 11",
        ("figures/fig11_taps.pdf",),
        ("data", "sweeps/taps.json"),
        EXPERIMENTS,
        _P_O,
        chapter=_III,
    ),
    *(_following(number, reference) for number, reference in enumerate(REFERENCES, start=12)),
    Result(
        "fig16",
        "Fig. 16",
        ("figures/fig16_loops.pdf",),
        ("loops",),
        tuple(
            run_log(reference, f"{controller}_{gain}")
            for reference in ("sine_0p5", "sweep")
            for controller in ("pd", "fprc_pd")
            for gain in ("printed", "identified")
        ),
        chapter=_IV,
    ),
    Result(
        "fig17",
        "Fig. 17",
        ("figures/fig17_disturbance.pdf",),
        ("loops",),
        (run_log("disturbance", "fprc_pd_identified"),),
        _RESERVOIR,
        chapter=_IV,
    ),
    Result("not_available", "", ("not_available.csv", "not_available.md")),
)

#: Targets that are no results.
CHORES = (
    Result(
        "check",
        "Check of the verdicts",
        on_rigs="needs source: sim: the declared verdicts are those of the simulated rig",
    ),
    Result(
        "readme",
        "README",
        on_rigs="needs source: sim: the README gives the numbers of the simulated rig",
    ),
)

BY_NAME = {result.name: result for result in (*RESULTS, *CHORES)}


def figure_number(result: Result) -> int:
    """Return the number of the figure; 0 if the result is none."""
    number = result.name.removeprefix("fig")
    return int(number) if result.chapter and number.isdigit() else 0
