"""Settings of the rig's calibration, and of the ensemble of random rigs."""

from typing import Annotated

from pydantic import Field, field_validator, model_validator

from fprc.config.free import free_ranges
from fprc.config.section import Pair, Section, quantities, quantity, rising, within


class Plausible(Section):
    """Plausible ranges for a fitted rig, beside the published errors."""

    angle_deg: Pair[Annotated[float, within(1, 120)]] = quantities(
        (57, 63), "deg", (1, 120), "largest angle of the sweep", "paper: about 60 deg"
    )
    loop_kpa: Pair[Annotated[float, within(1, 400)]] = quantities(
        (45, 75), "kPa", (1, 400), "width of the sweep's loop at mid-angle", "the size of 14.9 kPa"
    )
    loop_growth: Pair[Annotated[float, within(0.1, 10)]] = quantities(
        (0.87, 1.15), "-", (0.1, 10), "its growth from the first to the last quarter",
        "paper, Sec. II-B: independent of frequency",
    )  # fmt: skip
    p_o_swing_kpa: Pair[Annotated[float, within(1, 400)]] = quantities(
        (40, 80), "kPa", (1, 400), "swing of P_o in the sweep", "size of the chambers"
    )
    p_o_loop: Pair[Annotated[float, within(0.001, 2)]] = quantities(
        (0.17, 0.4), "-", (0.001, 2), "width of P_o's loop over its swing", "paper, Fig. 5"
    )
    p_o_loop_growth: Pair[Annotated[float, within(0.1, 10)]] = quantities(
        (0.87, 1.15), "-", (0.1, 10), "its growth from the first to the last quarter",
        "paper, Sec. II-B: independent of frequency",
    )  # fmt: skip

    _rises = field_validator("*")(rising)


class Calibration(Section):
    """How the rig's free parameters are fitted to Tables II and III."""

    free: tuple[str, ...] = Field(
        (
            "valve.dead_zone",
            "valve.sonic_conductance_ml_per_s_kpa",
            "main_chamber.volume_ml",
            "reservoir_chamber.volume_ml",
            "bending.damping_kpa_s_per_deg",
            "bending.preload_kpa",
            "bending.stiffness_kpa_per_deg",
            "bending.cubic_stiffness_kpa_per_deg3",
            "bending.gain_loss_per_deg",
            "bending.relaxation_stiffness_kpa_per_deg.0",
            "bending.relaxation_stiffness_kpa_per_deg.1",
            "bending.relaxation_time_s.0",
            "bending.relaxation_time_s.1",
            "bending.friction_kpa",
            "bending.friction_per_kpa",
            "bending.slip_distance_deg",
            "drift.sigma_kpa",
            "drift.time_s",
            "reservoir.passive_volume_ml",
            "reservoir.squeeze_damping_kpa_s_per_ml",
            "reservoir.squeeze_stiffness_kpa_per_ml",
            "reservoir.back_pressure_gain",
            "reservoir.friction_kpa",
            "reservoir.friction_per_kpa",
            "reservoir.slip_distance_ml",
            "pressure_sensor.noise_kpa",
        ),
        min_length=2,
        description="parameters of the rig that may change within their ranges; a list is scaled "
        "as a whole unless one of its numbers is named",
    )
    ranges: dict[str, tuple[float, float]] = Field(
        {
            "bending.friction_kpa": (1.0, 7.0),
            "bending.friction_per_kpa": (0.04, 0.12),
            "drift.sigma_kpa": (4.0, 9.0),
            "drift.time_s": (4.0, 12.0),
            "reservoir.back_pressure_gain": (0.5, 1.5),
            "reservoir.squeeze_damping_kpa_s_per_ml": (0.3, 5.0),
        },
        description="narrower ranges than the physical ones, by free parameter; without them the "
        "search makes the loops without dry friction, and fits slow drift to the noise seeds",
    )
    seeds: tuple[Annotated[int, within(0, 2**31)], ...] = Field(
        (21, 22, 23, 24, 25, 26, 27, 28),
        min_length=1,
        description="noise seeds of the objective; with too few, the search fits their noise",
    )
    check_seeds: tuple[Annotated[int, within(0, 2**31)], ...] = Field(
        (41, 42, 43, 44, 45, 46, 47, 48),
        min_length=1,
        description="noise seeds on which the fitted rig is compared with the one before it",
    )
    population: int = quantity(14, "-", (4, 1000), "rigs per generation of CMA-ES")
    generations: int = quantity(80, "-", (1, 100000), "generations")
    step: float = quantity(0.1, "-", (1e-3, 1), "first standard deviation, share of each range")
    minutes: float = quantity(60, "min", (0.01, 10000), "no generation begins after this time")
    stride: int = quantity(5, "samples", (1, 1000), "the surrogate models fit every n-th row")
    esn_nodes: int = quantity(150, "-", (1, 10000), "reservoir size of the surrogate ESN")
    margin: float = quantity(
        0.05, "-", (0, 1), "FPRC's test error should be lower than the others by this, on each seed"
    )
    ratio: float = quantity(
        1.15, "-", (1, 10), "training errors of ESN and FPRC should be within this factor"
    )
    plausible: Plausible = Plausible()

    @model_validator(mode="after")
    def _free_parameters_exist(self) -> "Calibration":
        free_ranges(self.free, self.ranges)
        return self


class Ensemble(Section):
    """Rigs drawn from the ranges of the free parameters instead of fitted."""

    rigs: int = quantity(40, "-", (1, 1_000_000), "rigs")
    chunk: int = quantity(5, "-", (1, 100000), "rigs per job")
    seed: int = quantity(1000, "-", (0, 2**31), "seed of the draws, and of each rig's noise")
    angle_deg: Pair[Annotated[float, within(1, 120)]] = quantities(
        (50, 70), "deg", (1, 120), "draws with a largest angle outside are rejected"
    )
    p_o_swing_kpa: Pair[Annotated[float, within(1, 400)]] = quantities(
        (30, 100), "kPa", (1, 400), "draws with a swing of P_o outside are rejected"
    )
    sensitivity_steps: int = quantity(
        5, "-", (2, 100), "values of each parameter in the sensitivity table, end to end"
    )

    _rises = field_validator("angle_deg", "p_o_swing_kpa")(rising)
