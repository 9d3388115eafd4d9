"""A fitted rig as a file of config/rigs."""

import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

import yaml

from fprc.config.rig import Rig

#: Marks a file that may be overwritten.
WRITTEN = "Written by `fprc calibrate`"


def parameter_file(
    rig: Mapping[str, Any],
    summary: Mapping[str, Any],
    name: str,
    began: Mapping[str, Sequence[Any]],
) -> str:
    """Return the text of a rig's file: what was fitted, and what differs from the defaults.

    Parameters
    ----------
    summary : Mapping
        As ``fprc.studies.calibration.fit.fit_rig`` returns it.
    name : str
        Name of the rig.
    began : Mapping
        Section ``fitted`` of the rig at which the fit began.
    """
    head = _HEAD.format(
        **summary,
        written=WRITTEN,
        median=100 * summary["median_deviation"],
        largest=100 * summary["largest_deviation"],
        shown_seeds=", ".join(map(str, summary["seeds"])),
        shown_full_seeds=", ".join(map(str, summary["full_seeds"])),
        count=len(summary["parameters"]),
        rows="\n".join(
            f"#   {measure}/{key}: {summary['printed'][measure][key]:g}, {100 * value:+.1f} %"
            for measure, residuals in summary["residuals"].items()
            for key, value in residuals.items()
        ),
        edges=_edges(summary["parameters"]),
    )
    values = {
        "fitted": {
            "name": name,
            "to": list(summary["fit"]),
            "start": list(dict.fromkeys([*began["to"], *began["start"]])),
            "seeds": sorted({*began["seeds"], *summary["seeds"], *summary["full_seeds"]}),
        },
        "rig": Rig.model_validate(rig).model_dump(mode="json", exclude_defaults=True),
    }
    return head + yaml.safe_dump(values, sort_keys=False, default_flow_style=None)


_HEAD = """\
# Parameters of the simulated rig that differ from their defaults. {written}
# ({software}, {date}); docs/calibration.md explains it.
#
# Fitted over {count} parameters within the ranges of `calibration` ({evaluations} rigs), on the
# noise seeds {shown_seeds},
# to the terms that `fitted.to` names; `fitted.start` has those that the rig at which the fit began
# had been searched for. Everything else is predicted.
# Full models on the seeds {shown_full_seeds},
# printed errors (tables in kPa, loops in deg) and deviations from them; of the tables
# {median:.1f} % in the median and {largest:.1f} % at most:
{rows}
{edges}
"""


def _edges(parameters: Sequence[Mapping[str, Any]]) -> str:
    near = [p["path"] for p in parameters if not 0.02 <= p["share"] <= 0.98]
    text = f"Within 2 % of an end of their range: {', '.join(near) or 'none'}."
    return textwrap.fill(
        text, 100, initial_indent="# ", subsequent_indent="# ", break_long_words=False
    )
