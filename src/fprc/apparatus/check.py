"""Check the valves and sensors of the real rig one by one, before an experiment."""

import logging
from collections.abc import Iterator, Mapping
from typing import Any

from fprc.apparatus.session import Session, Stop, on_rig
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
#: The chamber that a phase fills, its sensor, that of the other chamber, and its valve's output.
_FILLS = {
    "actuator filled": ("actuator", "p_exp_kpa", "p_i_kpa", "main_output"),
    "PAM A filled": ("PAM A", "p_i_kpa", "p_exp_kpa", "reservoir_output"),
}
#: Least pressure rise of a chamber that is filled, and most of one that is not, kPa.
_FILLED_KPA = 0.5 * TEST_KPA
_UNFILLED_KPA = 0.2 * TEST_KPA
#: What a sensor reads at rest, by how much it may differ, and the remedy if it differs by more.
_AT_REST = (
    ("p_exp_kpa", 0.0, 15.0, "vent the actuator, check its sensor's channel and hardware.p_exp"),
    ("p_i_kpa", 0.0, 15.0, "vent the PAM A, check its sensor's channel and hardware.p_i"),
    ("p_o_kpa", 100.0, 40.0, "fill PAM B to 100 kPa and close its hand valve"),
    ("theta_deg", 0.0, 5.0, "correct hardware.theta.offset_deg"),
)


def check_rig(settings: Mapping[str, Any], armed: bool, stop: Stop) -> int:
    """Read every sensor at rest; if armed, also fill and vent one chamber after the other.

    Logs the readings and all problems; returns 0 if there is no problem, else 1.
    """
    settings = {**settings, "hardware": _with_check_limits(settings["hardware"])}
    rate_hz = settings["control"]["sample_rate_hz"]
    present = [name for name in SENSORS if settings["hardware"]["phi"] or name != "phi_deg"]

    def follow(phase: str) -> Session:
        *goals, seconds = PHASES[phase]

        def law(k: int, now: Readings) -> list[float]:
            return [min(k / rate_hz * TEST_KPA / RISE_S, goal) for goal in goals]

        return on_rig(settings, law, round(seconds * rate_hz), stop, moves=phase in _FILLS)

    settled: dict[str, dict[str, float]] = {}
    trouble: list[str] = []
    for phase in PHASES if armed else ("rest",):
        seen = follow(phase)
        time_s, timing = seen.channels["time_s"], seen.timing
        # the second half of the phase, in which the chamber has settled
        judged = time_s >= 0.5 * time_s[-1:]
        values = {name: seen.channels[name][judged] for name in present}
        if time_s.size:
            settled[phase] = {name: float(values[name].mean()) for name in present}
            shown = [
                f"{name} {values[name].mean():.2f} +- {values[name].std():.2f}" for name in values
            ]
            shown.append(f"{timing['overruns']} ticks missed")
            log.info("%s: %s", phase, ", ".join(shown))
            trouble += _problems(phase, settled, bool(seen.stopped))
        if seen.stopped or seen.unvented:
            stopped = f"stopped: {seen.stopped}" if seen.stopped else ""
            trouble = [*filter(None, [stopped, seen.unvented]), *trouble]
            break
    if not armed:
        log.info("valves: kept vented; --armed fills and vents each chamber in turn")
    for line in [f"TROUBLE: {line}" for line in trouble] or ["no trouble found"]:
        log.info("%s", line)
    return 1 if trouble else 0


def _with_check_limits(hardware: Mapping[str, Any]) -> dict[str, Any]:
    """Adapt the limits to a check: allow an empty PAM B, lower the highest pressures."""
    limits = dict(hardware["limits"])
    for name in ("p_exp_kpa", "p_i_kpa"):
        low, high = limits[name]
        limits[name] = (low, min(high, HIGHEST_KPA))
    low, high = limits["p_o_kpa"]
    limits["p_o_kpa"] = (min(low, limits["p_i_kpa"][0]), high)
    return {**hardware, "limits": limits}


def _problems(phase: str, settled: Mapping[str, Mapping[str, float]], cut: bool) -> Iterator[str]:
    """Yield what the mean readings of a phase show; one that was ``cut`` hides what is missing."""
    now, rest = settled[phase], settled["rest"]
    if phase == "rest":
        for name, near, most, remedy in _AT_REST:
            if not abs(now[name] - near) <= most:
                yield f"{name} = {now[name]:.1f} at rest, must be near {near:g}; {remedy}"
        return
    chamber, channel, other, output = _FILLS[phase]
    filled = now[channel] - rest[channel] >= _FILLED_KPA
    moved = now[other] - rest[other]
    if filled and abs(moved) > _UNFILLED_KPA:
        yield f"{chamber} filled, but {other} moved to {now[other]:.1f} kPa; check the hoses"
    elif not filled and (moved > _UNFILLED_KPA or not cut):
        yield f"{chamber}: setpoint {TEST_KPA:g} kPa, but {channel} = {now[channel]:.1f}; " + (
            f"{other} rose instead: hoses, channels or {output} are swapped"
            if moved > _UNFILLED_KPA
            else f"check supply, valve and hardware.boards.{output}"
        )
    bent = now["theta_deg"] - rest["theta_deg"] >= 1.0
    if chamber == "actuator" and filled and not (cut or bent):
        yield (
            f"the actuator was filled, but theta_deg went from {rest['theta_deg']:.1f} to "
            f"{now['theta_deg']:.1f}; it must rise: check the sensor, or its sign in "
            "hardware.theta.gain"
        )
