"""Figure 9: share of each feature in the weights of each rule."""

from matplotlib.axes import Axes
from pandas import DataFrame

from fprc.figures.style import COLOURS

_LABELS = {"bias": "Bias", "p_o": r"$\tilde{P}_o$", "theta_d": r"$\theta_d$"}
_SHADES = {"bias": "bias", "p_o": "p_o", "theta_d": "theta"}


def plot_shares(table: DataFrame, ax: Axes) -> Axes:
    """Draw stacked bars, bias at the bottom, with the two separation lines.

    Parameters
    ----------
    table : DataFrame
        ``rule``, ``feature`` (bias, p_o, theta_d), ``lag``, ``share``.
    """
    rules = sorted(table["rule"].unique())
    bottom = dict.fromkeys(rules, 0.0)
    for feature in _LABELS:
        rows = table[table["feature"] == feature].sort_values(["rule", "lag"])
        for lag, group in rows.groupby("lag"):
            shares = group.set_index("rule")["share"]
            ax.bar(rules, shares[rules], bottom=[bottom[rule] for rule in rules], width=0.8,
                   color=COLOURS[_SHADES[feature]], alpha=1.0 - 0.13 * lag, linewidth=0,
                   label=_LABELS[feature] if lag == 0 else None)  # fmt: skip
            for rule in rules:
                bottom[rule] += shares[rule]
    totals = table.groupby(["rule", "feature"])["share"].sum().unstack()
    for edge in (totals["bias"], totals["bias"] + totals["p_o"]):
        ax.step([rules[0] - 0.5, *[r + 0.5 for r in rules]], [edge.iloc[0], *edge],
                color="#d62728", linestyle="--", linewidth=0.9)  # fmt: skip
    ax.set(xlabel="Fuzzy rule", ylabel="Share of the weights", ylim=(0, 1), xticks=rules)
    ax.set_xlim(rules[0] - 0.5, rules[-1] + 0.5)
    ax.tick_params(axis="x", length=0)
    return ax
