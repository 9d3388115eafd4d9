"""Check the valves and sensors of the real rig one by one, before an experiment."""

import logging
from collections.abc import Iterator, Mapping
from typing import Any

from fprc.apparatus.session import Guardian, on_rig
from fprc.channels import SENSORS, Readings

log = logging.getLogger("fprc.rig")

#: Test pressure of each chamber, kPa.
TEST_KPA = 60.0
#: Rise time of the setpoint, s; a step would make the pressure exceed its jump limit.
RISE_S = 0.5
#: Setpoint that vents fully, kPa; it clamps the voltage, and so freezes the PI loop's integral.
VENT = -1e3
#: Pressure limit, kPa: with swapped hoses, a loop fills a chamber whose pressure it does not read.
HIGHEST_KPA = 3.0 * TEST_KPA
#: Setpoints of actuator and PAM A in kPa, and duration in s, of each phase. Each is a session of
#: its own: the next one begins only if readings have shown that both chambers are vented.
PHASES = {
    "rest": (VENT, VENT, 1.0),
    "actuator filled": (TEST_KPA, VENT, 2.0),
    "PAM A filled": (VENT, TEST_KPA, 2.0),
}
#: What each phase must show: by how much a mean reading may differ from one in kPa or deg, at rest,
#: or by how much it has risen since then; and what to check where it does not.
_EXPECTED = {
    "rest": {
        "p_exp_kpa": (-15.0, 15.0, "vent the actuator, check its sensor and hardware.p_exp"),
        "p_i_kpa": (-15.0, 15.0, "vent the PAM A, check its sensor and hardware.p_i"),
        "p_o_kpa": (60.0, 140.0, "fill PAM B to 100 kPa and close its hand valve"),
        "theta_deg": (-5.0, 5.0, "correct hardware.theta.offset_deg"),
    },
    "actuator filled": {
        "p_exp_kpa": (30.0, 90.0, "check supply, hoses, valve, hardware.boards.main_output"),
        "p_i_kpa": (-12.0, 12.0, "hoses, channels or outputs are swapped"),
        "theta_deg": (1.0, 180.0, "check the sensor, or its sign in hardware.theta.gain"),
    },
    "PAM A filled": {
        "p_i_kpa": (30.0, 90.0, "check supply, hoses, valve, hardware.boards.reservoir_output"),
        "p_exp_kpa": (-12.0, 12.0, "hoses, channels or outputs are swapped"),
    },
}


def check_rig(settings: Mapping[str, Any], armed: bool, guardian: Guardian) -> int:
    """Read every sensor at rest; if armed, also fill and vent one chamber after the other.

    Logs the readings and all problems; returns 0 if there is no problem, else 1.
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
        *goals, seconds = PHASES[phase]

        def law(k: int, now: Readings, goals: list[float] = goals) -> list[float]:
            return [min(k / rate_hz * TEST_KPA / RISE_S, goal) for goal in goals]

        seen = on_rig(settings, law, round(seconds * rate_hz), guardian, moves=phase != "rest")
        if seen.stopped:
            swapped = "; if another chamber filled, hoses, channels or outputs are swapped"
            trouble.append(f"{phase}: {seen.stopped}{swapped if rest else ''}")
        else:
            # the second half of the phase, in which the chamber has settled
            settled = slice(len(seen.channels["time_s"]) // 2, None)
            values = {name: seen.channels[name][settled] for name in present}
            means = {name: float(values[name].mean()) for name in present}
            shown = [f"{name} {means[name]:.2f} +- {values[name].std():.2f}" for name in values]
            log.info("%s: %s; %d ticks missed", phase, ", ".join(shown), seen.timing["overruns"])
            trouble += _problems(phase, means, rest)
            rest = rest or means
        if seen.unvented:
            trouble.insert(0, seen.unvented)
        if seen.stopped or seen.unvented:
            break
    if not armed:
        log.info("valves: kept vented; --armed fills and vents each chamber in turn")
    for line in [f"TROUBLE: {line}" for line in trouble] or ["no trouble found"]:
        log.info("%s", line)
    return int(bool(trouble))


def _problems(phase: str, means: Mapping[str, float], rest: Mapping[str, float]) -> Iterator[str]:
    """Yield each mean reading of a phase that is not as it must be, and what to check."""
    for name, (low, high, remedy) in _EXPECTED[phase].items():
        change = means[name] - rest.get(name, 0.0)
        if not low <= change <= high:
            what = f"{name} changed by" if rest else f"{name} is"
            yield f"{phase}: {what} {change:.1f}, must be {low:g} to {high:g}; {remedy}"
            if rest:  # what else is wrong follows from it
                return
