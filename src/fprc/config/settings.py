"""All settings of the workflow; the defaults are the paper's."""

from typing import Annotated, Literal

from annotated_types import Ge, Le
from pydantic import Field, field_validator, model_validator

from fprc.config.free import free_ranges
from fprc.config.rig import Rig
from fprc.config.section import Section, quantities, quantity, within


def rising(limits: tuple[float, float]) -> tuple[float, float]:
    """Check that a range is not empty."""
    if limits[0] >= limits[1]:
        raise ValueError(f"{limits} is empty; put the lower end first")
    return limits


class Chirp(Section):
    """Linear frequency sweep that starts at its lowest value."""

    form: Literal["chirp"] = Field("chirp", description="linear frequency sweep")
    duration_s: float = quantity(120, "s", (1, 3600), "length", "paper, Fig. 4(a)")
    f_start_hz: float = quantity(0.1, "Hz", (0.001, 10), "first frequency", "paper, Fig. 4(a)")
    f_end_hz: float = quantity(1.0, "Hz", (0.001, 10), "last frequency", "paper, Fig. 4(a)")
    amplitude_kpa: float = quantity(
        175, "kPa", (0, 225), "half of the swing", "not printed; the span of the complex signal"
    )
    offset_kpa: float = quantity(
        175, "kPa", (0, 450), "mean", "not printed; the mean of the complex signal"
    )


class Multisine(Section):
    """Sum of equal sines that starts at its lowest value."""

    form: Literal["multisine"] = Field("multisine", description="sum of equal sines")
    duration_s: float = quantity(80, "s", (1, 3600), "length", "paper, Fig. 4(c)")
    f_hz: tuple[within(0.001, 10.0), ...] = quantities(
        (0.12, 0.04, 0.31, 0.29, 0.25), "Hz", (0.001, 10), "frequencies", "paper, Fig. 4(c)"
    )
    amplitude_kpa: float = quantity(35, "kPa", (0, 225), "of each sine", "paper, Fig. 4(c)")
    offset_kpa: float = quantity(175, "kPa", (0, 450), "mean", "paper, Fig. 4(c)")


class Experiments(Section):
    """The two hysteresis experiments, Sec. II-B: training data and test data."""

    sweep: Chirp = Chirp()
    complex: Multisine = Multisine()


class PressureLoop(Section):
    """Software PI loop on a valve voltage."""

    kp_v_per_kpa: float = quantity(0.03, "V/kPa", (0, 1), "proportional gain", "paper, Sec. IV")
    ki_v_per_kpa_s: float = quantity(1e-6, "V/(kPa s)", (0, 1), "integral gain", "paper, Sec. IV")


class Control(Section):
    """What runs on the computer at every sample."""

    sample_rate_hz: float = quantity(200, "Hz", (50, 1000), "refresh rate", "paper, Sec. II-B")
    k_in_kpa_per_deg: float = quantity(
        7.0, "kPa/deg", (0.1, 20), "K_in: reservoir pressure per degree", "paper, Sec. II-B"
    )
    reservoir_limit_kpa: float = quantity(
        450, "kPa", (100, 500), "highest pressure asked of the reservoir", "paper, Sec. II-B"
    )
    main_loop: PressureLoop = PressureLoop()
    reservoir_loop: PressureLoop = PressureLoop(kp_v_per_kpa=0.05)


class Quality(Section):
    """What preprocessing accepts of a raw log."""

    rate_tolerance: float = quantity(0.01, "-", (0, 0.2), "relative error of the mean sample rate")
    gap_periods: float = quantity(1.5, "periods", (1.01, 100), "a longer step is a gap")
    stuck_s: float = quantity(2.0, "s", (0.05, 60), "a channel is stuck if unchanged for longer")
    pressure_range_kpa: tuple[within(-100, 1000), within(-100, 1000)] = quantities(
        (-20, 995), "kPa", (-100, 1000), "readings outside are saturated"
    )
    angle_range_deg: tuple[within(-360, 360), within(-360, 360)] = quantities(
        (-45, 120), "deg", (-360, 360), "readings outside are saturated"
    )
    leak_kpa_per_min: float = quantity(
        5.0, "kPa/min", (0, 100), "a faster fall of P_o at equal P_i is a leak"
    )

    _rises = field_validator("pressure_range_kpa", "angle_range_deg")(rising)


