"""Settings of the rig's calibration."""

from typing import Literal, get_args

from pydantic import Field, model_validator

from fprc.config.rig import free_ranges
from fprc.config.section import Distinct, NotEmpty, Section, quantity

#: Terms of the objective, see ``fprc.studies.calibration.objective``.
Term = Literal[
    "tables", "orders", "plausible", "C1b", "C8", "C9a", "C18", "open_loop", "closed_loop",
    "closed_sweep", "margin",
]  # fmt: skip

#: What a rig may have been searched for, also by searches that are not of this project.
SearchedFor = Literal[Term, "C9b", "C11", "C12"]

#: Seeds from here on belong to fits, so many to each ``calibration.seed``.
FIRST_SEED, SEEDS_PER_FIT = 1_000_000, 10_000

#: Free parameters of each part of the rig; those in lists end in their place.
_FREE = {
    "valve": "dead_zone sonic_conductance_ml_per_s_kpa",
    "main_chamber": "volume_ml volume_ml_per_deg polytropic_index",
    "reservoir_chamber": "volume_ml polytropic_index",
    "bending": "inertia_kpa_s2_per_deg damping_kpa_s_per_deg preload_kpa stiffness_kpa_per_deg "
    "cubic_stiffness_kpa_per_deg3 gain_loss_per_deg relaxation_stiffness_kpa_per_deg.0 "
    "relaxation_stiffness_kpa_per_deg.1 relaxation_time_s.0 relaxation_time_s.1 friction_kpa "
    "friction_per_kpa slip_distance_deg.0 slip_distance_deg.1 slip_distance_deg.2 "
    "slip_distance_deg.3 slip_weight.0 slip_weight.1 slip_weight.2",
    "drift": "sigma_kpa time_s",
    "reservoir": "passive_volume_ml squeeze_damping_kpa_s_per_ml squeeze_stiffness_kpa_per_ml "
    "back_pressure_gain friction_kpa friction_per_kpa slip_distance_ml.0 slip_distance_ml.1 "
    "slip_distance_ml.2 slip_weight.0 slip_weight.1",
    "pressure_sensor": "noise_kpa",
    "bend_sensor": "noise_deg slow_error_deg",
}


class Fitted(Section):
    """Where the rig's parameters come from; a fitted rig's file has this section."""

    name: str = Field("default", pattern=r"^[\w.-]+$", description="name of the rig")
    to: tuple[SearchedFor, ...] = Field(
        (), description="what it was fitted to; all else is predicted"
    )
    seeds: tuple[int, ...] = Field(
        (), description="noise seeds that the fits saw; no further seed may be one of them"
    )


class Calibration(Section):
    """How the rig's free parameters are fitted to the paper."""

    free: Distinct[str] = Field(
        tuple(f"{part}.{name}" for part, names in _FREE.items() for name in names.split()),
        description="parameters of the rig that may change within their ranges; those in lists "
        "have their place in it as the last part of the name",
    )
    ranges: dict[str, tuple[float, float]] = Field(
        {
            # at 0.03 V/kPa, a dead zone of 0.03 leaves 5 kPa of a command
            "valve.dead_zone": (0.005, 0.03),
            # a relaxation within a period of the sweep, and creep
            "bending.relaxation_time_s.0": (0.1, 1.0),
            "bending.relaxation_time_s.1": (4.0, 30.0),
            # loops of Figs. 4 and 5 are rounded and widen with pressure: slip on several scales
            "bending.friction_per_kpa": (0.04, 0.25),
            "bending.slip_distance_deg.0": (0.5, 2.0),
            "bending.slip_distance_deg.1": (2.0, 5.0),
            "bending.slip_distance_deg.2": (5.0, 10.0),
            "bending.slip_distance_deg.3": (10.0, 25.0),
            "bending.slip_weight.0": (0.1, 0.4),
            "bending.slip_weight.1": (0.1, 0.4),
            "bending.slip_weight.2": (0.1, 0.4),
            "reservoir.friction_per_kpa": (0.04, 0.4),
            "reservoir.slip_distance_ml.0": (0.05, 0.3),
            "reservoir.slip_distance_ml.1": (0.3, 1.0),
            "reservoir.slip_distance_ml.2": (1.0, 3.0),
            "reservoir.slip_weight.0": (0.1, 0.45),
            "reservoir.slip_weight.1": (0.1, 0.45),
            # a lag below 0.05 s at most stiffnesses
            "reservoir.squeeze_damping_kpa_s_per_ml": (0.3, 2.0),
            "reservoir.squeeze_stiffness_kpa_per_ml": (12.0, 80.0),
            # print needs hardly any drift; noise of the size of the data sheets
            "drift.sigma_kpa": (0.0, 0.8),
            "drift.time_s": (5.0, 60.0),
            "pressure_sensor.noise_kpa": (0.02, 1.0),
            "bend_sensor.noise_deg": (0.01, 0.2),
            "bend_sensor.slow_error_deg": (0.05, 0.5),
        },
        description="narrower ranges than the physical ones, by free parameter",
    )
    fit: NotEmpty[Term] = Field(
        get_args(Term),
        description="terms of the objective: errors of Tables II and III, their orders (C2, C7), "
        "plausible ranges, claims, open-loop Table IV; closed_loop asks only that FPRC+PD is at "
        "least a fifth below FPRC, margin that it is below FPRC with gains half again as large, "
        "closed_sweep for its printed error in the sweep",
    )
    seed: int = quantity(3, (0, 1000), "seed of the drawn rigs and of all noise in the fit")
    members: int = quantity(60, (1, 10_000), "drawn rigs with plausible loops that are judged")
    starts: int = quantity(8, (1, 1000), "searches, which begin at the best of them")
    rounds: int = quantity(2, (1, 1000), "rounds of each search until the worse half ends")
    last_rounds: int = quantity(28, (1, 1000), "rounds of the search that is left")
    full_seeds: int = quantity(6, (1, 400), "noise seeds of the full models")

    @model_validator(mode="after")
    def _free_parameters_exist(self) -> "Calibration":
        free_ranges(self.free, self.ranges)
        return self
