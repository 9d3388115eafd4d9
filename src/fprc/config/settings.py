"""All settings of the workflow; the defaults are the paper's."""

from importlib.util import find_spec
from typing import Annotated, Literal

from pydantic import Field, field_validator, model_validator

from fprc.config.calibration import Calibration, Ensemble, Fitted, Posterior
from fprc.config.folders import Folders
from fprc.config.hardware import Hardware
from fprc.config.rig import Rig
from fprc.config.section import Pair, Section, quantities, quantity, rising, within
from fprc.paper import controller_and_gain
from fprc.registry import MODELS


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
    f_hz: tuple[Annotated[float, within(0.001, 10.0)], ...] = quantities(
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

    # positive: more voltage fills the chamber
    kp_v_per_kpa: float = quantity(0.03, "V/kPa", (1e-4, 1), "proportional gain", "paper, Sec. IV")
    ki_v_per_kpa_s: float = quantity(1e-6, "V/(kPa s)", (0, 1), "integral gain", "paper, Sec. IV")


class Control(Section):
    """Controllers that run on the computer at every sample."""

    sample_rate_hz: float = quantity(200, "Hz", (50, 1000), "refresh rate", "paper, Sec. II-B")
    k_in_kpa_per_deg: float = quantity(
        7.0, "kPa/deg", (0.1, 20), "K_in: reservoir pressure per degree", "paper, Sec. II-B"
    )
    reservoir_limit_kpa: float = quantity(
        450, "kPa", (100, 500), "largest pressure command to the reservoir", "paper, Sec. II-B"
    )
    main_loop: PressureLoop = PressureLoop()
    reservoir_loop: PressureLoop = PressureLoop(kp_v_per_kpa=0.05)


class Quality(Section):
    """Checks of a raw log in preprocessing."""

    rate_tolerance: float = quantity(0.01, "-", (0, 0.2), "relative error of the mean sample rate")
    gap_periods: float = quantity(1.5, "periods", (1.01, 100), "a longer step is a gap")
    stuck_s: float = quantity(2.0, "s", (0.05, 60), "a channel is stuck if unchanged for longer")
    pressure_range_kpa: Pair[Annotated[float, within(-100, 1000)]] = quantities(
        (-20, 995), "kPa", (-100, 1000), "commands and readings outside are implausible"
    )
    angle_range_deg: Pair[Annotated[float, within(-360, 360)]] = quantities(
        (-45, 120), "deg", (-360, 360), "theta and theta_d outside are implausible"
    )
    reservoir_angle_range_deg: Pair[Annotated[float, within(-360, 360)]] = quantities(
        (-120, 120), "deg", (-360, 360), "phi outside is implausible"
    )
    voltage_range_v: Pair[Annotated[float, within(-20, 20)]] = quantities(
        (0, 10), "V", (-20, 20), "voltages of the valves outside are implausible"
    )
    effort_range_kpa: Pair[Annotated[float, within(-10000, 10000)]] = quantities(
        (-1000, 1000), "kPa", (-10000, 10000), "P_ff and P_fb outside are implausible"
    )
    leak_kpa_per_min: float = quantity(
        5.0, "kPa/min", (0, 100), "P_o that falls faster at equal P_i is a leak"
    )

    _rises = field_validator(
        "pressure_range_kpa",
        "angle_range_deg",
        "reservoir_angle_range_deg",
        "voltage_range_v",
        "effort_range_kpa",
    )(rising)


class Esn(Section):
    """Echo state network, Sec. III-A and Table I."""

    r: int = quantity(800, "-", (1, 10000), "reservoir size", "paper, Table I")
    f_input: float = quantity(0.02, "-", (1e-6, 10), "input scaling factor", "paper, Table I")
    gamma: float = quantity(0.8, "-", (0, 0.9999), "leaky rate", "paper, Table I")
    rho: float = quantity(0.4, "-", (0, 1.5), "spectral radius", "paper, Table I")
    washout: int = quantity(
        100, "samples", (0, 10000), "steps that settle the state x", "paper, Sec. III-D"
    )


class Fprc(Section):
    """Fuzzy pneumatic reservoir computing, Sec. III-B and Table I."""

    epsilon: float = quantity(0.01, "-", (1e-6, 1), "filter factor", "paper, Table I")
    n_c: int = quantity(8, "-", (1, 64), "fuzzy rules", "paper, Table I")
    n_u: int = quantity(3, "samples", (1, 100), "taps of the readout P_o", "paper, Table I")
    sigma: float = quantity(2.0, "-", (1e-3, 1e3), "Gaussian membership scaling", "paper, Table I")
    clustering: Literal["fprc", "scikit-fuzzy"] = Field(
        "fprc", description="fuzzy c-means of this package, or that of scikit-fuzzy"
    )
    restarts: int = quantity(
        1, "-", (1, 1000), "starts of the clustering; the lowest objective is kept"
    )

    @field_validator("clustering")
    @classmethod
    def _is_installed(cls, clustering: str) -> str:
        if clustering == "scikit-fuzzy" and find_spec("skfuzzy") is None:
            raise ValueError("scikit-fuzzy is not installed: pip install scikit-fuzzy")
        return clustering


class Other(Section):
    """A model from outside this package; docs/extending.md shows one."""

    estimator: str = Field(
        pattern=r"^[A-Za-z_]\w*(\.[A-Za-z_]\w*)+$", description="its class, module.Class"
    )
    inputs: tuple[Literal["theta_deg"]] | tuple[Literal["theta_deg"], Literal["p_o_kpa"]] = Field(
        ("theta_deg",), description="its input channels, in the order of its columns"
    )
    settings: dict[str, bool | int | float | str] = Field(
        {}, description="parameters of its constructor"
    )


class Models(Section):
    """The three models; Fuzzy-linear shares n_c, sigma and the clustering with FPRC."""

    n_y: int = quantity(5, "samples", (1, 100), "taps of theta_d", "paper, Sec. III-D")
    alpha: float = quantity(1e-3, "-", (0, 1e6), "ridge parameter", "paper, Sec. III-D")
    esn: Esn = Esn()
    fprc: Fprc = Fprc()
    others: dict[Annotated[str, Field(pattern=r"^[a-z][a-z0-9]*(_[a-z0-9]+)*$")], Other] = Field(
        {}, description="models from outside this package, by name; docs/extending.md"
    )

    @field_validator("others")
    @classmethod
    def _names_are_free(cls, others: dict[str, Other]) -> dict[str, Other]:
        taken = [
            name
            for name in others
            if name in (*MODELS, "pd")
            or name.endswith("_pd")
            or controller_and_gain(name)[1] != "none"
        ]
        if taken:
            raise ValueError(f"{', '.join(taken)} is taken; choose another name")
        return others


class Evaluation(Section):
    """How the models are evaluated, Sec. III-D."""

    folds: int = quantity(5, "-", (2, 100), "folds of the cross-validation", "paper, Sec. III-D")
    split: Literal["shuffled", "blocked"] = Field(
        "shuffled", description="rows of a fold: at random, as the printed spread implies, or "
        "contiguous, which keeps neighbours in time out of the validation"
    )  # fmt: skip
    purge_s: float = quantity(
        2.0, "s", (0, 60), "time on each side of a contiguous fold that does not train"
    )
    target: Literal["command", "measured"] = Field(
        "command", description="P_exp that the models learn: commanded or measured pressure"
    )
    reservoir: Literal["recorded", "simulated"] = Field(
        "recorded",
        description="P_o of recorded logs: the recorded one, or that of the simulated reservoir, "
        "driven by the recorded theta",
    )
    reservoir_zero_deg: float = quantity(
        0, "deg", (-1e4, 1e4), "recorded theta at which the simulated reservoir is vented"
    )
    timing_repeats: int = quantity(10, "-", (1, 100), "repeats of the timing", "paper, Sec. III-D")
    replicate_seeds: tuple[Annotated[int, within(0, 2**31)], ...] = Field(
        (501, 502, 503, 504, 505, 506, 507, 508, 509, 510),
        min_length=2,
        description="seeds of further rigs, on which tables, grids and runs are repeated",
    )
    verdict_seeds: int = quantity(
        10, "-", (2, 100000), "the first of these seeds decide the verdicts, however many there are"
    )

    @field_validator("replicate_seeds")
    @classmethod
    def _seeds_differ(cls, seeds: tuple[int, ...]) -> tuple[int, ...]:
        if len(set(seeds)) < len(seeds):
            raise ValueError(f"{seeds} repeats a seed; give each once")
        return seeds


class Grids(Section):
    """Grids of control variables, Sec. III-E."""

    epsilon: tuple[Annotated[float, within(1e-6, 1.0)], ...] = quantities(
        (1.0, 0.1, 0.01, 1e-3, 1e-4), "-", (1e-6, 1), "filter factors", "paper, Fig. 10(a)"
    )
    n_c: tuple[Annotated[int, within(1, 64)], ...] = quantities(
        (1, 2, 4, 8, 16), "-", (1, 64), "fuzzy rules", "paper, Fig. 10(b)"
    )
    n_u: tuple[Annotated[int, within(1, 100)], ...] = quantities(
        tuple(range(1, 11)), "samples", (1, 100), "taps of P_o", "paper, Fig. 11"
    )
    n_y: tuple[Annotated[int, within(1, 100)], ...] = quantities(
        tuple(range(1, 11)), "samples", (1, 100), "taps of theta_d", "paper, Fig. 11"
    )
    readout_taps: tuple[Annotated[int, within(1, 100)], ...] = quantities(
        (1, 3, 5, 8, 10), "samples", (1, 100), "taps of P_o in the controls of the readout",
        "assumed",
    )  # fmt: skip
    chunks: int = quantity(
        1, "-", (1, 100), "jobs per grid; jobs beyond its number of cells are idle"
    )

    @field_validator("n_u")
    @classmethod
    def _taps_have_a_middle(cls, taps: tuple[int, ...]) -> tuple[int, ...]:
        if len(set(taps)) < max(len(taps), 3):
            raise ValueError(f"{taps} must be three or more different sizes, so that one is medium")
        return taps


class Reference(Section):
    """Reference of the bending angle; it starts at its lowest value."""

    form: Literal["multisine", "chirp"] = Field(
        "multisine", description="sum of equal sines, or linear frequency sweep"
    )
    f_hz: tuple[Annotated[float, within(0.001, 10.0)], ...] = quantities(
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
        5, "s", (0, 60), "time at the first value before; recorded, not evaluated", "assumed"
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

    kp_kpa_per_deg: float = quantity(0.5, "kPa/deg", (1e-3, 50), "P gain", "paper, Sec. IV")
    kd_kpa_s_per_deg: float = quantity(0.005, "kPa s/deg", (0, 5), "D gain", "paper, Sec. IV")


class Pushes(Section):
    """Random forces on the reservoir in the disturbance test, Fig. 17."""

    quiet_s: float = quantity(
        12, "s", (0, 600), "no push before this time", "the paper: a short period"
    )
    every_s: float = quantity(1.2, "s", (0.1, 60), "mean time between two pushes", "assumed")
    sigma_kpa: float = quantity(150, "kPa", (0, 500), "size, standard deviation", "assumed")


class Tracking(Section):
    """The closed-loop runs of Sec. IV."""

    references: References = References()
    printed_gains: Gains = Gains()
    candidate_kp_kpa_per_deg: tuple[Annotated[float, within(0.0, 50.0)], ...] = quantities(
        (0.5, 1, 2, 3, 4, 5, 6, 8, 10, 12), "kPa/deg", (0, 50),
        "P gains tried on the disturbance reference, undisturbed; D keeps the printed ratio",
    )  # fmt: skip
    pressure_limit_kpa: float = quantity(
        450, "kPa", (100, 500), "largest pressure command to the actuator", "as the reservoir's"
    )
    angle_range_deg: Pair[Annotated[float, within(-10, 120)]] = quantities(
        (0, 65), "deg", (-10, 120), "references outside are refused", "paper: about 60 deg"
    )
    pushes: Pushes = Pushes()

    @model_validator(mode="after")
    def _pushes_begin_within_the_evaluated_part(self) -> "Tracking":
        reference, quiet_s = self.references.disturbance, self.pushes.quiet_s
        end_s = reference.settle_s + reference.duration_s
        if not reference.settle_s < quiet_s < end_s:
            raise ValueError(
                f"pushes.quiet_s = {quiet_s:g} s must lie between references.disturbance.settle_s "
                f"= {reference.settle_s:g} s and the end of the run at {end_s:g} s"
            )
        return self


class Settings(Section):
    """The whole configuration."""

    source: Literal["sim", "rig", "recorded"] = Field(
        "sim",
        description="where raw logs come from: the simulated rig, the real one, or existing files",
    )
    armed: bool = Field(
        False, description="whether a real rig may start; give this on the command line only"
    )
    seed: int = quantity(1, "-", (0, 2**31), "seed of the rig, its noise and the models")
    folders: Folders = Folders()
    experiments: Experiments = Experiments()
    control: Control = Control()
    quality: Quality = Quality()
    models: Models = Models()
    evaluation: Evaluation = Evaluation()
    grids: Grids = Grids()
    tracking: Tracking = Tracking()
    calibration: Calibration = Calibration()
    ensemble: Ensemble = Ensemble()
    posterior: Posterior = Posterior()
    hardware: Hardware = Hardware()
    rig: Rig = Rig()
    fitted: Fitted = Fitted()

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
    def _only_recorded_logs_lack_a_reservoir(self) -> "Settings":
        if self.evaluation.reservoir == "simulated" and self.source != "recorded":
            raise ValueError(
                f"evaluation.reservoir = simulated is for recorded logs, and source is "
                f"{self.source}; set source: recorded, or remove evaluation.reservoir"
            )
        return self

    @model_validator(mode="after")
    def _logs_are_long_enough(self) -> "Settings":
        if self.source == "recorded":
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
