"""`fprc simulate`: one hysteresis experiment on the simulated rig, without Snakemake."""

from collections.abc import Sequence
from typing import Literal

from fprc.artifacts import refuse_output
from fprc.config import from_files, local_files
from fprc.escape import visible
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
    """Simulate an experiment and write its raw log.

    The simulated rig performs a hysteresis experiment of the paper, as in ``snakemake logs``.

    Parameters
    ----------
    experiment : str
        The paper trains on sweep and tests on complex.
    seed : int, optional
        Seed of the sensors and their noise; by default the configuration's, 1.
    rig : NAME
        Simulated rig; by default the configuration's.
    config : FILE
        Configuration, or a file that ``fprc calibrate`` wrote; later files override earlier ones.
        By default config/config.yaml if that file exists, else the defaults.
    out : FILE.h5
        Raw log to write.

    Examples
    --------
    fprc simulate sweep --out sweep.h5
    fprc simulate complex --seed 2 --rig viscous --out complex.h5

    Raises
    ------
    ConfigError
        The configuration, the seed or the rig is wrong.
    OutputError
        ``out`` exists, does not end in ``.h5``, or cannot be written.
    """
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
    print(visible(report))
