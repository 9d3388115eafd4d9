"""All settings of the workflow; the defaults are the paper's."""

from collections.abc import Iterator
from math import inf
from pathlib import PurePath
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field

from fprc.config.calibration import FIRST_SEED, Calibration, Fitted
from fprc.config.hardware import Hardware
from fprc.config.rig import Rig
from fprc.config.section import Distinct, Grid, NotEmpty, Rising, Section, quantity
from fprc.limits import MODEL
from fprc.registry import ANGLE, COMPETITORS

#: A folder's name as Snakemake wants it: `./out/` is `out`.
Folder = Annotated[str, AfterValidator(lambda folder: str(PurePath(folder)))]


# fmt: off
class Folders(Section):
    """Where files go."""

    raw: Folder = Field("data/raw", description="raw logs")
    results: Folder = Field("results", description="everything generated")


class Sines(Section):
    """Signal that starts at its lowest value."""

    form: Literal["multisine", "chirp"] = Field("multisine",
        description="sum of equal sines, or linear frequency sweep")
    f_hz: NotEmpty[float] = quantity((0.2,), (0.001, 10), "frequencies, or ends of the sweep")

    def _problems(self) -> Iterator[str]:
        if self.form == "chirp" and len(self.f_hz) != 2:
            yield f"a chirp needs two frequencies in f_hz, not {len(self.f_hz)}"


class Signal(Sines):
    """Pressure command of a hysteresis experiment, Fig. 4."""

    amplitude_kpa: float = quantity(35, (0, 225), "amplitude of each sine",
        "printed for complex; the sweep has its span")
    offset_kpa: float = quantity(175, (0, 450), "mean", "printed for complex; sweep alike")
    duration_s: float = quantity(80, (1, 3600), "length", "paper, Fig. 4")


class Experiments(Section):
    """The two hysteresis experiments, Sec. II-B: training data and test data."""

    sweep: Signal = Signal(form="chirp", f_hz=(0.1, 1.0), amplitude_kpa=175, duration_s=120)
    complex: Signal = Signal(f_hz=(0.12, 0.04, 0.31, 0.29, 0.25))


class PressureLoop(Section):
    """Software PI loop on a valve voltage."""

    # positive: more voltage fills the chamber
    kp_v_per_kpa: float = quantity(0.03, (1e-4, 1), "proportional gain", "paper, Sec. IV")
    ki_v_per_kpa_s: float = quantity(1e-6, (0, 1), "integral gain", "paper, Sec. IV")


class Gains(Section):
    """PD controller of the bending angle."""

    kp_kpa_per_deg: float = quantity(0.5, (1e-3, 50), "P gain", "paper, Sec. IV")
    kd_kpa_s_per_deg: float = quantity(0.005, (0, 5), "D gain", "paper, Sec. IV")


class Feedforward(Section):
    """What a model does beside computing P_ff; see docs/drift.md."""

    adapt: bool = Field(False, description="whether it learns from the tracking error as it runs")
    p_o_shift_kpa: float = quantity(0.0, (-50, 50),
        "added to P_o, to re-zero it: P_o at rest before the training, minus P_o at rest now")
    prior_s: float = quantity(15, (0.1, 3600), "new data that weigh as much as the training")
    memory_s: float = quantity(60, (1, 36000), "time constant of the return of that weight")
    delay_s: float = quantity(0.02, (0, 1), "time from a command to the angle it causes")
    # with the shortest prior_s and the highest limit_kpa, 50 no longer settles on the rigs
    kpa_per_deg: float = quantity(2.0, (0, 20), "correction for a degree of error")
    limit_kpa: float = quantity(150, (0, 500), "most that learning adds to P_ff or takes")
    stop_deg: float = quantity(0.5, (0, 20), "angle up to which, at the stop, nothing is learned")


class Control(Section):
    """Controllers that run on the computer at every sample."""

    sample_rate_hz: float = quantity(200, (50, 1000), "refresh rate", "paper, Sec. II-B")
    k_in_kpa_per_deg: float = quantity(7.0, (0.1, 20), "K_in of the reservoir", "paper, Sec. II-B")
    reservoir_limit_kpa: float = quantity(450, (100, 500), "largest command", "paper, Sec. II-B")
    main_loop: PressureLoop = PressureLoop()
    reservoir_loop: PressureLoop = PressureLoop(kp_v_per_kpa=0.05)
    feedback: Literal["incremental", "positional"] = Field("incremental",
        description="law of the PD controller; incremental: P_fb is the running sum of "
        "kp e + kd de/dt, as in the code of the authors' next paper (docs/results.md)")
    pd: Gains = Gains()
    feedforward: Feedforward = Feedforward()


