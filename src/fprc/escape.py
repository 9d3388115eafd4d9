"""Text from files, so written that it is text in every medium.

Column names, notes, units and file names come from outside. What would steer a terminal,
compute in a spreadsheet, or mark up a page or a figure is shown as what it is.
"""

import logging
import re

_FORMULA = re.compile(r"[=@\t\r]|[+-](?!\.?\d[\d.]*(e[+-]?\d+)?$)", re.IGNORECASE)
_LATEX = {
    **{mark: f"\\{mark}" for mark in "_%&#${}"},
    "\\": "\\textbackslash{}", "~": "\\textasciitilde{}", "^": "\\textasciicircum{}",
    "±": "$\\pm$",
}  # fmt: skip


def visible(text: str) -> str:
    r"""Return one line of text with all that cannot be printed written as escapes.

    A terminal obeys control characters, and half of a surrogate pair cannot be
    encoded: ``\x1b``, ``\n``, ``\u202e``, ``\udce9``.
    """
    return _escaped(text, kept="")


def terminal(text: str) -> str:
    """Return a message as ``visible`` would show it, with its line ends and tabs."""
    return _escaped(text, kept="\n\t")


def _escaped(text: str, kept: str) -> str:
    if text.isprintable():
        return text
    return "".join(
        mark if mark.isprintable() or mark in kept else mark.encode("unicode_escape").decode()
        for mark in text
    )


class TerminalFormatter(logging.Formatter):
    """A log's lines as ``terminal`` writes them."""

    def format(self, record: logging.LogRecord) -> str:
        """Return the record as text."""
        return terminal(super().format(record))


def figure(text: str) -> str:
    """Return text that Matplotlib draws as it is: ``$`` begins no formula."""
    return visible(text).replace("$", r"\$")


def spreadsheet(text: str) -> str:
    """Return text that a spreadsheet takes for text: no formula begins a cell of a CSV file."""
    return f"'{text}" if _FORMULA.match(text) else text


def markdown(text: str) -> str:
    """Return text that Markdown shows as it is, in a table's cell too."""
    return re.sub(r"([\\`*<>|&$])", r"\\\1", visible(text))


def unmarkdown(text: str) -> str:
    """Return the text of which ``markdown`` made this."""
    return re.sub(r"\\([\\`*<>|&$])", r"\1", text)


def code(text: str) -> str:
    """Return text as code in Markdown, whatever backticks it holds."""
    text = visible(text)
    longest = max(map(len, re.findall("`+", text)), default=0)
    fence = "`" * (longest + 1)
    blank = " " if text.startswith("`") or text.endswith("`") else ""
    return f"{fence}{blank}{text}{blank}{fence}"


def latex(text: str) -> str:
    """Return text that LaTeX sets as it is."""
    return "".join(_LATEX.get(mark, mark) for mark in text)
