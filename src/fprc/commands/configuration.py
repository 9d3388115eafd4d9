"""`fprc config`: check configuration files; print the package's files."""

from collections.abc import Sequence

from fprc.config import PUBLISHED, from_files
from fprc.config import reference as pages
from fprc.config.load import RIG, rig_file
from fprc.given import read_given


def check(files: Sequence[str]) -> None:
    """Check configuration files, merged in this order.

    Parameters
    ----------
    files : FILE
        Configuration, YAML.

    Examples
    --------
    fprc config check config/config.yaml mine.yaml

    Raises
    ------
    ConfigError
        Lists every error.
    """
    from_files(files)
    print("no errors")


def defaults() -> None:
    """Print config/config.yaml.

    Examples
    --------
    fprc config defaults
    """
    print(pages.defaults(), end="")


def reference() -> None:
    """Print docs/configuration.md.

    Examples
    --------
    fprc config reference
    """
    print(pages.reference(), end="")


def rig(name: str | None = None) -> None:
    """Print the parameters of a fitted rig.

    Parameters
    ----------
    name : NAME
        Name of the rig; by default that of the defaults.

    Examples
    --------
    fprc config rig viscous
    """
    print(read_given(rig_file(name or RIG)).decode(errors="backslashreplace"), end="")


def published() -> None:
    """Print the numbers of the paper, as YAML.

    Examples
    --------
    fprc config published
    """
    print(PUBLISHED.read_text(encoding="utf-8"), end="")