class Quality(Section):
    """Checks of a raw log in preprocessing."""

    rate_tolerance: float = quantity(0.01, (0, 0.2), "relative error of the mean sample rate")
    gap_periods: float = quantity(1.5, (1.01, 100), "a longer step is a gap", unit="periods")
    stuck_s: float = quantity(2.0, (0.05, 60), "a channel is stuck if unchanged for longer")
    pressure_range_kpa: Rising = quantity((-20, 995), (-100, 1000), "plausible commands, readings")
    angle_range_deg: Rising = quantity((-45, 120), (-360, 360), "plausible theta and theta_d")
    leak_kpa_per_min: float = quantity(5.0, (0, 100), "fall of P_o at equal P_i that is no leak")


def _parameter(name: str, meaning: str, source: str = "paper, Table I", unit: str = "") -> Any:
    """Declare a parameter of the models; its default and its limits are the models' own."""
    return quantity(MODEL[name].default, MODEL[name], meaning, source, unit)


class Esn(Section):
    """Echo state network, Sec. III-A and Table I."""

    r: int = _parameter("r", "nodes of the reservoir")
    f_input: float = _parameter("f_input", "input scaling factor")
    gamma: float = _parameter("gamma", "leaky rate")
    rho: float = _parameter("rho", "spectral radius")
    washout: int = _parameter("washout", "steps for x to settle", "paper, Sec. III-D", "samples")


class Fprc(Section):
    """Fuzzy pneumatic reservoir computing, Sec. III-B and Table I."""

    epsilon: float = _parameter("epsilon", "filter factor")
    n_c: int = _parameter("n_c", "number of fuzzy rules")
    n_u: int = _parameter("n_u", "taps of the readout P_o", unit="samples")
    sigma: float = _parameter("sigma", "Gaussian membership scaling")
    restarts: int = _parameter("restarts", "starts of the clustering; the best is kept", "")


def _is_single(value: Any) -> Any:
    if not isinstance(value, bool | int | float | str) or value in (inf, -inf) or value != value:
        raise ValueError(f"{value} must be a finite number, a text, true or false")
    return value


def _are_known(inputs: tuple[str, ...]) -> tuple[str, ...]:
    if inputs not in ((ANGLE,), (ANGLE, "p_o_kpa")):
        raise ValueError(f"{list(inputs)} must be [{ANGLE}] or [{ANGLE}, p_o_kpa]")
    return inputs


class Other(Section):
    """A model from outside this package; docs/extending.md shows one."""

    estimator: str = Field(pattern=r"^[A-Za-z_]\w*(\.[A-Za-z_]\w*)+$", description="module.Class")
    inputs: Annotated[tuple[str, ...], AfterValidator(_are_known)] = Field((ANGLE,),
        description="its inputs, in the order of its columns")
    settings: dict[str, Annotated[Any, AfterValidator(_is_single)]] = Field({},
        description="parameters of its constructor")


class Models(Section):
    """The three models; Fuzzy-linear shares n_c, sigma and the clustering with FPRC."""

    n_y: int = _parameter("n_y", "taps of theta_d", "paper, Sec. III-D", "samples")
    alpha: float = _parameter("alpha", "ridge parameter", "paper, Sec. III-D")
    esn: Esn = Esn()
    fprc: Fprc = Fprc()
    others: dict[Annotated[str, Field(pattern=r"^[a-z][a-z0-9]*(_[a-z0-9]+)*$")], Other] = Field({},
        description="models from outside this package, by name; see docs/extending.md. The "
        "workflow, also a dry run, imports their modules and so runs their code")

    def _problems(self) -> Iterator[str]:
        for name in self.others:
            if name in (*COMPETITORS, "pd") or name.endswith("_pd"):
                yield f"others.{name} is the name of a model or of a controller; choose another"


class Evaluation(Section):
    """How the models are evaluated, Sec. III-D."""

    folds: int = quantity(5, (2, 100), "folds of the cross-validation", "paper, Sec. III-D")
    split: Literal["shuffled", "blocked"] = Field("shuffled",
        description="rows of a fold: random, as the printed spread implies, or contiguous, so that "
        "neighbours in time do not validate each other")
    purge_s: float = quantity(2.0, (0, 60), "time left out of training on each side of a block")
    target: Literal["command", "measured"] = Field("command",
        description="P_exp that the models learn: commanded or measured pressure")
    timing_repeats: int = quantity(10, (1, 100), "repeats of the timing", "paper, Sec. III-D")
    replicate_seeds: Distinct[int] = quantity(tuple(range(1201, 1211)), (0, 2**31),
        "seeds of further rigs, on which tables, grids and runs are repeated")


class Grids(Section):
    """Grids of control variables, Sec. III-E: the claims ask for values between others."""

    epsilon: Grid[float] = quantity((1.0, 0.1, 0.01, 1e-3, 1e-4), MODEL["epsilon"],
        "filter factors", "paper, Fig. 10(a)")
    n_c: Grid[int] = quantity((1, 2, 4, 8, 16), MODEL["n_c"], "fuzzy rules", "paper, Fig. 10(b)")
    n_u: Grid[int] = quantity(tuple(range(1, 11)), MODEL["n_u"], "taps of P_o",
        "paper, Fig. 11", unit="samples")
    n_y: Grid[int] = quantity(tuple(range(1, 11)), MODEL["n_y"], "taps of theta_d",
        "paper, Fig. 11", unit="samples")


