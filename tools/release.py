"""Build a release into dist/: `make release`, as CONTRIBUTING.md describes. Nothing is uploaded.

The results are made in a new clone of the commit, so that all of them are of this commit and of the
same libraries.
"""

import argparse
import os
import re
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Sequence
from pathlib import Path

from fprc.errors import FprcError
from tools import twice

CHANGELOG = Path("CHANGELOG.md")
#: The only place of the version; packages, logs and results take it from here.
VERSION = Path("src/fprc/__init__.py")
#: Leaves out what the jobs of the workflow printed.
NO_LOGS = ":(exclude,glob)results/**/logs/**"

BY_HAND = """
{folder} is ready; nothing was uploaded. What remains to be done by hand:

1. git tag -a v{version} {commit} -m "fprc {version}"
   git push origin v{version}
2. {tools} -m twine upload {folder}/*.whl {folder}/*.tar.gz
3. Upload {folder}/{archive} to https://zenodo.org/uploads/new (type: Dataset,
   version {version}, license MIT), publish it, and add its DOI to CITATION.cff.
"""


def version_of(root: Path) -> str:
    """Return the version of the package in a checkout."""
    code = (root / VERSION).read_text(encoding="utf-8")
    (version,) = re.findall(r'^__version__ = "(.+)"$', code, re.MULTILINE)
    return str(version)


def build(root: Path, tools: str, cores: str, configfiles: Sequence[str] = ()) -> None:
    """Build results, wheel, sdist and archive into ``dist/VERSION``: all of them or none.

    Parameters
    ----------
    root : Path
        The checkout.
    tools : str
        Python that has the dependency group ``release``.
    cores : str
        Cores for the workflow.
    configfiles : sequence of str
        Those of the results, after config/config.yaml.

    Raises
    ------
    FprcError
        Lists what forbids the release.
    CalledProcessError
        The workflow or a tool failed.
    """
    version = version_of(root)
    target = root / "dist" / version
    page = (root / CHANGELOG).read_text(encoding="utf-8")
    heading = re.search(rf"^## {re.escape(version)} \(\d{{4}}-\d\d-\d\d\)$", page, re.MULTILINE)
    wrong = {
        "uncommitted changes; commit them, then build again": bool(
            _git(root, "status", "--porcelain")
        ),
        f"{CHANGELOG}: no heading `## {version} (DATE)`; put it above the changes of this version, "
        "and commit": not heading,
        f"the tag v{version} exists: this version is released; give a newer one": bool(
            _git(root, "tag", "--list", f"v{version}")
        ),
        f"{target}: exists; move it away": target.exists(),
    }
    problems = [problem for problem, holds in wrong.items() if holds]
    if problems:
        raise FprcError("\n".join(["no release:", *problems]))
    archive = f"fprc-{version}.zip"
    target.parent.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory(dir=target.parent, prefix=".") as scratch:
        clone, folder = Path(scratch, "clone"), Path(scratch, version)
        folder.mkdir()
        _run("git", "clone", "--quiet", str(root), str(clone))
        commit = _git(clone, "rev-parse", "HEAD").strip()
        chosen = ["--configfile", *configfiles] if configfiles else []
        twice.build(clone, (cores, {}), *chosen)
        pack(clone, folder / archive)
        build_packages(clone, folder, tools)
        folder.rename(target)
    shown = target.relative_to(root)
    by_hand = {"folder": shown, "version": version, "commit": commit, "archive": archive}
    print(BY_HAND.format(**by_hand, tools=tools))


def pack(clone: Path, archive: Path) -> None:
    """Write the files of the commit, the raw logs, and the results with their digests into a ZIP.

    Parameters
    ----------
    clone : Path
        A checkout in which the workflow has run, and nothing else.
    """
    made = _git(clone, "ls-files", "-z", "--others", "--", "results", "data/raw", NO_LOGS)
    names = _git(clone, "ls-files", "-z") + made
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as packed:
        for name in sorted(names.split("\0")[:-1]):
            if (clone / name).is_file():  # no link to a folder
                packed.write(clone / name, name)


def build_packages(clone: Path, folder: Path, tools: str) -> None:
    """Build sdist and wheel, and check their metadata; `make test` installs and uses a wheel."""
    dated = {"SOURCE_DATE_EPOCH": _git(clone, "log", "-1", "--format=%ct").strip()}
    _run(tools, "-m", "build", "--outdir", str(folder), str(clone), **dated)
    (wheel,), (sdist,) = folder.glob("*.whl"), folder.glob("*.tar.gz")
    _run(tools, "-m", "twine", "check", "--strict", str(wheel), str(sdist))


def _run(*command: str, **environment: str) -> None:
    """Run a program without the package of this checkout."""
    without = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    subprocess.run(command, check=True, env=without | environment)


def _git(folder: Path, *arguments: str) -> str:
    return subprocess.check_output(["git", "-C", str(folder), *arguments], text=True)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; 1 if a release is refused or fails."""
    parser = argparse.ArgumentParser(prog="release", description=__doc__.splitlines()[0])
    parser.add_argument("--tools", default=sys.executable, help="Python with the release tools")
    parser.add_argument("--cores", default="2", help="cores for the workflow")
    parser.add_argument("--configfile", nargs="*", default=[], help="of the results")
    options = parser.parse_args(arguments)
    try:
        build(Path.cwd(), options.tools, options.cores, options.configfile)
    except (FprcError, OSError, subprocess.CalledProcessError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
