"""Text of files from outside, made fit for a terminal."""


def visible(text: str) -> str:
    r"""Return one line of text with all that cannot be printed written as escapes.

    A terminal obeys control characters, and half of a surrogate pair cannot be
    encoded: ``\x1b``, ``\n``, ``\udce9``.
    """
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)