class Reference(Sines):
    """Reference of the bending angle, which starts at its lowest value."""

    amplitude_deg: float = quantity(27.5, (0, 40), "of each sine", "printed for sweep and complex")
    offset_deg: float = quantity(32.5, (0, 80), "mean", "printed for sweep and complex")
    duration_s: float = quantity(40, (1, 3600), "length", "printed for sweep and complex")
    settle_s: float = quantity(5, (0, 60), "time at the first value, not evaluated", "assumed")


class References(Section):
    """The references of Table IV, and that of the disturbance test."""

    sine_0p2: Reference = Reference()
    sine_0p5: Reference = Reference(f_hz=(0.5,))
    sweep: Reference = Reference(form="chirp", f_hz=(0.05, 0.95), duration_s=80)
    complex: Reference = Reference(f_hz=(0.12, 0.04, 0.31, 0.29, 0.25),
        amplitude_deg=6.5, offset_deg=40.5, duration_s=100)
    disturbance: Reference = Reference(f_hz=(0.3,))


class Pushes(Section):
    """Random forces on the reservoir in the disturbance test, Fig. 17."""

    quiet_s: float = quantity(12, (0, 600), "no push before this time", "the paper: a short period")
    every_s: float = quantity(1.2, (0.1, 60), "mean time between two pushes", "assumed")
    sigma_kpa: float = quantity(150, (0, 500), "standard deviation of a push", "assumed")


class Tracking(Section):
    """The closed-loop runs of Sec. IV."""

    references: References = References()
    pressure_limit_kpa: float = quantity(450, (100, 500), "largest command", "as for the reservoir")
    angle_range_deg: Rising = quantity((0, 65), (-10, 120), "of references", "paper: about 60 deg")
    pushes: Pushes = Pushes()

    def reference(self, name: str) -> Reference:
        """Return the reference of that name."""
        return dict(self.references)[name]

    def _problems(self) -> Iterator[str]:
        run, quiet_s = self.references.disturbance, self.pushes.quiet_s
        if not 0.0 < quiet_s - run.settle_s < run.duration_s:
            yield (
                f"pushes.quiet_s = {quiet_s:g}: must lie between settle_s and the end of "
                "references.disturbance"
            )


class Beyond(Section):
    """Competitors of the paper's models on several families of rigs, and other studies of these."""

    first_seed: int = quantity(601, (0, 2**31 - 2**20), "first seed; no fit saw it or later ones")
    units: int = quantity(15, (1, 10000), "seeds of a family of one rig, rigs of a family of many")
    slow: int = quantity(4, (1, 10000), "units that also judge the slow ESN, trees and MLP")
    restarts: int = quantity(10, (1, 1000), "starts of a clustering; the lowest objective is kept")


class Settings(Section):
    """The whole configuration."""

    source: Literal["sim", "rig", "recorded"] = Field("sim",
        description="where raw logs come from: the simulated rig, the real one, or existing files")
    armed: bool = Field(False, description="may the real rig move? only for the command line")
    seed: int = quantity(1, (0, 2**31), "seed of the rig, its noise and the models")
    folders: Folders = Folders()
    experiments: Experiments = Experiments()
    control: Control = Control()
    quality: Quality = Quality()
    models: Models = Models()
    evaluation: Evaluation = Evaluation()
    grids: Grids = Grids()
    tracking: Tracking = Tracking()
    calibration: Calibration = Calibration()
    beyond: Beyond = Beyond()
    hardware: Hardware = Hardware()
    rig: Rig = Rig()
    fitted: Fitted = Fitted()
    # fmt: on

    def _problems(self) -> Iterator[str]:
        known = {self.seed, *self.fitted.seeds}
        seen = [s for s in self.evaluation.replicate_seeds if s in known or s >= FIRST_SEED]
        if seen:
            yield (
                f"evaluation.replicate_seeds: {', '.join(map(str, seen))} is also the main seed, "
                f"one of the rig's fit, or {FIRST_SEED} or more; choose seeds that no fit has seen"
            )
        limit = self.tracking.pressure_limit_kpa
        for name, signal in self.experiments:
            count = 1 if signal.form == "chirp" else len(signal.f_hz)
            low, high = (signal.offset_kpa + k * count * signal.amplitude_kpa for k in (-1, 1))
            if low < 0.0 or high > limit:
                yield (
                    f"experiments.{name} asks for {low:g} to {high:g} kPa; change offset_kpa or "
                    f"amplitude_kpa: 0 to {limit:g} kPa are allowed (tracking.pressure_limit_kpa)"
                )
