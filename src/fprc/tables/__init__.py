"""The paper's tables: from results to tidy data frames, and to pages for readers."""

from fprc.tables.models import (
    comparison,
    comparison_page,
    configuration,
    deviations,
    orders,
    over_seeds,
)
from fprc.tables.readout import held_out, readout, readout_page
from fprc.tables.rigs import rig_errors, rigs_answer, rigs_page
from fprc.tables.robustness import (
    ensemble,
    ensemble_page,
    sensitivity,
    sensitivity_page,
    targets,
    targets_page,
)
from fprc.tables.text import latex, markdown, read_markdown, spread
from fprc.tables.timing import steps, steps_page, timing, timing_page
from fprc.tables.tracking import tracking, tracking_over_seeds, tracking_page

__all__ = [
    "comparison",
    "comparison_page",
    "configuration",
    "deviations",
    "ensemble",
    "ensemble_page",
    "held_out",
    "latex",
    "markdown",
    "orders",
    "over_seeds",
    "read_markdown",
    "readout",
    "readout_page",
    "rig_errors",
    "rigs_answer",
    "rigs_page",
    "sensitivity",
    "sensitivity_page",
    "spread",
    "steps",
    "steps_page",
    "targets",
    "targets_page",
    "timing",
    "timing_page",
    "tracking",
    "tracking_over_seeds",
    "tracking_page",
]
