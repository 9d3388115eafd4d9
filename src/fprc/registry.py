"""The models that are compared, one entry each; tables, figures and rules read them here.

Classes are given by name: reading a title imports no numerical library.
"""

from collections.abc import Mapping
from importlib import import_module
from inspect import isabstract
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Any, NamedTuple

from fprc.errors import ConfigError
from fprc.paper import CONTROLLERS, reference_and_controller

if TYPE_CHECKING:
    from fprc.models import SequenceModel

Settings = Mapping[str, Any]

#: The models' first input. They learn on the measured theta, which stands for theta_d, and run on
#: theta_d (Sec. III-A).
ANGLE = "theta_deg"


class Entry(NamedTuple):
    """A model's class, inputs and settings."""

    cls: str  #: ``module.Class``, or a function that takes the settings and returns the model
    inputs: tuple[str, ...]  #: input channels, in the order of the columns of ``X``
    #: Keys of its parameters in the section ``models``: a key, a subsection (all of its keys), or
    #: ``section.key``.
    settings: tuple[str, ...]
    title: str  #: name in tables and figures
    fixed: Settings = {}  #: parameters that no section has


_BOTH = (ANGLE, "p_o_kpa")
_RIDGE = ("n_y", "alpha")
_FUZZY = (*_RIDGE, "fprc.n_c", "fprc.sigma", "fprc.restarts")

#: The paper's models, in its order.
MODELS = {
    "esn": Entry("fprc.models.esn.ESN", (ANGLE,), (*_RIDGE, "esn"), "ESN"),
    "fprc": Entry("fprc.models.fprc.FPRC", _BOTH, (*_RIDGE, "fprc"), "FPRC"),
    "fuzzy_linear": Entry("fprc.models.fprc.FuzzyLinear", (ANGLE,), _FUZZY, "Fuzzy-linear"),
}

_BANK = {"epsilons": [0.03, 0.01, 0.003]}
# P_o itself, and its low-passes
_BANK_P_O = {"epsilons_p_o": [1.0, *_BANK["epsilons"]]}
_OF_P_O = {**_BANK, **_BANK_P_O}
_PLAYS = {"n_plays": 10}
_ALL_TAPS = {"n_references": None}
# quick, and remembers a quarter of a second
_SMALL = {"r": 100, "f_input": 0.02, "gamma": 0.98, "rho": 0.8, "washout": 100}
_PRODUCTS = {"n_taps": 5, "spacing": 25, "degree": 2, "alpha": 0.1}
_TREES = {"max_iter": 100, "max_leaf_nodes": 31, "learning_rate": 0.1}
_MLP = {"hidden_layer_sizes": [32], "tol": 1e-3}


def _competitor(
    cls: str, inputs: tuple[str, ...], settings: tuple[str, ...], title: str, **fixed: Any
) -> Entry:
    return Entry(f"fprc.models.competitors.{cls}", inputs, settings, title, fixed)


#: The models that are compared beyond the paper, the paper's first.
#:
#: Settings that one shares with a model of the paper (taps, ridge, rules) have that model's values.
#: The others were chosen by judgement, without tuning: the three low-passes are the paper's
#: epsilon, one about three times faster and one about three times slower; ten plays are usual for
#: Prandtl-Ishlinskii models; trees have scikit-learn's defaults, but do not stop early; the MLP is
#: small, and its training stops after five epochs without improvement on a held-out tenth of the
#: samples. Only NVAR's taps and ridge were searched: of 3 or 5 taps, 10 to 100 samples apart, and
#: ridges of 0.001 to 1000, these have the lowest product of errors in a cross-validation with five
#: blocks, purged by 2 s, within each of the two logs of seed 1 on the rig dry.
COMPETITORS = MODELS | {
    # low-passed theta_d takes the place of P_o
    "fprc_lowpass": MODELS["fprc"]._replace(
        inputs=(ANGLE, ANGLE), title="FPRC on low-passed theta_d"
    ),
    "ridge_p_o": _competitor(
        "on_taps", _BOTH, (*_RIDGE, "fprc.n_u", "fprc.epsilon"), "Ridge on FPRC's features"
    ),
    "linear": _competitor("on_taps", (ANGLE,), _RIDGE, "Ridge on taps", **_ALL_TAPS),
    "linear_p_o": _competitor("on_taps", _BOTH, _RIDGE, "Ridge on taps + P_o", **_ALL_TAPS),
    "bank": _competitor("on_bank", (ANGLE,), _RIDGE, "Ridge on low-passes", **_BANK),
    "bank_p_o": _competitor("on_bank", _BOTH, _RIDGE, "Ridge on low-passes + P_o", **_OF_P_O),
    "bank_fuzzy": _competitor("on_bank", (ANGLE,), _FUZZY, "Fuzzy on low-passes", **_BANK),
    "plays": _competitor("on_bank", (ANGLE,), _RIDGE, "Ridge on plays", **_PLAYS, **_BANK),
    "plays_p_o": _competitor("on_bank", _BOTH, _RIDGE, "Ridge on plays + P_o", **_PLAYS, **_OF_P_O),
    "plays_fuzzy": _competitor("on_bank", (ANGLE,), _FUZZY, "Fuzzy on plays", **_PLAYS, **_BANK),
    "nvar": _competitor("on_taps", (ANGLE,), (), "NVAR", **_PRODUCTS),
    "nvar_p_o": _competitor("on_taps", _BOTH, (), "NVAR + P_o", **_PRODUCTS),
    "echo": MODELS["esn"]._replace(settings=_RIDGE, title="Small ESN", fixed=_SMALL),
    # the same network of theta_d
    "echo_p_o": _competitor("echo_p_o", _BOTH, _RIDGE, "Small ESN + P_o", **_SMALL, **_BANK_P_O),
    "trees": _competitor("trees", (ANGLE,), ("n_y",), "Boosted trees", **_BANK, **_TREES),
    "mlp": _competitor("mlp", (ANGLE,), ("n_y",), "MLP", **_BANK, **_MLP),
}

