"""Settings of the closed-loop runs, Sec. IV."""

from typing import Literal, Self

from pydantic import Field, model_validator

from fprc.config.section import NotEmpty, Rising, Section, quantity


# fmt: off
class Sines(Section):
    """Signal that starts at its lowest value."""

    form: Literal["multisine", "chirp"] = Field("multisine",
        description="sum of equal sines, or linear frequency sweep")
    f_hz: NotEmpty[float] = quantity((0.2,), (0.001, 10), "frequencies, or ends of the sweep")

    @model_validator(mode="after")
    def _sweep_has_two_ends(self) -> Self:
        if self.form == "chirp" and len(self.f_hz) != 2:
            raise ValueError(f"a chirp needs two frequencies in f_hz, not {len(self.f_hz)}")
        return self


class Reference(Sines):
    """Reference of the bending angle, which starts at its lowest value."""

    amplitude_deg: float = quantity(27.5, (0, 40), "amplitude of each sine",
        "printed for sweep and complex")
    offset_deg: float = quantity(32.5, (0, 80), "mean", "printed for sweep and complex")
    duration_s: float = quantity(40, (1, 3600), "length", "printed for sweep and complex")
    settle_s: float = quantity(5, (0, 60), "time at the first value, not evaluated", "assumed")


class References(Section):
    """The references of Table IV, and that of the disturbance test."""

    sine_0p2: Reference = Reference()
    sine_0p5: Reference = Reference(f_hz=(0.5,))
    sweep: Reference = Reference(form="chirp", f_hz=(0.05, 0.95), duration_s=80)
    complex: Reference = Reference(
        f_hz=(0.12, 0.04, 0.31, 0.29, 0.25), amplitude_deg=6.5, offset_deg=40.5, duration_s=100
    )
    disturbance: Reference = Reference(f_hz=(0.3,))


class Pushes(Section):
    """Random forces on the reservoir in the disturbance test, Fig. 17."""

    quiet_s: float = quantity(12, (0, 600), "no push before this time", "the paper: a short period")
    every_s: float = quantity(1.2, (0.1, 60), "mean time between two pushes", "assumed")
    sigma_kpa: float = quantity(150, (0, 500), "standard deviation of a push", "assumed")


class Tracking(Section):
    """The closed-loop runs of Sec. IV."""

    references: References = References()
    pressure_limit_kpa: float = quantity(450, (100, 500),
        "largest pressure command to the actuator", "as for the reservoir")
    angle_range_deg: Rising = quantity((0, 65), (-10, 120),
        "references outside are refused", "paper: about 60 deg")
    pushes: Pushes = Pushes()
    # fmt: on

    def reference(self, name: str) -> Reference:
        """Return the reference of that name."""
        return dict(self.references)[name]

    @model_validator(mode="after")
    def _pushes_begin_within_the_evaluated_part(self) -> "Tracking":
        run = self.references.disturbance
        if not 0.0 < self.pushes.quiet_s - run.settle_s < run.duration_s:
            raise ValueError(
                f"pushes.quiet_s = {self.pushes.quiet_s:g}: must lie between settle_s and the end "
                "of references.disturbance"
            )
        return self
