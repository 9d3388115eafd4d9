"""What can be made of the logs that are there, and why the rest cannot."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from fprc.escape import terminal
from fprc.logs import EXPERIMENTS, Holding
from fprc.logs.columns import unit_of

#: Closed-loop runs of each figure, as reference and controller.
_RUNS = {
    "fig12": [("sine_0p2", "fprc"), ("sine_0p2", "fprc_pd_identified")],
    "fig13": [("sine_0p5", "fprc"), ("sine_0p5", "fprc_pd_identified")],
    "fig14": [("sweep", "fprc"), ("sweep", "fprc_pd_identified")],
    "fig15": [("complex", "fprc"), ("complex", "fprc_pd_identified")],
    "fig16": [
        (reference, f"{controller}_{gain}")
        for reference in ("sine_0p5", "sweep")
        for controller in ("pd", "fprc_pd")
        for gain in ("printed", "identified")
    ],
    "fig17": [("disturbance", "fprc_pd_identified")],
}


def run_log(reference: str, controller: str) -> str:
    """Return the name of the log of one closed-loop run."""
    return f"track_{reference}_{controller}"


class Need(NamedTuple):
    """What a result is made from.

    Attributes
    ----------
    logs : sequence of str
        Raw logs, by name.
    channels : sequence of str
        Of those that an imported log may lack, what each log must have.
    literal : sequence of str
        Channels that must be what their names say, because the result draws or
        prints them as such.
    """

    logs: Sequence[str]
    channels: Sequence[str] = ()
    literal: Sequence[str] = ()


#: What each result needs; what is not here needs no log.
NEEDS = {
    "table2": Need(EXPERIMENTS),
    "table3": Need(EXPERIMENTS),
    "timing": Need(EXPERIMENTS),
    "fprc": Need(EXPERIMENTS, ("p_o_kpa",)),
    "fig1": Need(("sweep",), ("p_exp_kpa",), ("p_exp_kpa", "theta_deg")),
    "fig2": Need(("sweep",), ("p_i_kpa", "p_o_kpa", "phi_deg"), ("p_i_kpa", "p_o_kpa", "phi_deg")),
    "fig4": Need(EXPERIMENTS),
    "fig5": Need(EXPERIMENTS, ("p_o_kpa",)),
    "fig8": Need(EXPERIMENTS, ("p_o_kpa",)),
    "fig9": Need(("sweep",), ("p_o_kpa",)),
    "fig10": Need(EXPERIMENTS),
    "fig10a": Need(EXPERIMENTS, ("p_o_kpa",)),
    "fig11": Need(EXPERIMENTS, ("p_o_kpa",)),
    "readout": Need(EXPERIMENTS, ("p_o_kpa",)),
} | {
    name: Need([run_log(*run) for run in runs], ("p_i_kpa", "p_o_kpa", "phi_deg"))
    if name == "fig17"
    else Need([run_log(*run) for run in runs])
    for name, runs in _RUNS.items()
}  # fmt: skip

#: What is made of many simulated rigs, and why not of logs.
_OF_RIGS = {
    "seeds": "needs source: sim: further seeds are further simulated rigs",
    "claims": "needs source: sim: the verdicts are taken over further simulated rigs",
    "check": "needs source: sim: the declared verdicts are those of the simulated rig",
    "readme": "needs source: sim: the README gives the numbers of the simulated rig",
}

#: What a reader knows each result as.
TITLES = {
    "table2": "Table II",
    "table3": "Table III",
    "table4": "Table IV",
    "table4_runs": "Table IV, some of its runs",
    "timing": "Execution times",
    "fprc": "FPRC in Tables II and III and in the execution times",
    "readout": "Readout value",
    "seeds": "Tables II to IV over further seeds",
    "claims": "Claims",
} | {
    **{f"fig{number}": f"Fig. {number}" for number in range(1, 11)},
    "fig10a": "Fig. 10(a), and FPRC in (b) and (c)",
    **{f"fig{number}": f"Fig. {number}" for number in range(11, 18)},
    "check": "Check of the verdicts",
    "readme": "README",
}

#: Targets that are no results, and not listed as such.
CHORES = ("check", "readme")


def unavailable(
    held: Mapping[str, Holding], folder: str, runs: Sequence[str], *, simulated: bool
) -> dict[str, str]:
    """Return what cannot be made, and why, in words.

    Parameters
    ----------
    held : Mapping
        The logs that are there, or will be, by name.
    folder : str
        Where they are, for the words.
    runs : sequence of str
        Closed-loop logs of a whole Table IV.
    simulated : bool
        Whether the workflow simulates the rig, and so further ones.
    """
    reasons = {name: _why_not(need, held, folder) for name, need in NEEDS.items()}
    absent = [run for run in runs if run not in held]
    if len(absent) == len(runs):
        reasons["table4"] = f"needs closed-loop logs {folder}/{run_log('*', '*')}.h5; there is none"
    elif absent:
        reasons["table4_runs"] = f"no {_listed([f'{run}.h5' for run in absent])} in {folder}"
    if not simulated:
        reasons |= _OF_RIGS
    found = {name: reason for name, reason in reasons.items() if reason}
    for part, whole in (("fprc", "table2"), ("fig10a", "fig10")):
        if whole in found:
            found.pop(part, None)
    return {name: found[name] for name in sorted(found, key=list(TITLES).index)}


def _why_not(need: Need, held: Mapping[str, Holding], folder: str) -> str | None:
    absent = [f"{name}.h5" for name in need.logs if name not in held]
    if absent:
        verb = "is" if len(absent) == 1 else "are"
        return f"needs {_listed(absent)}, which {verb} not in {folder}"
    reasons = []
    for channels, logs in _grouped(need, held).items():
        verb = "does" if len(logs) == 1 else "do"
        reasons.append(f"{_listed(channels)}, which {_listed(logs)} {verb} not have")
    for name in need.literal:
        reasons += [
            f"{name} in {unit_of(name)}; in {log}.h5 it is {held[log].instead(name)}"
            for log in need.logs
            if held[log].instead(name) is not None
        ]
    return "needs " + "; and ".join(reasons) if reasons else None


def _grouped(need: Need, held: Mapping[str, Holding]) -> dict[tuple[str, ...], list[str]]:
    """Return the logs by the channels that they lack."""
    groups: dict[tuple[str, ...], list[str]] = {}
    for name in need.logs:
        lacking = tuple(held[name].lacks(need.channels))
        if lacking:
            groups.setdefault(lacking, []).append(f"{name}.h5")
    return groups


def _listed(names: Sequence[str]) -> str:
    *first, last = names
    return f"{', '.join(first)} and {last}" if first else last


def refusal(name: str, reasons: Mapping[str, str]) -> str:
    """Return what to tell someone who asks for a target that cannot be made."""
    return terminal(f"{name}: not available for this data: {TITLES[name]} {reasons[name]}")
