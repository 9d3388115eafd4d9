"""`fprc export`: a fitted model as code for a controller."""

from pathlib import Path

from fprc import __version__
from fprc.artifacts import write_text
from fprc.errors import FprcError
from fprc.models.c_header import GENERATED, c_header
from fprc.models.storage import load_model
from fprc.provenance import sha256


def export_c(model: str, *, c: str, float_: bool = False) -> None:
    """Turn a trained model into C code for a controller.

    Writes an FPRC or Fuzzy-linear as one C99 header without memory allocation. docs/deploy.md
    shows its use.

    Parameters
    ----------
    model : MODEL.h5
        Model of ``fprc train`` or the workflow.
    c : NAME.h
        Header to write; every name in it begins with NAME.
    float_ : bool
        Compute with float instead of double.

    Examples
    --------
    fprc export model.h5 --c fprc_model.h
    fprc export results/models/sweep_fprc.h5 --c fprc_model.h --float

    Raises
    ------
    FprcError
        ``model`` holds no model that can be exported, or ``c`` does not end in ``.h`` or is a
        file that this command did not write.
    """
    path = Path(c)
    if path.suffix != ".h":
        raise FprcError(f"{c}: must end in .h, for example fprc_model.h")
    if path.exists() and GENERATED not in path.read_text(encoding="utf-8", errors="replace"):
        raise FprcError(f"{c}: exists and is not an exported model; choose another name")
    fitted = load_model(model)
    origin = f"From {Path(model).name}, SHA-256 {sha256(model)}, by fprc {__version__}."
    try:
        text = c_header(fitted, path.stem, single=float_, origin=origin)
    except FprcError as error:
        raise FprcError(f"{model}: {error}") from error
    write_text(path, text)
