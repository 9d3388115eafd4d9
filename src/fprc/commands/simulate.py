"""`fprc simulate`: one hysteresis experiment on the simulated rig, without Snakemake."""

from collections.abc import Sequence
from typing import Literal

from fprc.artifacts import refuse_output
from fprc.config import from_files, local_files
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
    settings = from_files(config or local_files(), chosen).model_dump(mode="json")
    signal, control = settings["experiments"][experiment], settings["control"]
    record(
        out,
        experiment=experiment,
        signal=signal,
        control=of_pressures(settings),
        rig=settings["rig"],
        seed=settings["seed"],
    )
    report = (
        f"{out}: {experiment}, {signal['duration_s']:g} s at {control['sample_rate_hz']:g} Hz, on "
        f"the simulated rig {settings['fitted']['name']}, seed {settings['seed']}"
    )
    print(report)
