"""All settings of the workflow; the defaults are the paper's."""

from pathlib import PurePath
from typing import Annotated, Literal

from pydantic import AfterValidator, Field, model_validator

from fprc.config.calibration import FIRST_SEED, Calibration, Fitted
from fprc.config.hardware import Hardware
from fprc.config.models import Evaluation, Grids, Models
from fprc.config.rig import Rig
from fprc.config.section import Rising, Section, quantity
from fprc.config.tracking import Sines, Tracking

#: A folder's name as Snakemake wants it: `./out/` is `out`.
Folder = Annotated[str, AfterValidator(lambda folder: str(PurePath(folder)))]


# fmt: off
class Folders(Section):
    """Where files go."""

    raw: Folder = Field("data/raw", description="raw logs")
    results: Folder = Field("results", description="everything generated")


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
    reservoir_limit_kpa: float = quantity(450, (100, 500),
        "largest pressure command to the reservoir", "paper, Sec. II-B")
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
    armed: bool = Field(False,
        description="whether the real rig may move; give this on the command line only")
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

    @model_validator(mode="after")
    def _further_seeds_are_fresh(self) -> "Settings":
        known = {self.seed, *self.fitted.seeds}
        seen = [s for s in self.evaluation.replicate_seeds if s in known or s >= FIRST_SEED]
        if seen:
            raise ValueError(
                f"evaluation.replicate_seeds: {', '.join(map(str, seen))} is also the main seed, "
                f"one of the rig's fit, or {FIRST_SEED} or more; choose seeds that no fit has seen"
            )
        return self

    @model_validator(mode="after")
    def _commands_are_within_the_limit(self) -> "Settings":
        limit = self.tracking.pressure_limit_kpa
        problems = []
        for name, signal in self.experiments:
            count = 1 if signal.form == "chirp" else len(signal.f_hz)
            low, high = (signal.offset_kpa + k * count * signal.amplitude_kpa for k in (-1, 1))
            if low < 0.0 or high > limit:
                problems.append(
                    f"experiments.{name} asks for {low:g} to {high:g} kPa; change offset_kpa or "
                    f"amplitude_kpa: 0 to {limit:g} kPa are allowed (tracking.pressure_limit_kpa)"
                )
        if problems:
            raise ValueError("\n  ".join(problems))
        return self
