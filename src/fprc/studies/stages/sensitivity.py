"""What the numbers of one rig depend on: each of its parameters."""

import pandas as pd

from fprc.artifacts import read_json
from fprc.figures import style
from fprc.studies.families.sensitivity import changes, page_of_changes, plot_changes
from fprc.tables.text import write_table


def tabulate_sensitivity(effects: str, **files: str) -> None:
    """Write the sensitivity of all numbers to each parameter of the rig."""
    report = read_json(effects)
    table = changes(report)
    cells = report["cells"]
    impossible = sum(cell["numbers"] is None for cell in cells)
    note = (
        "Sensitivity: one parameter at the lower and at the upper end of its range; of each group "
        "the change of the number that changes most. Unstable: a reference is followed worse with "
        "feedback than without.\nSimulated, with the surrogate models, mean of "
        f"{len(cells[0]['seeds'])} seeds; {impossible} of {len(cells)} rigs are impossible"
        "; the next value takes the place of such an end. In the order of the largest change "
        "within the range."
    )
    write_table(table, page_of_changes(table), note, **files)


def draw_sensitivity(table: str, pdf: str, png: str) -> None:
    """Draw the sensitivity of all numbers to each parameter of the rig."""
    values = pd.read_csv(table)
    fig, ax = style.figure(1, 1, style.PAGE_IN, 6.8)
    bar = fig.colorbar(plot_changes(values, ax), ax=ax, location="bottom", pad=0.02, aspect=50)
    bar.set_ticks([1, 3, 10, 30, 100], labels=["1", "3", "10", "30", "100"])
    bar.ax.minorticks_off()
    bar.set_label(
        "Largest change over the parameter's range [%]; orange: the loop is unstable there"
    )
    style.save(fig, {"source": values["source"].iloc[0], "seeds": []}, pdf, png)