class Esn(Section):
    """Echo state network, Sec. III-A and Table I."""

    r: int = quantity(800, "-", (1, 10000), "reservoir size", "paper, Table I")
    f_input: float = quantity(0.02, "-", (1e-6, 10), "input scaling factor", "paper, Table I")
    gamma: float = quantity(0.8, "-", (0, 0.9999), "leaky rate", "paper, Table I")
    rho: float = quantity(0.4, "-", (0, 1.5), "spectral radius", "paper, Table I")
    washout: int = quantity(100, "samples", (0, 10000), "steps that settle x", "paper, Sec. III-D")


class Fprc(Section):
    """Fuzzy pneumatic reservoir computing, Sec. III-B and Table I."""

    epsilon: float = quantity(0.01, "-", (1e-6, 1), "filter factor", "paper, Table I")
    n_c: int = quantity(8, "-", (1, 64), "fuzzy rules", "paper, Table I")
    n_u: int = quantity(3, "samples", (1, 100), "taps of the readout P_o", "paper, Table I")
    sigma: float = quantity(2.0, "-", (1e-3, 1e3), "Gaussian membership scaling", "paper, Table I")


class Models(Section):
    """The three models; Fuzzy-linear shares n_c and sigma with FPRC."""

    n_y: int = quantity(5, "samples", (1, 100), "taps of theta_d", "paper, Sec. III-D")
    alpha: float = quantity(1e-3, "-", (0, 1e6), "ridge parameter", "paper, Sec. III-D")
    esn: Esn = Esn()
    fprc: Fprc = Fprc()


class Evaluation(Section):
    """How the models are judged, Sec. III-D."""

    folds: int = quantity(5, "-", (2, 100), "folds of the cross-validation", "paper, Sec. III-D")
    split: Literal["shuffled", "blocked"] = Field(
        "shuffled", description="rows of a fold: at random, as the printed spread implies, or "
        "contiguous, which keeps neighbours in time out of the validation"
    )  # fmt: skip
    target: Literal["command", "measured"] = Field(
        "command", description="P_exp that the models learn: commanded or measured pressure"
    )
    timing_repeats: int = quantity(10, "-", (1, 100), "repeats of the timing", "paper, Sec. III-D")
    replicate_seeds: tuple[Annotated[int, Ge(0), Le(2**31)], ...] = Field(
        (301, 302, 303, 304, 305),
        min_length=2,
        description="seeds of the further rigs that tables, sweeps and runs are repeated on",
    )

    @field_validator("replicate_seeds")
    @classmethod
    def _seeds_differ(cls, seeds: tuple[int, ...]) -> tuple[int, ...]:
        if len(set(seeds)) < len(seeds):
            raise ValueError(f"{seeds} repeats a seed; give each once")
        return seeds


class Sweeps(Section):
    """Values of the control-variable sweeps, Sec. III-E."""

    epsilon: tuple[within(1e-6, 1.0), ...] = quantities(
        (1.0, 0.1, 0.01, 1e-3, 1e-4), "-", (1e-6, 1), "filter factors", "paper, Fig. 10(a)"
    )
    n_c: tuple[Annotated[int, Ge(1), Le(64)], ...] = quantities(
        (1, 2, 4, 8, 16), "-", (1, 64), "fuzzy rules", "paper, Fig. 10(b)"
    )
    n_u: tuple[Annotated[int, Ge(1), Le(100)], ...] = quantities(
        tuple(range(1, 11)), "samples", (1, 100), "taps of P_o", "paper, Fig. 11"
    )
    n_y: tuple[Annotated[int, Ge(1), Le(100)], ...] = quantities(
        tuple(range(1, 11)), "samples", (1, 100), "taps of theta_d", "paper, Fig. 11"
    )
    replicate_taps: tuple[Annotated[int, Ge(1), Le(100)], ...] = quantities(
        (1, 3, 5, 8, 10), "samples", (1, 100), "both taps, on the further seeds", "assumed"
    )

    @field_validator("replicate_taps")
    @classmethod
    def _taps_have_a_middle(cls, taps: tuple[int, ...]) -> tuple[int, ...]:
        if len(set(taps)) < max(len(taps), 3):
            raise ValueError(f"{taps} must be three or more different sizes, so that one is medium")
        return taps


