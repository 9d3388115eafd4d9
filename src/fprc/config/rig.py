"""Parameters of the simulated rig: unit, physical range and source of each.

The source ``fitted`` means that no data sheet gives the value; the files in ``rigs`` have values
with which the rig reproduces the paper.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Literal

from pydantic import Field

from fprc.config.section import NotEmpty, Section, fields, limit_of, quantity


def _unmatched(section: Section, *pairs: tuple[str, str]) -> Iterator[str]:
    """Yield which lists of elements differ in length, and weights that do not sum to 1."""
    values = dict(section)
    for one, other in pairs:
        if len(values[one]) != len(values[other]):
            yield f"{one} and {other} differ in length; give each element both"
    if abs(sum(values["slip_weight"]) - 1.0) > 1e-9:
        yield f"slip_weight sums to {sum(values['slip_weight']):.6g}; must be 1"


def stiffest_squeeze(rig: Mapping[str, Any]) -> float:
    """Return the stiffness of the squeeze while its friction sticks at full supply, kPa/mL."""
    reservoir = rig["reservoir"]
    highest_kpa = (
        reservoir["friction_kpa"] + reservoir["friction_per_kpa"] * rig["valve"]["supply_kpa_abs"]
    )
    pairs = zip(reservoir["slip_weight"], reservoir["slip_distance_ml"], strict=True)
    return reservoir["squeeze_stiffness_kpa_per_ml"] + highest_kpa * sum(w / d for w, d in pairs)


#: Longest lag of the squeeze, s: a corner of 3 Hz, above the 1 Hz to which P_o follows without
#: dependence on the frequency (paper, Sec. II-B).
LONGEST_LAG_S = 0.05

_ATMOSPHERE_KPA = 101.325


def squeeze_lag(rig: Mapping[str, Any]) -> float:
    """Return the time constant of the squeeze while it slips, with PAM B at rest, s.

    c_s / (k_s + g dP_o/ds), where dP_o/ds = P_o / V_B (absolute) of an isothermal gas.
    """
    reservoir = rig["reservoir"]
    per_ml = (reservoir["precharge_kpa"] + _ATMOSPHERE_KPA) / reservoir["passive_volume_ml"]
    stiffness = reservoir["squeeze_stiffness_kpa_per_ml"] + reservoir["back_pressure_gain"] * per_ml
    return float(reservoir["squeeze_damping_kpa_s_per_ml"] / stiffness)


# fmt: off
class Valve(Section):
    """Both proportional valves, Festo MPYE-5-M5-010B."""

    natural_frequency_rad_per_s: float = quantity(628.3, (300, 1300),
        "natural frequency of the spool", "data sheet: 100 Hz")
    damping_ratio: float = quantity(0.7, (0.3, 1.5), "damping ratio of the spool", "typical")
    dead_zone: float = quantity(0.02, (0.005, 0.05), "overlap per side", "fitted", unit="stroke")
    leak: float = quantity(0.002, (0.0, 0.02), "opening of both edges by the spool's clearance",
        "typical", unit="opening")
    sonic_conductance_ml_per_s_kpa: float = quantity(7.86, (3.93, 11.8),
        "sonic conductance C, fully open",
        "data sheet: 100 L/min from 6 to 5 bar is 3.93; fitted within 1-3 times that")
    critical_pressure_ratio: float = quantity(0.3, (0.2, 0.5), "critical pressure ratio b",
        "ISO 6358, typical of spool valves")
    supply_kpa_abs: float = quantity(600, (500, 800), "supply pressure", "assumed: 5 bar gauge")
    neutral_v: float = quantity(5, (4.5, 5.5), "voltage of the closed centre", "data sheet")


class Chamber(Section):
    """A chamber behind a valve; PAM A grows by the volume that it squeezes out of PAM B."""

    volume_ml: float = quantity(20, (11, 40), "volume at rest with tube", "size of muscle; fitted")
    polytropic_index: float = quantity(1.1, (1.0, 1.4),
        "polytropic exponent: 1 isothermal, 1.4 adiabatic", "between the two at 1 Hz")


class BendingChamber(Chamber):
    """The chamber of the actuator."""

    volume_ml_per_deg: float = quantity(0.3, (0, 0.6), "growth with the angle", "size of muscle")


class Bending(Section):
    """Mechanics of the bending actuator; torques are in kPa, angles in deg."""

    inertia_kpa_s2_per_deg: float = quantity(6e-4, (2e-4, 3e-3), "inertia J",
        "free swing of 5 to 15 Hz; fitted")
    damping_kpa_s_per_deg: float = quantity(0.05, (0.01, 0.1), "viscous damping c", "fitted")
    preload_kpa: float = quantity(45, (20, 90), "pressure at which bending begins, g_p", "fitted")
    stiffness_kpa_per_deg: float = quantity(3.0, (2.0, 4.5), "linear stiffness k1",
        "about 60 deg at 350 kPa; fitted")
    cubic_stiffness_kpa_per_deg3: float = quantity(3e-4, (0, 1e-3), "cubic stiffness k3",
        "about 60 deg at 350 kPa; fitted")
    gain_loss_per_deg: float = quantity(0.0, (0, 0.005), "relative loss of torque with bending, g0",
        "McKibben muscle")
    relaxation_stiffness_kpa_per_deg: NotEmpty[float] = quantity((0.5, 0.5), (0, 3),
        "stiffness of each viscoelastic branch", "rubber; fitted")
    relaxation_time_s: NotEmpty[float] = quantity((0.25, 4.0), (0.05, 30),
        "time constant of each viscoelastic branch", "rubber; fitted")
    friction_kpa: float = quantity(4.0, (0, 15), "dry friction at zero pressure, Tc", "fitted")
    friction_per_kpa: float = quantity(0.08, (0.0, 0.25),
        "growth of the dry friction with pressure, mu", "fabric pressed on rubber; fitted",
        unit="-")
    slip_distance_deg: NotEmpty[float] = quantity((1, 3, 7, 14), (0.1, 60),
        "angle at which each Maxwell element slips", "rounded loops need several")
    slip_weight: NotEmpty[float] = quantity((0.3, 0.3, 0.25, 0.15), (0, 1),
        "share of each Maxwell element; they sum to 1", "rounded loops need several")
    stop_stiffness_kpa_per_deg: float = quantity(150, (50, 300),
        "stiffness of the straight actuator below 0 deg", "a firm stop")
    stop_damping_kpa_s_per_deg: float = quantity(0.2, (0, 0.4),
        "damping of the straight actuator below 0 deg", "a firm stop")

    def _problems(self) -> Iterator[str]:
        branches = ("relaxation_stiffness_kpa_per_deg", "relaxation_time_s")
        return _unmatched(self, branches, ("slip_distance_deg", "slip_weight"))


class Drift(Section):
    """An Ornstein-Uhlenbeck torque that nothing measures; the model does not name its cause."""

    sigma_kpa: float = quantity(8.0, (0, 15), "standard deviation of the torque", "fitted")
    time_s: float = quantity(8.0, (1, 60), "correlation time of that torque", "fitted")


class Reservoir(Section):
    """Dual-PAM reservoir: squeeze of the sealed chamber by the active one."""

    passive_volume_ml: float = quantity(30, (11, 80), "volume of PAM B at rest", "size of muscle")
    precharge_kpa: float = quantity(100, (0, 200), "gauge pressure at sealing", "paper, Sec. II-A")
    squeeze_damping_kpa_s_per_ml: float = quantity(1.0, (0.3, 5),
        "viscous resistance of the fabric, c_s", "fitted; short lag")
    squeeze_stiffness_kpa_per_ml: float = quantity(35, (5, 150), "stiffness of the fabric, k_s",
        "swing of P_o; fitted")
    back_pressure_gain: float = quantity(1.0, (0.2, 3),
        "back pressure on the squeeze over the rise of P_o", "area ratio")
    friction_kpa: float = quantity(5.0, (0, 40), "dry friction of the fabric at P_i = 0", "fitted")
    friction_per_kpa: float = quantity(0.12, (0, 0.4),
        "growth of that friction with P_i", "loop width over swing 0.17-0.4; fitted", unit="-")
    slip_distance_ml: NotEmpty[float] = quantity((0.15, 0.5, 1.2), (0.01, 10),
        "squeeze at which each Maxwell element slips", "fitted")
    slip_weight: NotEmpty[float] = quantity((0.4, 0.35, 0.25), (0, 1),
        "share of each Maxwell element; they sum to 1", "fitted")
    leak_ml_per_s_kpa: float = quantity(0.0, (0, 0.1), "leak of the hand valve", "sealed: none")
    bending_stiffness_kpa_per_deg: float = quantity(9.0, (2, 20),
        "stiffness of the reservoir's bending", "about 40 deg at 440 kPa")
    bending_time_s: float = quantity(0.08, (0.02, 0.5), "time constant of that bending", "assumed")
    bending_volume_ml_per_deg: float = quantity(0.01, (0, 0.05),
        "volume that the reservoir's bending takes from PAM B",
        "weak, as the paper explains the robustness of P_o")

    def _problems(self) -> Iterator[str]:
        return _unmatched(self, ("slip_distance_ml", "slip_weight"))


class PressureSensor(Section):
    """The three pressure transducers, SMC PSE540A-R06."""

    zero_v: float = quantity(1, (0, 2), "output at 0 kPa", "data sheet: 1-5 V")
    span_v: float = quantity(4, (1, 10), "output span over full scale", "data sheet: 1-5 V")
    full_scale_kpa: float = quantity(1000, (100, 2000), "full scale", "data sheet: 1 MPa")
    linearity: float = quantity(0.007, (0, 0.01), "limit on gain, offset and bow errors",
        "data sheet: 0.7 %", unit="full scale")
    noise_kpa: float = quantity(0.4, (0, 1.5), "std of the white noise", "bench: 0.3-0.5")
    lag_s: float = quantity(1e-3, (1e-4, 0.01), "first-order lag", "data sheet")


class BendSensor(Section):
    """The angle sensor, Bend Labs one-axis, on its own clock."""

    rate_hz: float = quantity(202.27, (50, 500), "sample rate", "81/16384 s, nominally 200 Hz")
    step_deg: float = quantity(0.015625, (1e-3, 0.5), "resolution", "data sheet: int16 / 64")
    noise_deg: float = quantity(0.04, (0, 0.2), "std of the white noise", "bench: 0.02-0.06")
    slow_error_deg: float = quantity(0.15, (0, 0.5), "std of the slow error", "bench: 0.1-0.2")
    slow_error_time_s: float = quantity(20, (1, 100), "correlation time of that error", "assumed")


class Converter(Section):
    """Analog boards, Contec AI-1616L-LPE and AO-1608L-LPE."""

    limit_v: float = quantity(10, (5, 10), "range is +- this", "data sheet")
    step_v: float = quantity(20 / 65536, (1e-6, 0.1), "16 bits over the range", "data sheet")
    scan_s: float = quantity(1e-5, (0, 1e-3), "delay from one input to the next", "data sheet")


class Rig(Section):
    """The simulated rig; a real rig does not use this section."""

    step_s: float = quantity(5e-4, (1e-5, 5e-4), "longest integration step", "resolves the spool")
    friction_law: Literal["maxwell_slip", "bouc_wen"] = Field("maxwell_slip",
        description="dry friction: Maxwell-slip elements, whose minor loops close, or one Bouc-Wen "
        "element of 0.8 times their mean slip distance")
    valve: Valve = Valve()
    main_chamber: BendingChamber = BendingChamber()
    reservoir_chamber: Chamber = Chamber()
    bending: Bending = Bending()
    drift: Drift = Drift()
    reservoir: Reservoir = Reservoir()
    pressure_sensor: PressureSensor = PressureSensor()
    bend_sensor: BendSensor = BendSensor()
    converter: Converter = Converter()
    # fmt: on

    def _problems(self) -> Iterator[str]:
        rig = self.model_dump()
        share = self.step_s * stiffest_squeeze(rig) / self.reservoir.squeeze_damping_kpa_s_per_ml
        if share > 0.5:
            yield (
                f"step_s covers {share:.2g} of the squeeze's way to equilibrium, must be at most "
                "0.5; reduce it, or raise slip_distance_ml or squeeze_damping_kpa_s_per_ml"
            )
        if (lag := squeeze_lag(rig)) > LONGEST_LAG_S:
            yield (
                f"the squeeze lags by {lag:.2g} s, must be at most {LONGEST_LAG_S} s; reduce "
                "squeeze_damping_kpa_s_per_ml or raise squeeze_stiffness_kpa_per_ml"
            )


def free_ranges(
    paths: Sequence[str], narrower: Mapping[str, Sequence[float]]
) -> dict[str, tuple[float, float]]:
    """Return the range of each free parameter, physical unless a narrower one is given.

    ValueError lists every path that is not a number of the rig, and every range that is empty or
    exceeds the physical one.
    """
    physical: dict[str, tuple[float, float]] = {}
    for key, default, field, _ in fields(Rig):
        if limit := limit_of(field):
            # of a list each number; weights sum to 1, so the last one follows
            count = len(default) - key.endswith(".slip_weight") if isinstance(default, tuple) else 0
            for path in [f"{key}.{index}" for index in range(count)] or [key]:
                physical[path] = limit.low, limit.high
    ranges, problems = {}, []
    for path in paths:
        if path not in physical:
            problems.append(f"free: {path} is no number of the rig that can be free")
            continue
        lowest, highest = physical[path]
        low, high = map(float, narrower.get(path, (lowest, highest)))
        if not lowest <= low < high <= highest:
            within = f"must rise and lie within {lowest:g} to {highest:g}"
            problems.append(f"ranges: {path} {within}")
        ranges[path] = low, high
    if problems:
        raise ValueError("\n  ".join(problems))
    return ranges
