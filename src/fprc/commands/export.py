"""`fprc export`: a fitted model as code for a controller."""

from pathlib import Path

from fprc import __version__
from fprc.artifacts import write_text
from fprc.errors import FprcError
from fprc.models.c_header import GENERATED, c_header
from fprc.models.storage import load_model
from fprc.provenance import sha256


def export_c(model: str, header: str, *, single: bool = False) -> None:
    """Write a saved model as a C header.

    Parameters
    ----------
    model : str
        File that ``save_model`` or the workflow wrote.
    header : str
        File to write. Its name without ``.h`` begins every name in it.
    single : bool, default=False
        Compute with float instead of double.

    Raises
    ------
    FprcError
        ``model`` holds no model that can be exported, or ``header`` does not end in ``.h`` or is a
        file that this command did not write.
    """
    path = Path(header)
    if path.suffix != ".h":
        raise FprcError(f"{header}: must end in .h, for example fprc_model.h")
    if path.exists() and GENERATED not in path.read_text(encoding="utf-8", errors="replace"):
        raise FprcError(f"{header}: exists and is no exported model; choose another name")
    fitted = load_model(model)
    origin = f"From {Path(model).name}, SHA-256 {sha256(model)}, by fprc {__version__}."
    try:
        text = c_header(fitted, path.stem, single=single, origin=origin)
    except FprcError as error:
        raise FprcError(f"{model}: {error}") from error
    write_text(path, text)