class Reference(Section):
    """Bending angle to be followed; it starts at its lowest value."""

    form: Literal["multisine", "chirp"] = Field(
        "multisine", description="sum of equal sines, or linear frequency sweep"
    )
    f_hz: tuple[within(0.001, 10.0), ...] = quantities(
        (0.2,), "Hz", (0.001, 10), "frequencies of the sum, or first and last of the sweep"
    )
    amplitude_deg: float = quantity(
        27.5, "deg", (0, 40), "of each sine", "printed for sweep and complex; else the sweep's"
    )
    offset_deg: float = quantity(
        32.5, "deg", (0, 80), "mean", "printed for sweep and complex; else the sweep's"
    )
    duration_s: float = quantity(40, "s", (1, 3600), "length", "printed for sweep and complex")
    settle_s: float = quantity(
        5, "s", (0, 60), "first value held before; recorded but not judged", "assumed"
    )

    @model_validator(mode="after")
    def _sweep_has_two_ends(self) -> "Reference":
        if self.form == "chirp" and len(self.f_hz) != 2:
            raise ValueError(f"a chirp needs two frequencies in f_hz, not {len(self.f_hz)}")
        return self


class References(Section):
    """The references of Table IV, and that of the disturbance test."""

    sine_0p2: Reference = Reference()
    sine_0p5: Reference = Reference(f_hz=(0.5,))
    sweep: Reference = Reference(form="chirp", f_hz=(0.05, 0.95), duration_s=80)
    complex: Reference = Reference(
        f_hz=(0.12, 0.04, 0.31, 0.29, 0.25), amplitude_deg=6.5, offset_deg=40.5, duration_s=100
    )
    disturbance: Reference = Reference(f_hz=(0.3,))


class Gains(Section):
    """PD controller of the bending angle."""

    kp_kpa_per_deg: float = quantity(0.5, "kPa/deg", (0, 50), "P gain", "paper, Sec. IV")
    kd_kpa_s_per_deg: float = quantity(0.005, "kPa s/deg", (0, 5), "D gain", "paper, Sec. IV")


class Pushes(Section):
    """Random forces on the reservoir in the disturbance test, Fig. 17."""

    quiet_s: float = quantity(12, "s", (0, 600), "no push before", "the paper: a short period")
    every_s: float = quantity(1.2, "s", (0.1, 60), "mean time between two pushes", "assumed")
    sigma_kpa: float = quantity(150, "kPa", (0, 500), "size, standard deviation", "assumed")


class Tracking(Section):
    """The closed-loop runs of Sec. IV."""

    references: References = References()
    printed_gains: Gains = Gains()
    candidate_kp_kpa_per_deg: tuple[within(0.0, 50.0), ...] = quantities(
        (0.5, 1, 2, 3, 4, 5, 6, 8, 10, 12), "kPa/deg", (0, 50),
        "P gains tried on the disturbance reference, undisturbed; D keeps the printed ratio",
    )  # fmt: skip
    pressure_limit_kpa: float = quantity(
        450, "kPa", (100, 500), "highest pressure asked of the actuator", "as the reservoir's"
    )
    angle_range_deg: tuple[within(-10, 120), within(-10, 120)] = quantities(
        (0, 65), "deg", (-10, 120), "references outside are refused", "paper: about 60 deg"
    )
    pushes: Pushes = Pushes()

    @model_validator(mode="after")
    def _pushes_begin_within_the_judged_part(self) -> "Tracking":
        reference, quiet_s = self.references.disturbance, self.pushes.quiet_s
        end_s = reference.settle_s + reference.duration_s
        if not reference.settle_s < quiet_s < end_s:
            raise ValueError(
                f"pushes.quiet_s = {quiet_s:g} s must lie between references.disturbance.settle_s "
                f"= {reference.settle_s:g} s and the end of the run at {end_s:g} s"
            )
        return self


