"""Text for readers: lists in words; escapes for messages, Markdown and figures; symbols.

Column names, notes, units and file names come from outside. What is odd in them, and markup, is
shown as plain text.
"""

import re
from collections.abc import Iterable


def in_words(names: Iterable[str], conjunction: str = "and") -> str:
    """Return a list as a part of a sentence, ``a, b and c``; nothing for an empty one."""
    *first, last = list(names) or [""]
    return f"{', '.join(first)} {conjunction} {last}" if first else last


def visible(text: str, *, kept: str = "") -> str:
    r"""Return text on one line, with unprintable characters but those of ``kept`` as escapes.

    Control characters, and lone surrogates, which cannot be encoded: ``\x1b``, ``\n``, ``\udce9``.
    """
    return "".join(
        character
        if character.isprintable() or character in kept
        else character.encode("unicode_escape").decode()
        for character in text
    )


def figure(text: str) -> str:
    """Return text that Matplotlib draws literally: ``$`` does not begin a formula."""
    return visible(text).replace("$", r"\$")


def markdown(text: str) -> str:
    """Return text that Markdown shows literally, also in a table cell."""
    return re.sub(r"([\\`*<>|&$])", r"\\\1", visible(text))


_GREEK = {
    "theta": "θ", "epsilon": "ε", "gamma": "γ", "rho": "ρ", "sigma": "σ", "alpha": "α", "phi": "φ",
}  # fmt: skip
#: What holds no symbols: code, headings, tags, addresses of links.
_KEPT = r"^```.*?^```|^(?: {4}|\t|#)[^\n]*|(?P<fence>`+).+?(?P=fence)|<[^>\n]*>|\]\([^)\n]*\)"
_SYMBOL = re.compile(
    rf"{_KEPT}|(?<![\w.-])(?:(?P<letter>theta|θ|P̃?|[nkKWFfw])"
    r"\\?_(?P<index>d|i|o|exp|ff|fb|c|u|y|p|r|input|in|out)"
    rf"|(?P<greek>{'|'.join(_GREEK)}))(?![\w-]|\\_)",
    re.MULTILINE | re.DOTALL,
)


def typeset(text: str, *, tex: bool = False) -> str:
    """Return text whose symbols, such as ``P_o`` and ``theta_d``, have their index set low.

    In Markdown by tags; code, other tags and addresses of links stay. Or by formulas of TeX, in
    text that is escaped for LaTeX or Matplotlib.
    """

    def set_low(match: re.Match[str]) -> str:
        symbol, index = match["letter"] or match["greek"], match["index"]
        if not symbol:
            return match[0]
        if not tex:
            symbol = _GREEK.get(symbol, symbol)
            return f"{symbol}<sub>{index}</sub>" if index else symbol
        symbol = rf"\{symbol}" if symbol in _GREEK else symbol
        if not index:
            return f"${symbol}$"
        return f"${symbol}_{index}$" if len(index) == 1 else rf"${symbol}_\mathrm{{{index}}}$"

    return _SYMBOL.sub(set_low, text)
