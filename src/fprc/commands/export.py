"""`fprc export`: a fitted model as code for a controller."""

from pathlib import Path

from fprc import __version__
from fprc.artifacts import refuse_output, write_text
from fprc.errors import FprcError
from fprc.given import read_given
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
        ``model`` holds no model that can be exported.
    OutputError
        ``c`` does not end in ``.h``, is a file that this command did not write, or cannot be
        written.
    """
    path = Path(c)
    refuse_output(path, ".h", ours=lambda old: GENERATED.encode() in read_given(old))
    fitted = load_model(model)
    origin = f"From {Path(model).name}, SHA-256 {sha256(model)}, by fprc {__version__}."
    try:
        text = c_header(fitted, path.stem, single=float_, origin=origin)
    except FprcError as error:
        raise FprcError(f"{model}: {error}") from error
    write_text(path, text)
