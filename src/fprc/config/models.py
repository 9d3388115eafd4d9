"""Settings of the models, of their evaluation and of the grids, Sec. III."""

from math import inf
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field, field_validator

from fprc.config.section import Distinct, Grid, Section, quantity
from fprc.limits import MODEL
from fprc.registry import ANGLE, COMPETITORS


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


class Other(Section):
    """A model from outside this package; docs/extending.md shows one."""

    estimator: str = Field(
        pattern=r"^[A-Za-z_]\w*(\.[A-Za-z_]\w*)+$", description="its class, as module.Class"
    )
    inputs: tuple[str, ...] = Field((ANGLE,), description="its inputs, in the order of its columns")
    settings: dict[str, Annotated[Any, AfterValidator(_is_single)]] = Field(
        {}, description="parameters of its constructor"
    )

    @field_validator("inputs")
    @classmethod
    def _begin_with_the_angle(cls, inputs: tuple[str, ...]) -> tuple[str, ...]:
        if inputs not in ((ANGLE,), (ANGLE, "p_o_kpa")):
            raise ValueError(f"{list(inputs)}; must be [{ANGLE}] or [{ANGLE}, p_o_kpa]")
        return inputs


class Models(Section):
    """The three models; Fuzzy-linear shares n_c, sigma and the clustering with FPRC."""

    n_y: int = _parameter("n_y", "taps of theta_d", "paper, Sec. III-D", "samples")
    alpha: float = _parameter("alpha", "ridge parameter", "paper, Sec. III-D")
    esn: Esn = Esn()
    fprc: Fprc = Fprc()
    others: dict[Annotated[str, Field(pattern=r"^[a-z][a-z0-9]*(_[a-z0-9]+)*$")], Other] = Field(
        {},
        description="models from outside this package, by name; see docs/extending.md. The "
        "workflow, also a dry run, imports their modules and so runs their code",
    )

    @field_validator("others")
    @classmethod
    def _names_are_free(cls, others: dict[str, Other]) -> dict[str, Other]:
        taken = [name for name in others if name in (*COMPETITORS, "pd") or name.endswith("_pd")]
        if taken:
            raise ValueError(
                f"{', '.join(taken)}: is the name of a model of ours, or, as all that end in _pd, "
                "of a controller; choose another"
            )
        return others


# fmt: off
class Evaluation(Section):
    """How the models are evaluated, Sec. III-D."""

    folds: int = quantity(5, (2, 100), "folds of the cross-validation", "paper, Sec. III-D")
    split: Literal["shuffled", "blocked"] = Field(
        "shuffled", description="rows of a fold: random, as the printed spread implies, or "
        "contiguous, so that neighbours in time do not validate each other"
    )
    purge_s: float = quantity(2.0, (0, 60), "time left out of training on each side of a block")
    target: Literal["command", "measured"] = Field(
        "command", description="P_exp that the models learn: commanded or measured pressure"
    )
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
