"""Draw actuator, reservoir and apparatus, and the control systems as block diagrams."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from fprc.channels import RESERVOIR
from fprc.figures import style
from fprc.figures.apparatus import plot_apparatus
from fprc.figures.blocks import canvas
from fprc.figures.diagrams import plot_esn_system, plot_fprc_system
from fprc.figures.structure import plot_actuator, plot_mapping, plot_reservoir
from fprc.logs import read_columns
from fprc.logs.isolated import isolated_each

_NO_DATA = {"source": "none"}


def draw_actuator(raw: str, pdf: str, png: str) -> Mapping[str, Any]:
    """Figure 1: the actuator at its largest angle, and at its least pressure after that."""
    (log,) = isolated_each(read_columns, [raw], names=("p_exp_kpa", "theta_deg"))
    p_exp, theta = log.channels.values()
    bent = int(np.argmax(theta))
    straight = bent + int(np.argmin(p_exp[bent:]))
    at_bent, at_straight = ((float(p_exp[k]), float(theta[k])) for k in (bent, straight))
    fig, ax = canvas(2.1)
    plot_actuator(at_bent, at_straight, ax, limit_kpa=float(p_exp.max()))
    return style.save(fig, log.attributes, pdf, png)


def draw_reservoir(raw: str, pdf: str, png: str, *, k_in_kpa_per_deg: float) -> Mapping[str, Any]:
    """Figure 2: the reservoir at the least P_i and at its largest angle; P_o over P_i."""
    (log,) = isolated_each(read_columns, [raw], names=RESERVOIR)
    p_i, p_o, phi = log.channels.values()
    rest, driven = (
        (float(p_i[k]), float(p_o[k]), float(phi[k])) for k in (np.argmin(p_i), np.argmax(phi))
    )
    fig, ax = canvas(3.84)
    plot_reservoir(rest, driven, ax, limit_kpa=float(p_i.max()))
    plot_mapping(p_i, p_o, {"b": rest, "c": driven}, ax, k_in_kpa_per_deg=k_in_kpa_per_deg)
    return style.save(fig, log.attributes, pdf, png)


def draw_apparatus(pdf: str, png: str) -> Mapping[str, Any]:
    """Figure 3: the apparatus."""
    fig, ax = canvas(3.3)
    plot_apparatus(ax)
    return style.save(fig, _NO_DATA, pdf, png)


def draw_esn_system(pdf: str, png: str, *, models: Mapping[str, Any]) -> Mapping[str, Any]:
    """Figure 6: control with the ESN."""
    fig, ax = canvas(2.2)
    plot_esn_system(models, ax)
    return style.save(fig, _NO_DATA, pdf, png)


def draw_fprc_system(
    pdf: str, png: str, *, models: Mapping[str, Any], control: Mapping[str, Any]
) -> Mapping[str, Any]:
    """Figure 7: control with the FPRC."""
    fig, ax = canvas(2.82)
    plot_fprc_system(models, control, ax)
    return style.save(fig, _NO_DATA, pdf, png)
