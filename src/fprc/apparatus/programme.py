"""Experiments on the real rig by name: control law, duration, and attributes of the log."""

from collections.abc import Mapping
from typing import Any, NamedTuple

from fprc import __version__
from fprc.artifacts import read_json
from fprc.control import Law, hysteresis_law
from fprc.errors import ConfigError
from fprc.logs import RAW_CHANNELS, TRACKING_CHANNELS
from fprc.paper import EXPERIMENTS, controller_and_gain, reference_and_controller, run_log
from fprc.registry import controllers, model_of_run, outside_class
from fprc.signals import pressure_command

_IDENTIFY = "identify_"


class Experiment(NamedTuple):
    """Experiment on the real rig, and the channels and attributes of its log."""

    law: Law  #: see ``fprc.control.run``
    samples: int
    channels: tuple[str, ...]
    attributes: dict[str, Any]
    hint: str = ""  #: instruction for the user at the rig


def names(settings: Mapping[str, Any]) -> list[str]:
    """Return the names of the experiments in the order in which they are run."""
    tracking = settings["tracking"]
    return [
        *EXPERIMENTS,
        *(f"{_IDENTIFY}{kp:g}" for kp in tracking["candidate_kp_kpa_per_deg"]),
        *(
            run_log(reference, controller)
            for reference in tracking["references"]
            for controller in controllers(settings["models"])
        ),
    ]


def refuse_unknown(name: str, settings: Mapping[str, Any]) -> None:
    """Raise ConfigError if there is no experiment of that name."""
    known = names(settings)
    if name not in known:
        raise ConfigError(f"no experiment {name}; must be one of {', '.join(known)}")


def plan(name: str, settings: Mapping[str, Any], model: str = "", gains: str = "") -> Experiment:
    """Return the experiment of that name.

    Parameters
    ----------
    settings : Mapping
        The whole configuration.
    model, gains : str
        Files of the fitted model and of the gains, for a closed-loop run.

    Raises
    ------
    ConfigError
        There is no such experiment, or the gains cannot be read.
    ControlError
        The reference is impossible.
    """
    refuse_unknown(name, settings)
    if name in EXPERIMENTS:
        planned = _hysteresis(name, settings)
    else:
        planned = _tracking(name, settings, model, gains)
    rig = {"hardware": settings["hardware"], **planned.attributes["rig"]}
    return planned._replace(attributes=planned.attributes | {"source": "rig", "rig": rig})


def _tracking(name: str, settings: Mapping[str, Any], model: str, gains: str) -> Experiment:
    # imported here because they take a second, for which the other experiments need not wait
    from fprc.experiments.tracking import Track, candidate
    from fprc.models import load_model

    bench = Track(settings["tracking"], settings["control"], settings["hardware"], settings["seed"])
    hint = ""
    if name.startswith(_IDENTIFY):
        reference, controller = "disturbance", "fprc_pd_identified"
        kp = float(name.removeprefix(_IDENTIFY))
        known_gains = {"identified": candidate(kp, bench.tracking["printed_gains"])}
    else:
        reference, controller = reference_and_controller(name)
        known_gains = _read_gains(gains)
        if reference == "disturbance":
            hint = f"push the reservoir by hand from {bench.tracking['pushes']['quiet_s']:g} s on"
    theta_d = bench.reference(reference)
    kind, gain = controller_and_gain(controller)
    outside = outside_class(model_of_run(name), settings["models"])
    fitted = None if kind == "pd" else load_model(model, outside)
    if fitted:  # compiles the step before the first tick
        fitted.step((0.0,) * fitted.n_features_in_)
    law = bench.law(theta_d, fitted, known_gains.get(gain))
    attributes = bench.describe(reference, controller, known_gains) | {"experiment": name}
    channels = (*RAW_CHANNELS, *TRACKING_CHANNELS)
    return Experiment(law, len(theta_d), channels, attributes, hint)


def _read_gains(path: str) -> dict[str, Any]:
    try:
        return read_json(path)
    except (OSError, ValueError) as error:
        why = error.strerror if isinstance(error, OSError) else f"not JSON: {error}"
        raise ConfigError(
            f"{path}: the gains cannot be read ({why}); make them with snakemake, or give --gains"
        ) from error


def _hysteresis(name: str, settings: Mapping[str, Any]) -> Experiment:
    control, signal = settings["control"], settings["experiments"][name]
    p_exp_kpa = pressure_command(signal, control["sample_rate_hz"])
    law = hysteresis_law(p_exp_kpa, control["k_in_kpa_per_deg"], control["reservoir_limit_kpa"])
    attributes = {
        "experiment": name,
        "sample_rate_hz": control["sample_rate_hz"],
        "seed": settings["seed"],
        "software": f"fprc {__version__}",
        "rig": {"control": control, "signal": signal},
    }
    return Experiment(law, len(p_exp_kpa), RAW_CHANNELS, attributes)