class Plausible(Section):
    """What a fitted rig should show beside the published errors."""

    angle_deg: tuple[within(1, 120), within(1, 120)] = quantities(
        (57, 63), "deg", (1, 120), "largest angle of the sweep", "paper: about 60 deg"
    )
    loop_kpa: tuple[within(1, 400), within(1, 400)] = quantities(
        (45, 75), "kPa", (1, 400), "width of the sweep's loop at mid-angle", "the size of 14.9 kPa"
    )
    loop_growth: tuple[within(0.1, 10), within(0.1, 10)] = quantities(
        (0.87, 1.15), "-", (0.1, 10), "its growth from the first to the last quarter",
        "paper, Sec. II-B: independent of frequency",
    )  # fmt: skip
    p_o_swing_kpa: tuple[within(1, 400), within(1, 400)] = quantities(
        (40, 80), "kPa", (1, 400), "swing of P_o in the sweep", "size of the chambers"
    )
    p_o_loop: tuple[within(0.001, 2), within(0.001, 2)] = quantities(
        (0.17, 0.4), "-", (0.001, 2), "width of P_o's loop over its swing", "paper, Fig. 5"
    )
    p_o_loop_growth: tuple[within(0.1, 10), within(0.1, 10)] = quantities(
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
        "search makes the loops without dry friction, and fits slow drift to the seeds",
    )
    seeds: tuple[Annotated[int, Ge(0), Le(2**31)], ...] = Field(
        (21, 22, 23, 24, 25, 26, 27, 28),
        min_length=1,
        description="noise seeds inside the objective; with few of them it fits their noise",
    )
    check_seeds: tuple[Annotated[int, Ge(0), Le(2**31)], ...] = Field(
        (41, 42, 43, 44, 45, 46, 47, 48),
        min_length=1,
        description="noise seeds on which the fitted rig is compared with the one before it",
    )
    population: int = quantity(14, "-", (4, 1000), "rigs per generation of CMA-ES")
    generations: int = quantity(80, "-", (1, 100000), "generations")
    step: float = quantity(0.1, "-", (1e-3, 1), "first standard deviation, share of each range")
    minutes: float = quantity(60, "min", (0.01, 10000), "no generation begins after this time")
    stride: int = quantity(5, "samples", (1, 1000), "the stand-in fits every n-th row")
    esn_nodes: int = quantity(150, "-", (1, 10000), "size of the stand-in's ESN")
    margin: float = quantity(
        0.05, "-", (0, 1), "FPRC's test error should be below the others' by this, on each seed"
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

    rigs: int = quantity(40, "-", (1, 100000), "rigs")
    chunk: int = quantity(5, "-", (1, 100000), "rigs per job")
    seed: int = quantity(1000, "-", (0, 2**31), "of the draws, and of each rig's noise")
    angle_deg: tuple[within(1, 120), within(1, 120)] = quantities(
        (50, 70), "deg", (1, 120), "a draw with another largest angle is thrown away"
    )
    p_o_swing_kpa: tuple[within(1, 400), within(1, 400)] = quantities(
        (30, 100), "kPa", (1, 400), "a draw with another swing of P_o is thrown away"
    )
    sensitivity_steps: int = quantity(
        5, "-", (2, 100), "values of each parameter in the sensitivity table, end to end"
    )

    _rises = field_validator("angle_deg", "p_o_swing_kpa")(rising)


class Folders(Section):
    """Where files go."""

    raw: str = Field("data/raw", min_length=1, description="raw logs")
    results: str = Field("results", min_length=1, description="everything generated")


class Settings(Section):
    """The whole configuration."""

    source: Literal["sim", "recorded"] = Field(
        "sim",
        description="where raw logs come from: the simulated rig, or files that are already there",
    )
    seed: int = quantity(1, "-", (0, 2**31), "of the rig, its noise and the models")
    folders: Folders = Folders()
    experiments: Experiments = Experiments()
    control: Control = Control()
    quality: Quality = Quality()
    models: Models = Models()
    evaluation: Evaluation = Evaluation()
    sweeps: Sweeps = Sweeps()
    tracking: Tracking = Tracking()
    calibration: Calibration = Calibration()
    ensemble: Ensemble = Ensemble()
    rig: Rig = Rig()

    @model_validator(mode="after")
    def _further_seeds_are_fresh(self) -> "Settings":
        known = {self.seed, *self.calibration.seeds, *self.calibration.check_seeds}
        seen = [seed for seed in self.evaluation.replicate_seeds if seed in known]
        if seen:
            raise ValueError(
                f"evaluation.replicate_seeds: {', '.join(map(str, seen))} is also the main seed or "
                "one of the calibration's; choose seeds that no fit has seen"
            )
        return self

    @model_validator(mode="after")
    def _logs_are_long_enough(self) -> "Settings":
        if self.source != "sim":
            return self
        models, folds = self.models, self.evaluation.folds
        needs = {"n_y": models.n_y, "n_u": models.fprc.n_u, "n_c": models.fprc.n_c}
        problems = []
        for name in ("sweep", "complex"):
            duration_s = getattr(self.experiments, name).duration_s
            samples = round(duration_s * self.control.sample_rate_hz)
            training = samples - -(-samples // folds)
            problems += [
                f"experiments.{name} leaves {training} samples to train on, fewer than "
                f"{key} = {need}; lengthen its duration_s or reduce {key}"
                for key, need in needs.items()
                if training < need
            ]
        if problems:
            raise ValueError("\n  ".join(problems))
        return self
