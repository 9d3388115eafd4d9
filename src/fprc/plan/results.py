"""What each result of the paper needs of the raw logs; a result that is not listed needs none."""

from typing import NamedTuple

from fprc.paper import DISTURBANCE, EXPERIMENTS, LOOPS, REFERENCES, run_log


class Need(NamedTuple):
    """What a result is made from."""

    logs: tuple[str, ...] = ()  #: raw logs that it needs
    channels: tuple[str, ...] = ()  #: channels that each of these logs must have
    on_rigs: str = ""  #: why it needs a simulated rig, if it does


_P_O = ("p_o_kpa",)

#: By the target of the workflow.
NEEDS = {
    "table2": Need(EXPERIMENTS),
    "table3": Need(EXPERIMENTS),
    "timing": Need(EXPERIMENTS),
    "seeds": Need(on_rigs="needs source: sim: further seeds are further simulated rigs"),
    "claims": Need(on_rigs="needs source: sim: the verdicts are taken over further simulated rigs"),
    "fig4": Need(EXPERIMENTS),
    "fig5": Need(EXPERIMENTS, _P_O),
    "fig8": Need(EXPERIMENTS, _P_O),
    "fig9": Need(EXPERIMENTS[:1], _P_O),
    "fig10": Need(EXPERIMENTS),
    "fig11": Need(EXPERIMENTS, _P_O),
    **{
        f"fig{number}": Need((run_log(reference, "fprc"), run_log(reference, "fprc_pd")))
        for number, reference in enumerate(REFERENCES, start=12)
    },
    "fig16": Need(tuple(run_log(name, loop) for name in LOOPS for loop in ("pd", "fprc_pd"))),
    "fig17": Need((run_log(DISTURBANCE, "fprc_pd"),), ("p_i_kpa", "p_o_kpa", "phi_deg")),
}

_TITLES = {
    "table1": "Table I",
    "table2": "Table II",
    "table3": "Table III",
    "table4": "Table IV",
    "timing": "Execution times",
    "seeds": "Tables II to IV over further seeds",
}


def title_of_result(target: str) -> str:
    """Return a result's name for readers."""
    return _TITLES.get(target, target.capitalize().replace("Fig", "Fig. "))
