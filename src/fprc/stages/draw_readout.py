"""Draw what the reservoir's readout is worth."""

from collections.abc import Mapping
from typing import Any

from fprc.artifacts import read_json
from fprc.figures import style
from fprc.figures.readout import plot_readouts
from fprc.tables import readout


def draw_readout(cells: str, pdf: str, png: str) -> Mapping[str, Any]:
    """Draw validation (blocked folds) and test errors over epsilon and n_u."""
    report = read_json(cells)
    table, own = readout(report), report["own"]
    table = table[table["split"] == "blocked"]
    over = {
        "epsilon": table[table["n_u"] == own["n_u"]],
        "n_u": table[table["epsilon"] == own["epsilon"]],
    }
    labels = {"epsilon": r"$\epsilon$", "n_u": "$n_u$"}
    fig, axes = style.figure(2, 2, style.COLUMN_IN, 3.8, sharey="row", sharex="col")
    for row, (error, name) in zip(
        axes, {"validation_rmse": "Validation", "test_rmse": "Test"}.items(), strict=True
    ):
        for ax, setting in zip(row, over, strict=True):
            plot_readouts(over[setting], setting, error, ax)
            if error.startswith("test"):
                ax.set_xlabel(labels[setting])
            ax.label_outer()
        style.letter(row[0], f"{name}, over {labels['epsilon']}")
        style.letter(row[1], f"{name}, over {labels['n_u']}")
    axes[0, 0].set_xscale("log")
    style.share_legend(fig, axes[0, 0])
    return style.save(fig, report, pdf, png)
