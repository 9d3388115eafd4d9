"""`fprc export`: a fitted model as code for a controller."""

from collections.abc import Sequence
from pathlib import Path

from fprc import __version__
from fprc.artifacts import refuse_output, write_text
from fprc.config import from_files, local_files
from fprc.errors import FprcError
from fprc.experiments.tracking import Track
from fprc.experiments.trained import refuse_other_data
from fprc.given import read_given
from fprc.models.c_header import GENERATED, c_header
from fprc.models.storage import load_model
from fprc.provenance import sha256
from fprc.registry import outside_classes


def export_c(model: str, *, c: str, learn: bool = False, config: Sequence[str] = ()) -> None:
    """Turn a trained model into C code for a controller.

    Writes an FPRC or Fuzzy-linear as one C99 header without memory allocation. docs/deploy.md
    shows its use.

    Parameters
    ----------
    model : MODEL.h5
        Model of ``fprc train`` or the workflow.
    c : NAME.h
        Header to write; every name in it begins with NAME.
    learn : bool
        Let the model learn on the controller, with the settings of ``control.feedforward``.
    config : FILE
        Configuration; later files override earlier ones. By default config/config.yaml if that
        file exists, else the defaults.

    Examples
    --------
    fprc export model.h5 --c fprc_model.h
    fprc export results/models/sweep_fprc.h5 --c fprc_model.h --learn

    Raises
    ------
    ConfigError
        The configuration is wrong.
    FprcError
        ``model`` holds no model that can be exported, or that can learn at the configured rate.
    OutputError
        ``c`` does not end in ``.h``, is a file that this command did not write, or cannot be
        written.
    """
    path = Path(c)
    refuse_output(path, ".h", ours=lambda old: GENERATED.encode() in read_given(old))
    settings = from_files(config or local_files()).model_dump(mode="json")
    fitted = load_model(model, outside_classes(settings["models"]))
    if learn:
        units = getattr(fitted, "units_", ())  # whatever they are, the header names them
        rate_hz = settings["control"]["sample_rate_hz"]
        refuse_other_data(fitted, f"{model}, the model", rate_hz, units)
    origin = f"From {Path(model).name}, SHA-256 {sha256(model)}, by fprc {__version__}."
    try:
        online = None
        if learn:
            parts = (settings[key] for key in ("tracking", "control", "rig", "seed"))
            online = Track(*parts).online(fitted)
        text = c_header(fitted, path.stem, origin=origin, online=online)
    except FprcError as error:
        raise FprcError(f"{model}: {error}") from error
    write_text(path, text)
