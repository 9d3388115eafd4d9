"""`fprc export`: a fitted model as code for a controller."""

from collections.abc import Sequence
from pathlib import Path

from fprc import __version__
from fprc.artifacts import refuse_output, write_text
from fprc.config import from_files, local_files
from fprc.errors import FprcError
from fprc.experiments.tracking import Track
from fprc.experiments.trained import refuse_other_data
from fprc.models.c_header import c_header
from fprc.models.storage import load_model
from fprc.provenance import sha256
from fprc.registry import outside_classes


def export_c(model: str, *, c: str, learn: bool = False, config: Sequence[str] = ()) -> None:
    """Turn a trained model into C code for a controller."""
    path = Path(c)
    refuse_output(path, ".h")
    settings = from_files(config or local_files())
    fitted = load_model(model, outside_classes(settings.models.model_dump()))
    if learn:
        units = getattr(fitted, "units_", ())  # whatever they are, the header names them
        rate_hz = settings.control.sample_rate_hz
        refuse_other_data(fitted, f"{model}, the model", rate_hz, units)
    origin = f"From {Path(model).name}, SHA-256 {sha256(model)}, by fprc {__version__}."
    try:
        online = None
        if learn:
            bench = Track(settings.tracking, settings.control, {}, settings.seed)
            online = bench.online(fitted)
        text = c_header(fitted, path.stem, origin=origin, online=online)
    except FprcError as error:
        raise FprcError(f"{model}: {error}") from error
    write_text(path, text)
