"""Fingerprint of the code that a rule runs, so that the workflow reruns what changed.

Snakemake cannot see into an installed package: an edit under src/ would leave
stale results behind. Each rule therefore has the fingerprint of its script
among its params.
"""

from fprc.fingerprint.closure import fingerprint, reached
from fprc.fingerprint.source import imports_of

__all__ = ["fingerprint", "imports_of", "reached"]
