"""`fprc config`: check configuration files; print the package's own files."""

from collections.abc import Sequence

from fprc.config import PUBLISHED, from_files, reference
from fprc.config.load import RIG, rig_file
from fprc.given import read_given


def check_files(files: Sequence[str]) -> None:
    """Check configuration files, merged in this order.

    Raises
    ------
    ConfigError
        Lists every error.
    """
    from_files(files)
    print("no errors")


def print_page(page: str) -> None:
    """Print the configuration's defaults, schema or reference."""
    print(getattr(reference, page)(), end="")


def print_rig(name: str | None) -> None:
    """Print the file of a rig; without a name, that of the default rig."""
    print(read_given(rig_file(name or RIG)).decode(), end="")


def print_published() -> None:
    """Print the numbers of the paper."""
    print(PUBLISHED.read_text(encoding="utf-8"), end="")
