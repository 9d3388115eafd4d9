"""Documentation site, from the Markdown of this folder and the docstrings of the package."""

import html
import os
import re
from importlib.metadata import version as version_of

from fprc.escape import typeset
from fprc.figures import DRAWINGS

project = "fprc"
copyright = "The fprc developers; MIT licence"  # noqa: A001 (Sphinx names it)
version = release = version_of("fprc")

extensions = [
    "myst_parser",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx_gallery.gen_gallery",
]
exclude_patterns = ["_build", "examples/README.rst", "images"]
html_theme = "furo"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_title = f"fprc {version}"

myst_enable_extensions = ["html_image"]
myst_heading_anchors = 3
suppress_warnings = ["config.cache"]  # sphinx-gallery's settings hold functions

autodoc_typehints = "none"  # numpydoc's sections name the types
numpydoc_show_class_members = False
templates_path = ["templates"]
autosummary_generate = True

sphinx_gallery_conf = {
    "examples_dirs": "examples",
    "gallery_dirs": "gallery",
    "capture_repr": (),
    "filename_pattern": r"\.py$",
    "within_subsection_order": "FileNameSortKey",
    "write_computation_times": False,
    "show_memory": False,
    "download_all_examples": False,
    # of an example that draws nothing
    "default_thumb_file": str(DRAWINGS / "fig07_fprc_system.png"),
}


def setup(app):
    """Show our own members only, and symbols and formulas typeset."""
    app.connect("autodoc-skip-member", _is_not_ours)
    app.connect("autodoc-process-docstring", _set_formulas_apart, priority=400)  # before numpydoc
    app.connect("source-read", _link_and_typeset)


def _is_not_ours(app, what, name, member, skip, options):
    return skip or not str(getattr(member, "__module__", "fprc")).startswith("fprc")


#: A line of a formula, or its continuation: ``P_ff(k) = w_out [1, x(k)]   (4)``.
_FORMULA = re.compile(r"(\S+( \S+)? = | +\S).*[^.:]$")


def _set_formulas_apart(app, what, name, obj, options, lines):
    first, *others = "\n".join(lines).strip().split("\n\n")
    for number, paragraph in enumerate(others):
        if not paragraph.startswith(" ") and all(map(_FORMULA.match, paragraph.splitlines())):
            typeset_lines = "".join(map(_formula, paragraph.splitlines()))
            others[number] = f".. raw:: html\n\n    <div>{typeset_lines}</div>"
    lines[:] = "\n\n".join([first, *others]).splitlines() + [""]


_GREEK = {"theta": "θ", "gamma": "γ", "epsilon": "ε", "beta_bar": "β\u0304"}


def _formula(line):
    """Return a line of a formula in HTML: symbols in italics, indices low, its number right."""
    text, _, remark = re.match(r"(.*?)(   +\((.*)\))?$", line).groups()
    for mark, typeset_mark in {"``": "", "~": "\u0303", "-": "\u2212", "...": "…"}.items():
        text = text.replace(mark, typeset_mark)
    text = html.escape(text)
    text = re.sub("|".join(_GREEK), lambda word: _GREEK[word[0]], text)
    text = re.sub(r"\^(\d)", r"<sup>\1</sup>", text)
    # a symbol is one letter with its marks; what follows _ is its index
    text = re.sub(
        r"(?<![\w<&/])([^\W\d_][\u0303\u0304']*)(?:_(\w+))?(?![\w;])",
        lambda found: f"<i>{found[1]}</i>" + (f"<sub>{found[2]}</sub>" if found[2] else ""),
        text,
    )
    number = f'<span style="float: right">({remark})</span>' if remark else ""
    indent = 2 if line.startswith(" ") else 1
    return f'<div style="margin-left: {indent}em; font-family: serif">{text}{number}</div>'


def _link_and_typeset(app, name, source):
    if str(app.env.doc2path(name)).endswith(".md"):
        source[0] = typeset(source[0].replace("(../data/raw/README.md)", "(logs.md)"))


# a thread of BLAS for each core changes last digits
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
