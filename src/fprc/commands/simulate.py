"""`fprc simulate`: one hysteresis experiment on the simulated rig, without Snakemake."""

from collections.abc import Sequence
from typing import Literal

from fprc.artifacts import refuse_output
from fprc.config import from_files, local_files
from fprc.config.settings import Control
from fprc.plan.arguments import of_pressures
from fprc.stages.record import record


def simulate(
    experiment: Literal["sweep", "complex"],
    *,
    seed: int | None = None,
    rig: str | None = None,
    config: Sequence[str] = (),
    out: str,
) -> None:
    """Simulate an experiment and write its raw log."""
    refuse_output(out, ".h5")
    chosen = {name: value for name, value in (("seed", seed), ("rig", rig)) if value is not None}
    settings = from_files(config or local_files(), chosen)
    whole, signal = settings.model_dump(mode="json"), dict(settings.experiments)[experiment]
    record(
        out,
        experiment=experiment,
        signal=signal,
        control=Control(**of_pressures(whole)),
        rig=whole["rig"],
        seed=settings.seed,
    )
    print(
        f"{out}: {experiment}, {signal.duration_s:g} s at {settings.control.sample_rate_hz:g} Hz, "
        f"on the simulated rig {settings.fitted.name}, seed {settings.seed}"
    )
