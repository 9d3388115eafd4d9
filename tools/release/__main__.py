"""Build a release into dist/: `make release`. Nothing is uploaded."""

import argparse
import os
import re
import subprocess
import sys
import tempfile
import venv
from collections.abc import Sequence
from pathlib import Path

from fprc.errors import FprcError
from fprc.provenance import checkout
from tools.release.crate import describe_crate
from tools.release.results import built, problems_of, sidecars_of

PROFILE = "workflow-run-crate-0.5"
CHANGELOG = Path("CHANGELOG.md")
#: The only place of the version; packages, logs and results take it from here.
VERSION = Path("src/fprc/__init__.py")

BY_HAND = """
{folder} is ready; nothing was uploaded. What remains to be done by hand:

1. git tag -a v{version} {commit} -m "fprc {version}"
   git push origin v{version}
2. {tools} -m twine upload {folder}/*.whl {folder}/*.tar.gz
3. Upload {folder}/{crate} to https://zenodo.org/uploads/new (type: Dataset,
   version {version}, license MIT), publish it, and add its DOI to CITATION.cff.
"""


def released(root: Path) -> dict[str, str]:
    """Return the date of each version in the changelog, newest first."""
    page = (root / CHANGELOG).read_text(encoding="utf-8")
    return dict(re.findall(r"^## (\S+) \((\d{4}-\d{2}-\d{2})\)$", page, re.MULTILINE))


def version_of(root: Path) -> str:
    """Return the version of the package in a checkout."""
    code = (root / VERSION).read_text(encoding="utf-8")
    (version,) = re.findall(r'^__version__ = "(.+)"$', code, re.MULTILINE)
    return str(version)


def build(root: Path, tools: str, configfiles: Sequence[str] = ()) -> None:
    """Build wheel, sdist and archive into ``dist/VERSION``: all of them or none.

    Parameters
    ----------
    root : Path
        The checkout.
    tools : str
        Python that has the dependency group ``release``.
    configfiles : sequence of str
        Those of the build, after config/config.yaml.

    Raises
    ------
    FprcError
        Lists what forbids the release, or quotes a tool that failed.
    """
    version = version_of(root)
    target = root / "dist" / version
    made, unfinished = built(root, configfiles)
    sidecars = sidecars_of(root, made)
    commit, dirty = checkout(root / "src/fprc")
    if commit is None:
        raise FprcError(f"{root}: not a git checkout; clone the repository")
    problems = [
        *_of_version(root, version, target),
        *(["uncommitted changes; commit them, then build again"] if dirty else []),
        *problems_of(root, unfinished, sidecars, commit),
    ]
    if problems:
        raise FprcError("\n".join(["no release:", *problems]))
    crate = f"fprc-{version}.crate.zip"
    target.parent.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory(dir=target.parent, prefix=".") as scratch:
        folder = Path(scratch) / version
        folder.mkdir()
        tracked = _output_of("git", "-C", str(root), "ls-files", "-z").split("\0")[:-1]
        code = [name for name in tracked if (root / name).is_file()]  # no link to a folder
        described = describe_crate(
            root,
            code=code,
            made=made,
            sidecars=sidecars,
            version=version,
            published=released(root)[version],
        )
        described.write_zip(folder / crate)
        validate(folder / crate, tools)
        build_packages(root, folder, tools)
        folder.rename(target)
    shown = target.relative_to(root)
    print(BY_HAND.format(folder=shown, version=version, commit=commit, tools=tools, crate=crate))


def _of_version(root: Path, version: str, target: Path) -> list[str]:
    problems = []
    newest = next(iter(released(root)), None)
    if newest != version:
        problems.append(
            f"{CHANGELOG}: its newest release is {newest}, the package is {version}; "
            "give the unreleased changes the version and a date, and commit"
        )
    if _output_of("git", "-C", str(root), "tag", "--list", f"v{version}").strip():
        problems.append(f"the tag v{version} exists: this version is released; give a newer one")
    if target.exists():
        problems.append(f"{target}: exists; move it away")
    return problems


def validate(crate: Path, tools: str) -> None:
    """Validate a crate with its profile; the validator reads the JSON-LD context from the web."""
    checked = ["validate", "--profile-identifier", PROFILE, "--verbose", "--no-paging", str(crate)]
    _output_of(str(Path(tools).with_name("rocrate-validator")), "--no-interactive", *checked)


def build_packages(root: Path, folder: Path, tools: str) -> None:
    """Build sdist and wheel, check their metadata, and install the wheel in a new environment."""
    committed = _output_of("git", "-C", str(root), "log", "-1", "--format=%ct").strip()
    dated = {"SOURCE_DATE_EPOCH": committed}
    _output_of(tools, "-m", "build", "--outdir", str(folder), str(root), **dated)
    (wheel,), (sdist,) = folder.glob("*.whl"), folder.glob("*.tar.gz")
    _output_of(tools, "-m", "twine", "check", "--strict", str(wheel), str(sdist))
    with tempfile.TemporaryDirectory() as scratch:
        venv.create(scratch, with_pip=True)
        python = str(Path(scratch) / "bin/python")
        _output_of(python, "-m", "pip", "install", "--quiet", str(wheel))
        _output_of(python, "-m", "pip", "check")
        _output_of(str(Path(scratch) / "bin/fprc"), "--version")


def _output_of(*command: str, **environment: str) -> str:
    """Run a program and return what it printed.

    Raises
    ------
    FprcError
        It is not installed, or ended with an error.
    """
    without = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, check=False, env=without | environment
        )
    except FileNotFoundError:
        raise FprcError(f"{command[0]}: not found; `make release` installs the tools") from None
    if done.returncode:
        raise FprcError(f"{' '.join(command)} failed:\n{done.stdout}{done.stderr}".rstrip())
    return done.stdout


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; 1 if a release is refused."""
    parser = argparse.ArgumentParser(prog="release", description=__doc__)
    parser.add_argument("--tools", default=sys.executable, help="Python with the release tools")
    parser.add_argument("--configfile", nargs="*", default=[], help="of the results' build")
    options = parser.parse_args(arguments)
    try:
        build(Path.cwd(), options.tools, options.configfile)
    except FprcError as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
