"""A fitted rig as a file of config/rigs."""

import textwrap
from collections.abc import Mapping
from typing import Any

import yaml

from fprc.config.rig import Rig
from fprc.studies.calibration.fit import LIMITS

#: Marks a file that may be overwritten.
WRITTEN = "Written by `fprc calibrate`"


def parameter_file(rig: Mapping[str, Any], summary: Mapping[str, Any], name: str) -> str:
    """Return the text of a rig's file: what was fitted, and what differs from the defaults.

    Parameters
    ----------
    summary : Mapping
        As ``fprc.studies.calibration.fit.fit_rig`` returns it.
    name : str
        Name of the rig.
    """
    near = [path for path, share in summary["shares"].items() if not 0.02 <= share <= 0.98]
    head = _HEAD.format(
        **summary,
        written=WRITTEN,
        count=len(summary["shares"]),
        limits="\n".join(
            f"  {name}: {100 * share:.1f} %, at most {100 * LIMITS[name]:.0f}"
            for name, share in summary["brief"].items()
        ),
        edges=textwrap.fill(
            f"Within 2 % of an end of their range: {', '.join(near) or 'none'}.", 98
        ),
    )
    values = {
        "fitted": {"name": name, "to": list(summary["fit"])},
        "rig": Rig.model_validate(rig).model_dump(mode="json", exclude_defaults=True),
    }
    return textwrap.indent(head, "# ", lambda _: True) + yaml.safe_dump(
        values, sort_keys=False, default_flow_style=None
    )


_HEAD = """\
Parameters of the simulated rig that differ from their defaults. {written}
({software}, {date}); docs/rigs.md explains it.

Fitted over {count} parameters, from the ranges of `calibration` alone, with the seed {seed}, to the
terms that `fitted.to` names. Everything else is predicted. How far the full models on {full_count}
seeds of the fit are from print, errors of Tables II and III, open and closed loop of Table IV:
{limits}
{edges}
"""
