"""The package's messages on the terminal, while a command runs."""

import logging
from collections.abc import Iterator
from contextlib import contextmanager

from fprc.escape import TerminalFormatter


@contextmanager
def messages_on_terminal() -> Iterator[None]:
    """Write the package's messages to the standard error, not those of other libraries."""
    logger = logging.getLogger("fprc")
    handler = logging.StreamHandler()
    handler.setFormatter(TerminalFormatter())
    level = logger.level
    logger.addHandler(handler)
    logger.setLevel(logging.INFO)
    try:
        yield
    finally:
        logger.removeHandler(handler)
        logger.setLevel(level)
