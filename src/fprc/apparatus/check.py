"""Check the valves and sensors of the real rig one by one, before an experiment."""

import logging
from collections.abc import Mapping
from typing import Any

from fprc.apparatus.session import Guardian, on_rig
from fprc.channels import SENSORS, Readings
from fprc.errors import ControlError

log = logging.getLogger("fprc.rig")

#: Test pressure of each chamber, kPa.
TEST_KPA = 60.0
#: Rise time of the setpoint, s; a step would make the pressure exceed its jump limit.
RISE_S = 0.5
#: Setpoint that vents fully, kPa; it clamps the voltage, and so freezes the PI loop's integral.
VENT = -1e3
#: Pressure limit, kPa: with swapped hoses, a loop fills a chamber whose pressure it does not read.
HIGHEST_KPA = 3.0 * TEST_KPA
#: Of each phase: setpoints of actuator and PAM A, kPa; duration, s; and by sensor the lowest and
#: highest mean reading at rest, later rise since then, and what to check where it is another. Each
#: phase is a session of its own, which begins only if readings have shown both chambers vented.
PHASES = {
    "rest": ((VENT, VENT), 1.0, {
        "p_exp_kpa": (-15.0, 15.0, "vent the actuator, check its sensor and hardware.p_exp"),
        "p_i_kpa": (-15.0, 15.0, "vent the PAM A, check its sensor and hardware.p_i"),
        "p_o_kpa": (60.0, 140.0, "fill PAM B to 100 kPa and close its hand valve"),
        "theta_deg": (-5.0, 5.0, "correct hardware.theta.offset_deg"),
    }),
    "actuator filled": ((TEST_KPA, VENT), 2.0, {
        "p_exp_kpa": (30.0, 90.0, "check supply, hoses, valve, hardware.boards.main_output"),
        "p_i_kpa": (-12.0, 12.0, "hoses, channels or outputs are swapped"),
        "theta_deg": (1.0, 180.0, "check the sensor, or its sign in hardware.theta.gain"),
    }),
    "PAM A filled": ((VENT, TEST_KPA), 2.0, {
        "p_i_kpa": (30.0, 90.0, "check supply, hoses, valve, hardware.boards.reservoir_output"),
        "p_exp_kpa": (-12.0, 12.0, "hoses, channels or outputs are swapped"),
    }),
}  # fmt: skip


def check_rig(settings: Mapping[str, Any], armed: bool, guardian: Guardian) -> None:
    """Read every sensor at rest; if armed, also fill and vent one chamber after the other.

    Logs the readings; ControlError lists all problems.
    """
    hardware, rate_hz = settings["hardware"], settings["control"]["sample_rate_hz"]
    limits = dict(hardware["limits"])
    for name in ("p_exp_kpa", "p_i_kpa"):
        low, high = limits[name]
        limits[name] = low, min(high, HIGHEST_KPA)
    low, high = limits["p_o_kpa"]
    limits["p_o_kpa"] = min(low, limits["p_i_kpa"][0]), high  # PAM B may be empty
    settings = {**settings, "hardware": {**hardware, "limits": limits}}
    present = [name for name in SENSORS if hardware["phi"] or name != "phi_deg"]
    rest: dict[str, float] = {}
    trouble: list[str] = []
    for phase in PHASES if armed else ("rest",):
        goals, seconds, expected = PHASES[phase]

        def law(k: int, now: Readings, goals: tuple[float, float] = goals) -> list[float]:
            return [min(k / rate_hz * TEST_KPA / RISE_S, goal) for goal in goals]

        channels, timing, stopped, unvented = on_rig(
            settings, law, round(seconds * rate_hz), guardian, moves=phase != "rest"
        )
        if stopped:
            swapped = "; if another chamber filled, hoses, channels or outputs are swapped"
            trouble.append(f"{phase}: {stopped}{swapped if rest else ''}")
        else:
            # the second half of the phase, in which the chamber has settled
            settled = slice(len(channels["time_s"]) // 2, None)
            values = {name: channels[name][settled] for name in present}
            means = {name: float(values[name].mean()) for name in present}
            shown = [f"{name} {means[name]:.2f} +- {values[name].std():.2f}" for name in present]
            log.info("%s: %s; %d ticks missed", phase, ", ".join(shown), timing["overruns"])
            for name, (low, high, remedy) in expected.items():
                change = means[name] - rest.get(name, 0.0)
                if not low <= change <= high:
                    what = f"{name} changed by" if rest else f"{name} is"
                    must = f"must be {low:g} to {high:g}"
                    trouble.append(f"{phase}: {what} {change:.1f}, {must}; {remedy}")
                    if rest:  # what else is wrong follows from it
                        break
            rest = rest or means
        if unvented:
            trouble.insert(0, unvented)
        if stopped or unvented:
            break
    if not armed:
        log.info("valves: kept vented; --armed fills and vents each chamber in turn")
    if trouble:
        raise ControlError("\n".join(trouble))
    log.info("no trouble found")
