"""Digests of this package's files: the workflow runs a rule again when its code has changed.

Snakemake does not look into an installed package. Each rule therefore has a digest among its
params, of the files that compute or of those that show.
"""

import hashlib
from collections.abc import Iterable, Mapping
from inspect import getfile
from pathlib import Path
from typing import Any

import fprc
from fprc.registry import COMPETITORS, load_class

#: Files and folders that make tables, figures, claims and pages of results.
SHOWS = """claims config/published.yaml escape.py figures stages/draw.py
    stages/report.py stages/tabulate.py stages/*.j2 studies/beyond.py
    studies/online.py studies/pages.py studies/verdicts.py tables""".split()
#: Those of what no rule of the paper runs, or what only passes on files and settings.
ELSEWHERE = """__init__.py __main__.py apparatus cli.py commands config datasets.py errors.py
    fingerprint.py given.py plan.py recordings studies""".split()


def code_that_computes(
    *models: str, settings: Mapping[str, Any] | None = None, also: tuple[str, ...] = ()
) -> str:
    """Return a digest of the code that computes, with these models and not with others.

    Of a model from outside, which ``settings``, the section ``models``, names, the file of its
    class counts. ``also`` are further files and folders, as ``studies``.
    """
    shared = {*_folder().rglob("*.py")} - _files(SHOWS) - (_files(ELSEWHERE) - _files(also))
    shared -= {_file_of(name) for name in COMPETITORS}
    own = {_file_of(name, settings) for name in models}
    return _digest([*sorted(shared), *sorted(own)])


def code_that_shows() -> str:
    """Return a digest of the code and the other files of what is shown."""
    return _digest(sorted(_files(SHOWS)))


def _folder() -> Path:
    return Path(fprc.__path__[0])


def _files(names: Iterable[str]) -> set[Path]:
    tops = [top for name in names for top in _folder().glob(name)]
    found = (path for top in tops for path in (top, *top.rglob("*")))
    return {path for path in found if path.is_file() and path.suffix != ".pyc"}


def _file_of(name: str, settings: Mapping[str, Any] | None = None) -> Path:
    if name not in COMPETITORS:
        return Path(getfile(load_class(name, settings or {})))
    module, _, _ = COMPETITORS[name].cls.rpartition(".")
    return _folder().parent.joinpath(*module.split(".")).with_suffix(".py")


def _digest(files: Iterable[Path]) -> str:
    return hashlib.sha256(b"".join(path.read_bytes() for path in files)).hexdigest()[:16]
