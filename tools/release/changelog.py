"""Read CHANGELOG.md, and cut it: what is unreleased becomes a version with a date."""

import re
from datetime import date
from pathlib import Path

from packaging.version import InvalidVersion, Version

from fprc.artifacts import write_text
from fprc.errors import FprcError

PAGE = Path("CHANGELOG.md")
#: The only place of the version; packages, logs and results take it from here.
PLACE = Path("src/fprc/__init__.py")
UNRELEASED = "## Unreleased"
_VERSION = re.compile(r'^__version__ = "(.+)"$', re.MULTILINE)
_RELEASED = re.compile(r"^## (\S+) \((\d{4}-\d{2}-\d{2})\)$", re.MULTILINE)


def released(root: Path) -> dict[str, str]:
    """Return the date of each version in the changelog, newest first."""
    return dict(_RELEASED.findall((root / PAGE).read_text(encoding="utf-8")))


def version_of(root: Path) -> str:
    """Return the version of the package in a checkout."""
    (version,) = _VERSION.findall((root / PLACE).read_text(encoding="utf-8"))
    return str(version)


def cut(root: Path, version: str, today: date) -> None:
    """Give the unreleased changes a version and a date, and set the package's version.

    Raises
    ------
    FprcError
        The version is not one, is not newer than the last, or nothing is unreleased.
    """
    page = (root / PAGE).read_text(encoding="utf-8")
    if problems := [*_not_newer(version, released(root)), *_nothing_to_cut(page)]:
        raise FprcError("\n".join(problems))
    heading = f"{UNRELEASED}\n\n## {version} ({today.isoformat()})"
    code = (root / PLACE).read_text(encoding="utf-8")
    write_text(root / PLACE, _VERSION.sub(f'__version__ = "{version}"', code))
    write_text(root / PAGE, page.replace(UNRELEASED, heading, 1))


def _not_newer(version: str, before: dict[str, str]) -> list[str]:
    try:
        if str(Version(version)) != version:
            return [f"VERSION={version}: write {Version(version)}"]
    except InvalidVersion:
        return [f"VERSION={version}: not a version; give one such as VERSION=0.2.0"]
    last = max(map(Version, before), default=None)
    if last and Version(version) <= last:
        return [f"VERSION={version}: {PAGE} already has {last}; give a newer version"]
    return []


def _nothing_to_cut(page: str) -> list[str]:
    if len(re.findall(f"^{UNRELEASED}$", page, re.MULTILINE)) != 1:
        return [f"{PAGE}: needs one heading '{UNRELEASED}'"]
    changes = page.split(UNRELEASED)[1].split("\n## ")[0]
    return [] if changes.strip() else [f"{PAGE}: nothing below '{UNRELEASED}'; list the changes"]
