"""Draw the figures of hysteresis and models from result files.

The files of a figure are its PDF and PNG, and the CSV with the statistics that it shows, if any.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from fprc.artifacts import read_json
from fprc.config import PUBLISHED
from fprc.experiments.data import read_data
from fprc.experiments.grids import weight_shares
from fprc.experiments.settings import CrossValidation
from fprc.figures import grids as grid_figures
from fprc.figures import hysteresis, loops, style, weights
from fprc.logs import read_columns
from fprc.yaml_file import read_yaml


def draw_hysteresis(
    sweep: str, complex: str, fig4: Sequence[str] = (), fig5: Sequence[str] = ()
) -> None:
    """Figures 4 and 5, those that are asked for."""
    channels = ("time_s", "p_target_kpa", "theta_deg")
    for files, more, draw in (
        (fig4, (), hysteresis.draw_actuator),
        (fig5, ("p_o_kpa",), hysteresis.draw_reservoir),
    ):
        if files:
            logs = [read_columns(path, (*channels, *more)) for path in (sweep, complex)]
            style.save(draw(logs), logs[0].attributes, *files)


def draw_training(fits: str, predictions: str, fig8: Sequence[str]) -> None:
    """Figure 8: the model on its training and on its test data."""
    names = ("time_s", "p_target_kpa", "p_ff_kpa")
    logs = {"train": read_columns(fits, names), "test": read_columns(predictions, names)}
    table = loops.fit_errors(logs)
    fig = loops.draw_training(logs, table)
    style.save(fig, logs["train"].attributes, *fig8, table=table)


def draw_weights(train: str, fig9: Sequence[str], *, validation: Mapping[str, Any]) -> None:
    """Figure 9: proportional contribution of the normalised weights of the FPRC, rule by rule."""
    data = read_data(train)
    described = {"source": data.attributes["source"], "seed": validation["seed"]}
    shares = described | weight_shares(data, CrossValidation(**validation))
    table = weights.weight_shares(shares, read_yaml(PUBLISHED))
    style.save(weights.draw_shares(table), described, *fig9, table=table)


def draw_grids(
    grids: Sequence[str], times: str, fig10: Sequence[str], fig11: Sequence[str] = ()
) -> None:
    """Figures 10 and 11: errors over epsilon, n_c and the taps, execution times over n_c.

    The errors are over further seeds, or over the folds of one report. Without FPRC there are no
    errors over epsilon and over the taps.
    """
    reports = [read_json(path) for path in grids]
    several = len(reports) > 1
    marks = {"seeds": [report["seed"] for report in reports]} if several else reports[0]
    panels = {
        "a": grid_figures.grid_errors(reports, "epsilon"),
        "b": grid_figures.grid_errors(reports, "n_c"),
        "c": grid_figures.times_over_n_c(read_json(times)),
    }
    panels = {panel: table for panel, table in panels.items() if not table.empty}
    shown = pd.concat(panels, names=["panel"]).reset_index("panel")
    spread = f"± std over {'seeds' if several else 'folds'}"
    style.save(grid_figures.draw_settings(panels, spread), marks, *fig10, table=shown)
    if fig11:
        table = grid_figures.grid_errors(reports, "taps")
        printed = read_yaml(PUBLISHED)["table_1_configuration"]
        papers = printed["fprc"]["n_u"], printed["shared"]["n_y"]
        style.save(grid_figures.draw_taps(table, papers), marks, *fig11, table=table)
