"""Speed beside other libraries, of the whole workflow, and at scale."""

import os
from collections.abc import Mapping
from pathlib import Path

#: Variables that select kernels of OpenBLAS other than the processor's own.
KERNELS = ("OPENBLAS_CORETYPE", "OPENBLAS_L2_SIZE")


def refuse_other_kernels() -> None:
    """End the program if BLAS would not run the processor's own kernels."""
    if chosen := [name for name in KERNELS if name in os.environ]:
        raise SystemExit(f"{', '.join(chosen)} would slow BLAS down; unset it, as `make` does")


def load() -> str:
    """Return how busy the machine is; the caller keeps one core busy itself."""
    now = os.getloadavg()[0]
    busy = ": others used the machine, so compare ratios, not times" if now > 1.5 else ""
    return f"load average {now:.1f}{busy}"


def show(blocks: Mapping[str, str], page: Path | None) -> None:
    """Print what was measured, and write it to the blocks of a page if there is one."""
    from fprc.artifacts import write_text
    from fprc.studies.blocks import replace_block

    print(*blocks.values(), sep="\n\n")
    if page:
        text = page.read_text(encoding="utf-8")
        for name, block in blocks.items():
            text = replace_block(text, name, block, str(page))
        write_text(page, text)
