"""Figure 9: share of each feature in the weights of each rule."""

from matplotlib.axes import Axes
from pandas import DataFrame, Series

from fprc.figures.style import SIGNALS

_LABELS = {"bias": "Bias", "p_o": r"$\tilde{P}_o$", "theta_d": r"$\theta_d$"}
_COLOURS = SIGNALS | {"bias": "#cccccc"}
#: Columns of the averages, each drawn as one bar, and the bars' names.
_AVERAGES = {"mean_of_feature": "mean", "published_mean_of_feature": "paper"}


def plot_shares(table: DataFrame, ax: Axes) -> Axes:
    """Draw stacked bars, bias at the bottom, with the two separation lines.

    Beside the rules: the mean over the rules, and the mean that the paper prints.

    Parameters
    ----------
    table : DataFrame
        ``rule``, ``feature`` (bias, p_o, theta_d), ``lag``, ``share``, ``mean_of_feature``,
        ``published_mean_of_feature``.
    """
    rules = sorted(table["rule"].unique())
    bottom = dict.fromkeys(rules, 0.0)
    for feature in _LABELS:
        rows = table[table["feature"] == feature].sort_values(["rule", "lag"])
        for lag, group in rows.groupby("lag"):
            shares = group.set_index("rule")["share"]
            ax.bar(rules, shares[rules], bottom=[bottom[rule] for rule in rules], width=0.8,
                   color=_COLOURS[feature], alpha=1.0 - 0.13 * lag, linewidth=0,
                   label=_LABELS[feature] if lag == 0 else None)  # fmt: skip
            for rule in rules:
                bottom[rule] += shares[rule]
    totals = table.groupby(["rule", "feature"])["share"].sum().unstack()
    for edge in (totals["bias"], totals["bias"] + totals["p_o"]):
        ax.step([rules[0] - 0.5, *[r + 0.5 for r in rules]], [edge.iloc[0], *edge],
                color="black", linestyle="--", linewidth=0.9)  # fmt: skip
    places = [rules[-1] + 1.6 * number for number, _ in enumerate(_AVERAGES, start=1)]
    for place, column in zip(places, _AVERAGES, strict=True):
        _plot_average(table.groupby("feature")[column].first().dropna(), place, ax)
    ax.set(xlabel="Fuzzy rule", ylabel="Share of the weights", ylim=(0, 1))
    ax.set_xticks([*rules, *places], [*map(str, rules), *_AVERAGES.values()])
    ax.set_xlim(rules[0] - 0.5, places[-1] + 0.8)
    ax.tick_params(axis="x", length=0)
    return ax


def _plot_average(shares: "Series[float]", place: float, ax: Axes) -> None:
    """Draw one bar; the parts of P_o and theta_d are labelled in percent."""
    bottom = 0.0
    for feature in (name for name in _LABELS if name in shares):
        share = shares[feature]
        ax.bar(place, share, bottom=bottom, width=1.4, color=_COLOURS[feature], linewidth=0)
        if feature in ("p_o", "theta_d"):
            ax.text(place, bottom + share / 2, f"{100 * share:.0f} %", ha="center", va="center",
                    color="white" if feature == "p_o" else "black")  # fmt: skip
        bottom += share
