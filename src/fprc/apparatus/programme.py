"""Experiments on the real rig by name: control law, duration, and attributes of the log."""

from collections.abc import Mapping
from typing import Any, NamedTuple

from fprc import __version__
from fprc.channels import RAW_CHANNELS, unit_of
from fprc.config.settings import Control, Signal
from fprc.config.tracking import Tracking
from fprc.control import Law, hysteresis_law
from fprc.errors import ConfigError, FprcError
from fprc.escape import in_words
from fprc.paper import EXPERIMENTS, reference_and_controller, run_log
from fprc.registry import controllers, entries, feedforward_of, load_class, outside_classes
from fprc.signals import pressure_command


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


def plan(name: str, settings: Mapping[str, Any], model: str = "") -> Experiment:
    """Return the experiment of that name.

    Parameters
    ----------
    settings : Mapping
        The whole configuration.
    model : str
        File of the fitted model, for a closed-loop run.

    Raises
    ------
    ConfigError
        There is no such experiment, its commands are beyond ``hardware.limits``, or the file holds
        another model than the experiment's.
    ControlError
        The reference is impossible, or a model is needed and there is none.
    FprcError
        The file holds no model, was changed, or its model makes no step.
    """
    refuse_unknown(name, settings)
    if name in EXPERIMENTS:
        planned = _hysteresis(name, settings)
    else:
        planned = _tracking(name, settings, model)
    rig = {"hardware": settings["hardware"], **planned.attributes["rig"]}
    of_rig = {"source": "rig", "software": f"fprc {__version__}", "rig": rig}
    return planned._replace(attributes=planned.attributes | of_rig)


def _tracking(name: str, settings: Mapping[str, Any], model: str) -> Experiment:
    # imported here because they take a second, for which the other experiments need not wait
    from fprc.experiments.tracking import Track, describe_model
    from fprc.experiments.trained import refuse_other_data
    from fprc.models import load_model

    control, limits = Control(**settings["control"]), settings["hardware"]["limits"]
    bench = Track(Tracking(**settings["tracking"]), control, {}, settings["seed"])
    hint = ""
    reference, controller = reference_and_controller(name)
    if reference == "disturbance":
        hint = f"push the reservoir by hand from {bench.tracking.pushes.quiet_s:g} s on"
    theta_d = bench.reference(reference)
    p_i_kpa = min(control.reservoir_limit_kpa, control.k_in_kpa_per_deg * theta_d.max())
    _refuse_beyond(limits, "p_i_kpa", p_i_kpa, "lower control.reservoir_limit_kpa")
    p_d_kpa = bench.tracking.pressure_limit_kpa
    _refuse_beyond(limits, "p_exp_kpa", p_d_kpa, "lower tracking.pressure_limit_kpa")
    driver = feedforward_of(controller)
    attributes, fitted = bench.describe(reference, controller), None
    if driver and model:  # without a file the law refuses to start
        fitted = load_model(model, outside_classes(settings["models"]))
        which, inputs = f"{model}, the model of {name}", entries(settings["models"])[driver].inputs
        _refuse_other(fitted, driver, settings["models"], which)
        units = [unit_of(channel) for channel in ("p_target_kpa", *inputs)]
        refuse_other_data(fitted, which, control.sample_rate_hz, units)
        try:  # which also compiles the step before the first tick
            fitted.step((0.0,) * fitted.n_features_in_)
        except Exception as error:  # a class from outside may raise any error
            raise FprcError(f"{model}: makes no step ({error}); train the model again") from error
        attributes |= describe_model(fitted, model)
    law = bench.law(theta_d, controller, fitted)
    channels = (*RAW_CHANNELS, *bench.channels(controller))
    return Experiment(law, len(theta_d), channels, attributes, hint)


def _refuse_other(fitted: Any, driver: str, models: Mapping[str, Any], which: str) -> None:
    """Check that a fitted model is the one that gives the log its name."""
    found, needed, inputs = type(fitted), load_class(driver, models), entries(models)[driver].inputs
    if found is not needed:
        raise ConfigError(
            f"{which}, is a {found.__name__}, must be a {needed.__name__}; give --model a file of "
            f"{driver}, or choose the experiment that is named after the model"
        )
    columns = getattr(fitted, "n_features_in_", None)  # a class from outside may have none
    if columns != len(inputs):
        raise ConfigError(
            f"{which}, was fitted to {columns} inputs, must have {len(inputs)}, "
            f"{in_words(inputs)}; train it again"
        )


def _refuse_beyond(limits: Mapping[str, Any], sensor: str, highest: float, remedy: str) -> None:
    """Check that a command, as far as it may go, does not end the run by its reading."""
    _, limit = limits[sensor]
    if highest > limit:
        raise ConfigError(
            f"commands go up to {highest:g} kPa, and a reading above {limit:g} ends a run "
            f"(hardware.limits.{sensor}); {remedy}"
        )


def _hysteresis(name: str, settings: Mapping[str, Any]) -> Experiment:
    control = Control(**settings["control"])
    signal = Signal(**settings["experiments"][name])
    p_exp_kpa = pressure_command(signal, control.sample_rate_hz)
    limits = settings["hardware"]["limits"]
    lower = f"experiments.{name}: lower its amplitude_kpa or offset_kpa"
    _refuse_beyond(limits, "p_exp_kpa", p_exp_kpa.max(), lower)
    lower = "lower control.reservoir_limit_kpa"
    _refuse_beyond(limits, "p_i_kpa", control.reservoir_limit_kpa, lower)
    attributes = {
        "experiment": name,
        "sample_rate_hz": control.sample_rate_hz,
        "seed": settings["seed"],
        "rig": {"control": settings["control"], "signal": settings["experiments"][name]},
    }
    law = hysteresis_law(p_exp_kpa, control)
    return Experiment(law, len(p_exp_kpa), RAW_CHANNELS, attributes)
