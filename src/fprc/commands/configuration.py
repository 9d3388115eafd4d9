"""`fprc config`: check configuration files; print the package's files."""

from collections.abc import Sequence

from fprc.config import from_files
from fprc.config import reference as pages
from fprc.config.load import RIG, rig_file
from fprc.given import read_given


def check(files: Sequence[str]) -> None:
    """Check configuration files, merged in this order."""
    from_files(files)
    print("no errors")


def defaults() -> None:
    """Print config/config.yaml."""
    print(pages.defaults(), end="")


def reference() -> None:
    """Print docs/configuration.md."""
    print(pages.reference(), end="")


def rig(name: str | None = None) -> None:
    """Print the parameters of a fitted rig."""
    print(read_given(rig_file(name or RIG)).decode(errors="backslashreplace"), end="")
