"""Check the valves and sensors of the real rig one by one, before an experiment."""

import logging
from collections.abc import Callable, Mapping, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np

from fprc.apparatus.session import Session, on_rig
from fprc.channels import SENSORS
from fprc.control import run
from fprc.devices import Clock, Device

log = logging.getLogger("fprc.rig")

#: Test pressure of each chamber, kPa.
TEST_KPA = 60.0
#: Rise time of the setpoint, s; a step would make the pressure exceed its jump limit.
RISE_S = 0.5
#: Setpoint that vents fully, kPa; it clamps the voltage, and so freezes the PI loop's integral.
VENT = -1e3
#: Pressure limit, kPa: with swapped hoses, a loop fills a chamber whose pressure it does not read.
HIGHEST_KPA = 3.0 * TEST_KPA
#: Name, setpoints of actuator and PAM A in kPa, duration in s.
Phase = tuple[str, float, float, float]
PHASES: tuple[Phase, ...] = (
    ("rest", VENT, VENT, 1.0),
    ("actuator filled", TEST_KPA, VENT, 2.0),
    ("actuator vented", VENT, VENT, 2.0),
    ("PAM A filled", VENT, TEST_KPA, 2.0),
    ("PAM A vented", VENT, VENT, 2.0),
)
#: Least pressure rise of a chamber that is filled, and most of one that is not, kPa.
_FILLED_KPA = 0.5 * TEST_KPA
_UNFILLED_KPA = 0.2 * TEST_KPA
#: What a sensor reads at rest, by how much it may differ, and the remedy if it differs by more.
_AT_REST = (
    ("p_exp_kpa", 0.0, 15.0,
     "vent the actuator, check the channel of its sensor and hardware.p_exp"),
    ("p_i_kpa", 0.0, 15.0, "vent the PAM A, check the channel of its sensor and hardware.p_i"),
    ("p_o_kpa", 100.0, 40.0, "fill PAM B to 100 kPa and close its hand valve"),
    ("theta_deg", 0.0, 5.0, "correct hardware.theta.offset_deg"),
)  # fmt: skip


def check_rig(
    settings: Mapping[str, Any],
    armed: bool,
    stop: Callable[[], str],
    guarded: Callable[[], bool] = lambda: True,
) -> int:
    """Read every sensor at rest; if armed, also fill and vent one chamber after the other.

    Logs the readings and all problems; returns 0 if there is no problem, else 1.

    Raises
    ------
    DeviceError
        Lists the parts that do not answer.
    """
    control, hardware = settings["control"], _with_check_limits(settings["hardware"])
    period_s = 1.0 / control["sample_rate_hz"]
    phases = PHASES if armed else PHASES[:1]
    ends = np.cumsum([round(seconds / period_s) for *_, seconds in phases])
    setpoints = _setpoints(phases, ends, period_s).tolist()

    def follow(first: int, end: int, *, moves: bool) -> Session:
        def act(device: Device, clock: Clock) -> dict[str, np.ndarray]:
            still = SimpleNamespace(read=device.read, write=lambda *volts: None, safe=lambda: None)
            return run(
                device if moves else still,
                clock,
                lambda k, now: setpoints[first + k],
                end - first,
                control,
                neutral_v=hardware["valves"]["neutral_v"],
                stop=stop,
            )

        return on_rig(hardware, period_s, act, guarded)

    seen = follow(0, ends[0], moves=False)
    channels = seen.channels
    if armed and not (seen.stopped or seen.unvented):  # a rig that may not vent is not filled
        seen = follow(ends[0], ends[-1], moves=True)
        seen.channels["time_s"] += ends[0] * period_s
        channels = {k: np.append(values, seen.channels[k]) for k, values in channels.items()}
    lines, problems = describe(channels, ends * period_s, phases)
    timing = seen.timing
    lines.append(
        f"loop: {timing['ticks']} ticks, {timing['overruns']} missed, lateness "
        f"{1e3 * timing['jitter_p50_s']:.3f} ms median, "
        f"{1e3 * timing['jitter_max_s']:.3f} ms maximum"
    )
    if not armed:
        lines.append("valves: kept vented; --armed fills and vents each chamber in turn")
    stopped = f"stopped: {seen.stopped}" if seen.stopped else ""
    trouble = [*filter(None, [stopped, seen.unvented]), *problems]
    lines += [f"TROUBLE: {line}" for line in trouble] or ["no trouble found"]
    for line in lines:
        log.info("%s", line)
    return 1 if trouble else 0


def _setpoints(phases: Sequence[Phase], ends: np.ndarray, period_s: float) -> np.ndarray:
    """Return the setpoints of both chambers at every sample, kPa."""
    setpoints = np.empty((ends[-1], 2))
    for (_, *goals, _), begin, end in zip(phases, [0, *ends[:-1]], ends, strict=True):
        risen_kpa = np.arange(end - begin) * period_s * TEST_KPA / RISE_S
        setpoints[begin:end] = np.minimum(risen_kpa[:, None], goals)
    return setpoints


