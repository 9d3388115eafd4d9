"""The paper's claims C13 to C22, on control, loops and the rig."""

from itertools import pairwise

from fprc.claims import numbers as n
from fprc.claims import statements as s
from fprc.claims.claim import ASSUMED, Claim, Statement
from fprc.paper import REFERENCE_NAMES, REFERENCES

_TRACKING = ("table4_seeds", "fig12", "fig13", "fig14", "fig15")

OF_CONTROL = (
    Claim(
        "C13a",
        "open-loop FPRC and closed-loop FPRC+PD both follow all four references; FPRC+PD has the "
        "lower RMSE on each (Table IV)",
        "open loop 1.70-2.67 deg; less with feedback",
        lambda r, p: [
            *(Statement(f"FPRC, {REFERENCE_NAMES[name]} [deg]",
                        n.tracking_error(r, name, "fprc"), high=5.0, ratio=False)
              for name in REFERENCES),
            *(Statement(f"FPRC+PD / FPRC, {REFERENCE_NAMES[name]}", cut, high=1.0)
              for name, cut in s.cuts(r).items()),
        ],
        fitted_by=("closed_loop",), half_fitted_by=("open_loop", "closed_errors"),
        shown_in=_TRACKING,
    ),
    Claim(
        "C13b", "feedback cuts the error of each reference by as much as Table IV shows",
        "FPRC+PD / FPRC: 0.39, 0.52, 0.64, 0.36",
        lambda r, p: [
            Statement(f"FPRC+PD / FPRC over the printed ratio, {REFERENCE_NAMES[name]}",
                      cut / s.printed_cuts(p)[name], 1 / 1.5, 1.5)
            for name, cut in s.cuts(r).items()
        ],
        half_fitted_by=("open_loop", "closed_loop", "closed_sweep", "closed_errors"),
        shown_in=_TRACKING,
    ),
    Claim(
        "C13c", "feedback cuts less of the error at higher frequencies",
        "FPRC+PD / FPRC: 0.39 at 0.2 Hz, 0.52 at 0.5 Hz, 0.64 on the sweep",
        lambda r, p: [
            Statement(f"cut, {REFERENCE_NAMES[faster]} / {REFERENCE_NAMES[slower]}",
                      s.cuts(r)[faster] / s.cuts(r)[slower], low=1.0)
            for slower, faster in pairwise(("sine_0p2", "sine_0p5", "sweep"))
        ],
        half_fitted_by=("open_loop", "closed_sweep", "closed_errors"), shown_in=_TRACKING,
    ),
    Claim(
        "C13d", "the errors of Table IV rise from Complex over 0.2 and 0.5 Hz to Sweep",
        "1.70, 2.04, 2.25, 2.67 deg; with feedback 0.608, 0.795, 1.16, 1.70 deg",
        s.order_of_references,
        half_fitted_by=("open_loop", "closed_sweep", "closed_errors"), shown_in=_TRACKING,
    ),
    Claim(
        "C14", "P_ff predominates over P_fb in FPRC+PD", "P_ff predominates",
        lambda r, p: [
            Statement(f"P_fb / P_ff (rms), {REFERENCE_NAMES[name]}",
                      n.measured(r, "effort", name), high=0.25)
            for name in REFERENCES
        ],
        note="follows from C13a: errors of a few degrees need little feedback",
        half_fitted_by=("open_loop", "closed_loop", "closed_errors"), shown_in=_TRACKING[1:],
    ),
    Claim(
        "C15",
        "in the sweep the closed-loop error stays within +-8 deg, with no detectable phase lag at "
        "high frequency, and grows with frequency",
        "within 8 deg, no lag, error grows",
        lambda r, p: [
            Statement("largest error [deg]", n.measured(r, "sweep", "largest_error_deg"),
                      high=p["fig_sweep_max_abs_error_deg"]["fprc_pd"], ratio=False),
            # 30 ms are 10 deg of phase at 0.95 Hz
            Statement("lag in the last 10 s [ms]", n.measured(r, "sweep", "lag_ms"),
                      -30.0, 30.0, ratio=False),
            Statement("error in the last / first third",
                      n.measured(r, "sweep", "last_third_deg")
                      / n.measured(r, "sweep", "first_third_deg"), low=1.0),
        ],
        half_fitted_by=("closed_sweep", "closed_errors"), shown_in=("fig14",),
    ),
    Claim(
        "C16",
        "PD alone shows marked hysteresis loops in reference against actual; FPRC+PD largely "
        "removes them",
        "marked loops of PD, largely removed by FPRC+PD", s.loops_removed,
        half_fitted_by=("closed_sweep", "closed_errors"), shown_in=("fig16",),
    ),
    Claim(
        "C17",
        "disturbing the reservoir distorts its bending, but P_o and the tracking are not affected",
        "bending distorted, P_o and tracking not",
        lambda r, p: [
            Statement("change of the bending [% of its swing]",
                      100 * n.measured(r, "disturbance", "bending"), low=10.0, ratio=False),
            Statement("change of P_o [% of its swing]",
                      100 * n.measured(r, "disturbance", "p_o"), high=1.0, ratio=False),
            Statement("tracking error, pushed / not pushed",
                      n.measured(r, "disturbance", "error_ratio"), 1 / 1.1, 1.1),
        ],
        note="each pushed run against the same run without pushes",
        kind=ASSUMED, shown_in=("fig17",),
    ),
    Claim(
        "C18", "the hysteresis loops of actuator and reservoir are frequency-independent",
        "no dependence on frequency", s.frequency_independent,
        note="last / first quarter of the sweep, over the commanded pressure; limit: a factor of "
        "1.2",
        fitted_by=("C18",), half_fitted_by=("plausible",), shown_in=("fig4", "fig5"),
    ),
    Claim(
        "C19", "the PI controller of the actuator's pressure is nearly ideal",
        "assumed ideal (Sec. III)",
        lambda r, p: [
            Statement("rms pressure error [% of the span]",
                      100 * n.measured(r, "pressure_error", "main"), high=2.0, ratio=False)
        ],
        note="on the first hysteresis experiment; errors of the reservoir's controller are part of "
        "the reservoir (Sec. III-B)",
    ),
    Claim(
        "C20", "the actuator bends by up to about 60 deg", "approximately 60 deg (Sec. II-B)",
        lambda r, p: [
            Statement("largest angle [deg]", n.measured(r, "range", "angle_deg"),
                      0.95 * p["rig"]["bending_range_deg"], 1.05 * p["rig"]["bending_range_deg"],
                      ratio=False)
        ],
        note="limit: 5 %", fitted_by=("plausible",), shown_in=("fig4",),
    ),
    Claim(
        "C21", "the loops of the actuator have a dead zone", "dead zones (Sec. I)",
        lambda r, p: [
            Statement("pressure at which bending begins [% of the span]",
                      100 * n.measured(r, "range", "dead_zone"), low=5.0, ratio=False)
        ],
        note="median over the rises of theta above 1 deg; the limit is ours", shown_in=("fig4",),
    ),
    Claim(
        "C22", "the response of the physical reservoir is usually monotonic",
        "usually monotonic (Sec. III-C)",
        lambda r, p: [
            Statement("rank correlation of P_o with theta between turns",
                      n.measured(r, "range", "monotony"), low=0.95, ratio=False)
        ],
        note="mean over the parts of the sweep between turns of theta; the limit is ours",
        shown_in=("fig5",),
    ),
)  # fmt: skip