#: Families of models without P_o and with it, alike but for that, the plainest first. FPRC on
#: low-passed theta stands on theta's side.
SIDES = {
    "taps": ("linear", "linear_p_o"),
    "low-passes": ("bank", "bank_p_o"),
    "plays": ("plays", "plays_p_o"),
    "fuzzy": ("fprc_lowpass", "fprc"),
    "NVAR": ("nvar", "nvar_p_o"),
    "ESN": ("echo", "echo_p_o"),
}


def entries(models: Settings | None = None) -> dict[str, Entry]:
    """Return every model by name: the paper's, and those of ``models.others``."""
    others = (models or {}).get("others", {})
    return MODELS | {
        name: Entry(other["estimator"], tuple(other["inputs"]), (f"others.{name}",), title_of(name))
        for name, other in others.items()
    }


def entry_of(name: str, models: Settings | None = None) -> Entry:
    """Return the entry of any model; raise ConfigError, which lists ours, if there is none."""
    known = COMPETITORS | entries(models)
    if name not in known:
        raise ConfigError(f"{name!r} is no model; choose from {', '.join(COMPETITORS)}")
    return known[name]


def title_of(name: str) -> str:
    """Return a model's name for tables and figures."""
    if name in COMPETITORS:
        return COMPETITORS[name].title
    return name[:1].upper() + name[1:].replace("_", " ")


def settings_of(name: str, models: Settings) -> dict[str, Any]:
    """Return the part of the section ``models`` that one model reads."""
    selected: dict[str, Any] = {}
    for path in entry_of(name, models).settings:
        section, _, key = path.partition(".")
        if key:
            selected.setdefault(section, {})[key] = models[section][key]
        else:
            selected[section] = models[section]
    return selected


def build(name: str, models: Settings, seed: int, **changed: Any) -> "SequenceModel":
    """Return the unfitted model of that name with its settings, but for those that are changed.

    Raise ConfigError if its class cannot be imported, or does not take the settings.
    """
    parameters = dict(entry_of(name, models).fixed)
    for key, value in settings_of(name, models).items():
        if key == "others":
            parameters = dict(value[name]["settings"])
        else:
            parameters |= value if isinstance(value, Mapping) else {key: value}
    parameters |= changed
    try:
        model = load_class(name, models)(**parameters)
    except (TypeError, ValueError) as error:
        raise ConfigError(f"{name} with {parameters}: {error}") from error
    if "random_state" in model.get_params():
        model.set_params(random_state=seed)
    return model


def load_class(name: str, models: Settings) -> Any:
    """Import what makes a model; ConfigError names the key of an outside class that is no model."""
    path = entry_of(name, models).cls
    # with a colon, the error of a module that cannot be imported comes through
    place = ":".join(path.rsplit(".", 1))
    if name not in models.get("others", {}):
        return resolve_name(place)
    try:
        loaded = resolve_name(place)
        if not issubclass(loaded, import_module("fprc.models").SequenceModel) or isabstract(loaded):
            raise TypeError("is no model")
    except Exception as error:  # the user's module may raise any error
        raise ConfigError(
            f"models.others.{name}.estimator = {path}: {type(error).__name__}: {error}; give the "
            "module.Class of a fprc.models.SequenceModel with make_features and make_readout, and "
            "put the module's folder on PYTHONPATH"
        ) from error
    return loaded


def outside_classes(models: Settings) -> list[type]:
    """Return the classes of all models of ``models.others``, for ``load_model``."""
    return [load_class(name, models) for name in models.get("others", {})]


def controllers(models: Settings) -> list[str]:
    """Return the controllers: the paper's, and each further model, alone and with PD."""
    return [*CONTROLLERS, *(f"{name}{pd}" for name in models["others"] for pd in ("", "_pd"))]


def feedforward_of(controller: str) -> str | None:
    """Return the model that computes a controller's P_ff; None for PD alone."""
    return None if controller == "pd" else controller.removesuffix("_pd")


def has_feedback(controller: str) -> bool:
    """Return whether the PD controller acts, alone or with a model's feedforward."""
    return controller == "pd" or controller.endswith("_pd")


def model_of_run(log: str) -> str:
    """Return the model that a run of the closed loop uses; FPRC if it uses none."""
    if not log.startswith("track_"):
        return "fprc"
    return feedforward_of(reference_and_controller(log)[1]) or "fprc"


def controller_title(controller: str) -> str:
    """Return a controller's name for tables and figures."""
    model = feedforward_of(controller)
    return f"{title_of(model)}{'+PD' * has_feedback(controller)}" if model else "PD"
