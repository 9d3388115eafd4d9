"""Copy a figure that shows no data."""

import shutil
from collections.abc import Sequence

from fprc.artifacts import replacing_all


def copy_drawing(drawing: Sequence[str], pdf: str, png: str) -> None:
    """Figures 1, 2, 3, 6 and 7: copy a drawing's PDF and PNG, in this order."""
    with replacing_all(pdf, png) as copies:
        for file, copy in zip(drawing, copies, strict=True):
            shutil.copyfile(file, copy)
