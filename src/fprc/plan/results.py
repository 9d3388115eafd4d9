"""Every result of the paper: its name, its files, and what it is made of."""

from typing import Any, NamedTuple

from fprc.paper import EXPERIMENTS, LOOPS, REFERENCES, run_log


class Result(NamedTuple):
    """A result, which is also a target of the workflow."""

    name: str  #: of the target
    title: str  #: name for readers
    files: tuple[str, ...]  #: files below the results folder; a reader opens the first one
    #: Files below the results folder that it is made of; ``data`` stands for the raw logs and the
    #: files of preprocessing, ``judged/sweep`` for every model that the sweep trained and its
    #: errors, ``loops`` for the closed-loop logs and their inputs, ``seeds`` for the reports of the
    #: further seeds, of which there are none without a simulated rig, ``grids`` for the reports of
    #: the grids.
    made_of: tuple[str, ...] = ()
    logs: tuple[str, ...] = ()  #: raw logs that it needs
    channels: tuple[str, ...] = ()  #: channels that each of these logs must have
    on_rigs: str = ""  #: why it needs a simulated rig, if it does


def _figure(number: int, stem: str, *made_of: str, **needs: Any) -> Result:
    """Return a figure of the paper."""
    file = f"figures/fig{number:02}_{stem}.pdf"
    return Result(f"fig{number}", f"Fig. {number}", (file,), made_of, **needs)


_TIMES, _OVER_N_C = "timing/times.json", "timing/times_over_n_c.json"
_SEEDS = tuple(f"tables/table{number}_seeds.md" for number in (2, 3, 4))
_LOOPS = tuple(
    run_log(reference, controller) for reference in LOOPS for controller in ("pd", "fprc_pd")
)
_BOTH: dict[str, Any] = {"logs": EXPERIMENTS}
_BOTH_WITH_P_O: dict[str, Any] = {"logs": EXPERIMENTS, "channels": ("p_o_kpa",)}

# fmt: off
#: In the order of listings for readers.
RESULTS = (
    Result("table1", "Table I", ("tables/table1.md",)),
    Result("table2", "Table II", ("tables/table2.md",), ("data", "judged/sweep"), **_BOTH),
    Result("table3", "Table III", ("tables/table3.md",), ("data", "judged/complex"), **_BOTH),
    Result("table4", "Table IV", ("tables/table4.md",), ("loops",)),
    Result("timing", "Execution times", ("timing/table2_timing.md",), ("data", _TIMES), **_BOTH),
    Result("seeds", "Tables II to IV over further seeds", _SEEDS, ("seeds",),
           on_rigs="needs source: sim: further seeds are further simulated rigs"),
    Result("claims", "Claims", ("claims.md",), ("seeds", _TIMES, _OVER_N_C),
           on_rigs="needs source: sim: the verdicts are taken over further simulated rigs"),
    _figure(1, "actuator"),
    _figure(2, "reservoir"),
    _figure(3, "apparatus"),
    _figure(4, "hysteresis_actuator", "data", **_BOTH),
    _figure(5, "hysteresis_reservoir", "data", **_BOTH_WITH_P_O),
    _figure(6, "esn_system"),
    _figure(7, "fprc_system"),
    _figure(8, "training", "data", "judged/sweep", **_BOTH_WITH_P_O),
    _figure(9, "weights", "data", "weights/fprc.json", logs=("sweep",), channels=("p_o_kpa",)),
    _figure(10, "settings", "data", "grids", _OVER_N_C, "seeds", **_BOTH),
    _figure(11, "taps", "data", "grids", "seeds", **_BOTH_WITH_P_O),
    *(_figure(number, name, "loops", logs=(run_log(name, "fprc"), run_log(name, "fprc_pd")))
      for number, name in enumerate(REFERENCES, start=12)),
    _figure(16, "loops", "loops", logs=_LOOPS),
    _figure(17, "disturbance", "loops", channels=("p_i_kpa", "p_o_kpa", "phi_deg"),
            logs=(run_log("disturbance", "fprc_pd"),)),
)
# fmt: on

BY_NAME = {result.name: result for result in RESULTS}
