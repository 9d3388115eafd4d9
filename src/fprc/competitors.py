"""The models that compete beyond the paper: titles, inputs and settings, one entry each.

``fprc.models.competitors`` builds them; this module loads no numerics.

Settings that a competitor shares with a model of the paper (taps, ridge, rules) have that model's
values. The others were chosen by judgement, without tuning: the three low-passes are the paper's
epsilon, one about three times faster and one about three times slower; ten plays are usual for
Prandtl-Ishlinskii models; trees have scikit-learn's defaults; the MLP is small, and its training
stops after five epochs without improvement on a held-out tenth of the samples. Only NVAR's taps and
ridge were searched: of 3 or 5 taps, 10 to 100 samples apart, and ridges of 0.001 to 1000, these
have the lowest product of errors in a cross-validation with five blocks, purged by 2 s, within each
of the two logs of seed 1 on the rig dry.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

from fprc.errors import ConfigError
from fprc.registry import ANGLE, MODELS, parameters_at


class Competitor(NamedTuple):
    """A model's title, inputs and settings."""

    title: str  #: name in tables and figures
    inputs: tuple[str, ...]  #: input channels, in the order of the columns of ``X``
    shared: tuple[str, ...]  #: keys of the section ``models``, as in ``registry.Entry.settings``
    own: dict[str, Any]  #: settings that no model of the paper has


_BANK = {"epsilons": [0.03, 0.01, 0.003]}
_RIDGE = ("n_y", "alpha")
_TAPS = ("n_y", "fprc.n_u", "fprc.epsilon", "alpha")
_FUZZY = MODELS["fuzzy_linear"].settings
_THETA = (ANGLE,)
_BOTH = (ANGLE, "p_o_kpa")

#: Every competitor by name, the paper's models first.
COMPETITORS = {
    name: Competitor(entry.title, entry.inputs, entry.settings, {})
    for name, entry in MODELS.items()
} | {
    # low-passed theta_d takes the place of P_o
    "fprc_lowpass": Competitor(
        "FPRC on low-passed theta_d", (ANGLE, ANGLE), MODELS["fprc"].settings, {}
    ),
    "ridge_p_o": Competitor("Ridge on FPRC's features", _BOTH, _TAPS, {}),
    "bank_p_o": Competitor(
        "Ridge on low-passes of P_o", _BOTH, _RIDGE, {"epsilons": [1.0, *_BANK["epsilons"]]}
    ),
    "bank": Competitor("Ridge on low-passes", _THETA, _RIDGE, _BANK),
    "bank_fuzzy": Competitor("Fuzzy on low-passes", _THETA, _FUZZY, _BANK),
    "plays": Competitor("Ridge on plays", _THETA, _RIDGE, {"n_plays": 10} | _BANK),
    "plays_fuzzy": Competitor("Fuzzy on plays", _THETA, _FUZZY, {"n_plays": 10} | _BANK),
    "nvar": Competitor("NVAR", _THETA, (), {"n_taps": 5, "spacing": 25, "degree": 2, "alpha": 0.1}),
    "trees": Competitor(
        "Boosted trees",
        _THETA,
        ("n_y",),
        _BANK | {"max_iter": 100, "max_leaf_nodes": 31, "learning_rate": 0.1},
    ),
    "mlp": Competitor("MLP", _THETA, ("n_y",), _BANK | {"hidden": [32], "tolerance": 1e-3}),
}


#: Name of every competitor in tables and figures.
TITLES = {name: entry.title for name, entry in COMPETITORS.items()}


def default_settings(name: str, models: Mapping[str, Any]) -> dict[str, Any]:
    """Return all settings of a competitor, for ``fprc.models.competitors.build_competitor``.

    Parameters
    ----------
    models : Mapping
        Section ``models`` of the configuration, for the settings of the paper's models.
    """
    entry = competitor(name)
    return parameters_at(entry.shared, models) | entry.own


def competitor(name: str) -> Competitor:
    """Return the entry of that name.

    Raises
    ------
    ConfigError
        There is none; the message lists all competitors.
    """
    if name not in COMPETITORS:
        raise ConfigError(f"{name!r} is no competitor; choose from {', '.join(COMPETITORS)}")
    return COMPETITORS[name]


def base_of(name: str) -> str:
    """Return the competitor that a model is, without the suffix of its settings."""
    base, _, suffix = name.rpartition("_")
    return base if suffix in ("tuned", "matched", "oracle") else name
