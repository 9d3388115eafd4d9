"""`fprc export`: a fitted model as code for a controller."""

from pathlib import Path

from fprc import __version__
from fprc.artifacts import refuse_output, write_text
from fprc.given import read_given
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
        ``model`` holds no model that can be exported.
    OutputError
        ``header`` does not end in ``.h``, is a file that this command did not write, or cannot be
        written.
    """
    path = Path(header)
    refuse_output(path, ".h", ours=lambda old: GENERATED.encode() in read_given(old))
    fitted = load_model(model)
    origin = f"From {Path(model).name}, SHA-256 {sha256(model)}, by fprc {__version__}."
    write_text(path, c_header(fitted, path.stem, single=single, origin=origin))
