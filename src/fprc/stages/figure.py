"""Run a stage that draws, and write beside its figure where it comes from."""

from collections.abc import Callable, Mapping
from typing import Any

from fprc.artifacts import write_json
from fprc.provenance import describe
from fprc.stages.run import run_stage


def run_figure(stage: Callable[..., Mapping[str, Any]], job: Any) -> None:
    """Call ``stage`` as ``run_stage`` does, then write the output ``sidecar``.

    Parameters
    ----------
    stage : callable
        Returns the attributes of the data that it drew (``source``, ``seed``).
    """
    data = run_stage(stage, job)
    sidecar = job.output.sidecar
    pictures = [path for path in job.output if path != sidecar]
    described = describe(data, inputs=list(job.input), outputs=pictures, settings=job.config)
    write_json(sidecar, described)
