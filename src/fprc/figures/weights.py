"""Figure 9: share of each feature in the weights of each rule."""

from collections.abc import Mapping
from typing import Any

from matplotlib.figure import Figure
from matplotlib.legend_handler import HandlerTuple
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from pandas import DataFrame

from fprc.figures import style

_LABELS = {"bias": "Bias", "p_o": r"$\tilde{P}_o$", "theta_d": r"$\theta_d$"}
_COLOURS = style.SIGNALS | {"bias": "#cccccc"}
#: Lines between the features, from the top, by their names.
_LIMITS: dict[str, dict[str, Any]] = {
    r"$\theta_d$ above, $\tilde{P}_o$ below": {"linewidth": 1.3},
    r"$\tilde{P}_o$ above, bias below": {"linewidth": 1.3, "linestyle": (0, (1.5, 1))},
}
#: Columns of the averages, each drawn as one bar, and the bars' names.
_AVERAGES = {"mean_of_feature": "mean", "published_mean_of_feature": "paper"}


def weight_shares(report: Mapping[str, Any], published: Mapping[str, Any]) -> DataFrame:
    """Share of each weight in its rule, and each feature's mean over rules, ours and the paper's.

    The paper prints no mean for the bias; it is 1 minus the two printed means.
    """
    percent = published["fig_portion_mean_weight_share_percent"]
    printed = {name: share / 100 for name, share in percent.items()}
    printed["bias"] = 1.0 - sum(printed.values())
    return DataFrame(
        {
            "rule": rule,
            "feature": feature,
            "lag": lag,
            "share": share,
            "mean_of_feature": report["mean_share"].get(feature),
            "published_mean_of_feature": printed[feature],
            "source": report["source"],
        }
        for feature, rules in report["shares"].items()
        for rule, lags in enumerate(rules, start=1)
        for lag, share in enumerate(lags)
    )


def draw_shares(table: DataFrame) -> Figure:
    """Draw stacked bars: bias, P_o and theta_d from the bottom, separated by red lines.

    Beside the rules: the mean over the rules, and the mean that the paper prints, in percent.
    """
    fig, ax = style.figure(1, 1, style.COLUMN_IN, 2.8)
    shares = table.pivot(index="rule", columns=["feature", "lag"], values="share")[list(_LABELS)]
    rules, edges = list(shares.index), shares.cumsum(axis=1)
    opacity = [max(1.0 - 0.15 * lag, 0.1) for lag in range(table["lag"].max() + 1)]
    for (feature, lag), share in shares.items():
        ax.bar(rules, share, bottom=edges[feature, lag] - share, width=0.8,
               color=_COLOURS[feature], alpha=opacity[lag], linewidth=0)  # fmt: skip
    for feature, look in zip(("p_o", "bias"), _LIMITS.values(), strict=True):
        edge = edges[feature].iloc[:, -1]
        ax.hlines(edge, edge.index - 0.4, edge.index + 0.4, color=style.MARK, **look)
    places = [rules[-1] + 1.6 * number for number, _ in enumerate(_AVERAGES, start=1)]
    for place, column in zip(places, _AVERAGES, strict=True):
        means = table.groupby("feature")[column].first().reindex(list(_LABELS)).dropna()
        for feature, top in means.cumsum().items():
            share = means[feature]
            ax.bar(place, share, bottom=top - share, width=1.4, color=_COLOURS[feature],
                   linewidth=0)  # fmt: skip
            if feature != "bias":
                ax.text(place, top - share / 2, f"{100 * share:.0f} %", ha="center", va="center",
                        color="white" if feature == "p_o" else "black")  # fmt: skip
    ax.set(xlabel="Fuzzy rule", ylabel="Share of the weights", ylim=(0, 1))
    ax.set_xticks([*rules, *places], [*map(str, rules), *_AVERAGES.values()])
    ax.set_xlim(rules[0] - 0.5, places[-1] + 0.8)
    ax.tick_params(axis="x", length=0)
    # a key of the features' colours and of the shades of their taps
    taps = table.groupby("feature")["lag"].max()
    marks: list[Any] = [
        tuple(Patch(color=_COLOURS[name], alpha=shade, linewidth=0)
              for shade in opacity[: taps[name] + 1])
        for name in _LABELS
    ]  # fmt: skip
    marks += [Line2D([], [], color=style.MARK, **look) for look in _LIMITS.values()]
    steps = {name: f", $k$ to $k-{last}$" if last else "" for name, last in taps.items()}
    steps["bias"] = f", up to {100 * shares['bias'].to_numpy().max():.1f} %"
    names = [*(label + steps[name] for name, label in _LABELS.items()), *_LIMITS]
    fig.legend(
        marks, names, loc="outside upper center", ncols=2, columnspacing=1.2,
        handler_map={tuple: HandlerTuple(None, pad=0.0)},
    )  # fmt: skip
    return fig