def _with_check_limits(hardware: Mapping[str, Any]) -> dict[str, Any]:
    """Adapt the limits to a check: allow an empty PAM B, lower the highest pressures."""
    limits = dict(hardware["limits"])
    for name in ("p_exp_kpa", "p_i_kpa"):
        low, high = limits[name]
        limits[name] = (low, min(high, HIGHEST_KPA))
    low, high = limits["p_o_kpa"]
    limits["p_o_kpa"] = (min(low, limits["p_i_kpa"][0]), high)
    return {**hardware, "limits": limits}


def describe(
    channels: Mapping[str, np.ndarray], ends_s: np.ndarray, phases: Sequence[Phase]
) -> tuple[list[str], list[str]]:
    """Return a table of the sensors in each phase, as lines, and the problems.

    Parameters
    ----------
    channels : Mapping
        Channels of the run; shorter than the phases if it was stopped.
    ends_s : ndarray
        End of each phase, s.
    """
    time_s = channels["time_s"]
    begins_s = np.concatenate([[0.0], ends_s[:-1]])
    settled: dict[str, dict[str, float]] = {}
    cut = ""  # a phase that was cut short does not show what is missing
    present = [name for name in SENSORS if not np.isnan(channels[name]).all()]
    lines = [f"{'phase':16}" + "".join(f"{name:>18}" for name in present)]
    for (phase, *_), begin_s, end_s in zip(phases, begins_s, ends_s, strict=True):
        within = time_s[(time_s >= begin_s) & (time_s < end_s)]
        if not within.size:
            break
        # the second half of the phase, in which the chamber has settled
        judged = (time_s >= 0.5 * (begin_s + within[-1])) & (time_s <= within[-1])
        values = {name: channels[name][judged] for name in present}
        settled[phase] = {name: float(v.mean()) for name, v in values.items()}
        cut = "" if end_s - within[-1] < 0.1 * (end_s - begin_s) else phase
        cells = [f"{v.mean():.2f} +- {v.std():.2f}" for v in values.values()]
        lines.append(f"{phase:16}" + "".join(f"{cell:>18}" for cell in cells))
    return lines, [*_problems_at_rest(settled.get("rest", {})), *_problems_of_filling(settled, cut)]


def _problems_at_rest(rest: Mapping[str, float]) -> list[str]:
    return [
        f"{name} = {rest[name]:.1f} at rest, must be near {near:g}; {remedy}"
        for name, near, most, remedy in _AT_REST
        if not abs(rest.get(name, near) - near) <= most
    ]


def _problems_of_filling(settled: Mapping[str, Mapping[str, float]], cut: str) -> list[str]:
    problems, before = [], settled.get("rest", {})
    pairs = (
        ("actuator", "p_exp_kpa", "p_i_kpa", "main_output"),
        ("PAM A", "p_i_kpa", "p_exp_kpa", "reservoir_output"),
    )
    for chamber, channel, other, output in pairs:
        filled, vented = settled.get(f"{chamber} filled"), settled.get(f"{chamber} vented")
        if filled is None:
            continue
        if filled[channel] - before[channel] < _FILLED_KPA:
            crossed = filled[other] - before[other] > _UNFILLED_KPA
            if crossed or f"{chamber} filled" != cut:
                problems.append(
                    f"{chamber}: setpoint {TEST_KPA:g} kPa, but {channel} = {filled[channel]:.1f}; "
                    + (f"{other} rose instead: hoses, channels or {output} are swapped" if crossed
                       else f"check supply, valve and hardware.boards.{output}")
                )  # fmt: skip
        elif abs(filled[other] - before[other]) > _UNFILLED_KPA:
            problems.append(
                f"{chamber} filled, but {other} moved to {filled[other]:.1f} kPa; check the hoses"
            )
        if vented and f"{chamber} vented" != cut and vented[channel] > _UNFILLED_KPA:
            problems.append(
                f"{chamber} vented, but {channel} is still {vented[channel]:.1f} kPa; "
                "check the valve and its exhaust"
            )
    filled = settled.get("actuator filled", {})
    bent = (
        filled
        and cut != "actuator filled"
        and filled["p_exp_kpa"] - before["p_exp_kpa"] >= _FILLED_KPA
    )
    if bent and filled["theta_deg"] - before["theta_deg"] < 1.0:
        problems.append(
            f"the actuator was filled, but theta_deg went from {before['theta_deg']:.1f} to "
            f"{filled['theta_deg']:.1f}; it must rise: check the sensor, or its sign in "
            "hardware.theta.gain"
        )
    return problems
