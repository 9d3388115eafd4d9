"""Experiments on the real rig by name: control law, duration, and attributes of the log."""

from collections.abc import Mapping
from typing import Any, NamedTuple

from fprc import __version__
from fprc.channels import RAW_CHANNELS, unit_of
from fprc.config.settings import Control, Signal
from fprc.config.tracking import Tracking
from fprc.control import Law, hysteresis_law
from fprc.errors import ConfigError
from fprc.escape import in_words
from fprc.paper import DISTURBANCE, EXPERIMENTS, reference_and_controller, run_log
from fprc.registry import controllers, entries, feedforward_of, load_class, outside_classes
from fprc.signals import pressure_command


class Experiment(NamedTuple):
    """Experiment on the real rig, and the channels and attributes of its log."""

    law: Law  #: see ``fprc.control.run``
    samples: int
    channels: tuple[str, ...]
    attributes: dict[str, Any]
    hint: str = ""  #: what the user at the rig must do, after a semicolon


def names(settings: Mapping[str, Any]) -> list[str]:
    """Return the names of the experiments in the order in which they are run."""
    references, laws = settings["tracking"]["references"], controllers(settings["models"])
    return [*EXPERIMENTS, *(run_log(reference, law) for reference in references for law in laws)]


def refuse_unknown(name: str, settings: Mapping[str, Any]) -> None:
    """Raise ConfigError if there is no experiment of that name."""
    known = names(settings)
    if name not in known:
        raise ConfigError(f"no experiment {name}; must be one of {', '.join(known)}")


def plan(name: str, settings: Mapping[str, Any], model: str = "") -> Experiment:
    """Return the experiment of that name, with the model in a file if it needs one.

    Raises
    ------
    FprcError
        There is no such experiment, its commands are beyond ``hardware.limits``, or its reference
        is impossible; the model is missing, was changed, is another than the experiment's, or was
        trained at another rate or in other units.
    """
    refuse_unknown(name, settings)
    planned = (
        _hysteresis(name, settings) if name in EXPERIMENTS else _tracking(name, settings, model)
    )
    rig = {"hardware": settings["hardware"], **planned.attributes["rig"]}
    of_rig = {"source": "rig", "software": f"fprc {__version__}", "rig": rig}
    return planned._replace(attributes=planned.attributes | of_rig)


def _hysteresis(name: str, settings: Mapping[str, Any]) -> Experiment:
    control, signal = Control(**settings["control"]), Signal(**settings["experiments"][name])
    p_exp_kpa = pressure_command(signal, control.sample_rate_hz)
    _refuse_beyond(settings, p_exp_kpa=p_exp_kpa.max(), p_i_kpa=control.reservoir_limit_kpa)
    attributes = {
        "experiment": name,
        "sample_rate_hz": control.sample_rate_hz,
        "seed": settings["seed"],
        "rig": {"control": settings["control"], "signal": settings["experiments"][name]},
    }
    law = hysteresis_law(p_exp_kpa, control)
    return Experiment(law, len(p_exp_kpa), RAW_CHANNELS, attributes)


def _tracking(name: str, settings: Mapping[str, Any], model: str) -> Experiment:
    # imported here because it takes a second, for which the other experiments need not wait
    from fprc.experiments.tracking import Track, describe_model

    control, tracking = Control(**settings["control"]), Tracking(**settings["tracking"])
    bench = Track(tracking, control, {}, settings["seed"])
    reference, controller = reference_and_controller(name)
    theta_d = bench.reference(reference)
    p_i_kpa = control.k_in_kpa_per_deg * theta_d.max()
    _refuse_beyond(settings, p_exp_kpa=tracking.pressure_limit_kpa, p_i_kpa=p_i_kpa)
    hint = f"; push the reservoir by hand from {tracking.pushes.quiet_s:g} s on"
    attributes, fitted = bench.describe(reference, controller), None
    driver = feedforward_of(controller)
    if driver and model:  # without a file the law refuses to start
        fitted = _load(model, name, driver, settings)
        attributes |= describe_model(fitted, model)
    return Experiment(
        bench.law(theta_d, controller, fitted),
        len(theta_d),
        (*RAW_CHANNELS, *bench.channels(controller)),
        attributes,
        hint if reference == DISTURBANCE else "",
    )


def _refuse_beyond(settings: Mapping[str, Any], **highest: float) -> None:
    """Check that no command, as far as it may go, ends the run by its reading."""
    for sensor, kpa in highest.items():
        if kpa > (limit := settings["hardware"]["limits"][sensor][1]):
            raise ConfigError(
                f"commands go up to {kpa:g} kPa, and a reading above {limit:g} ends a run "
                f"(hardware.limits.{sensor}); lower the amplitude, tracking.pressure_limit_kpa or "
                "control.reservoir_limit_kpa"
            )


def _load(file: str, name: str, driver: str, settings: Mapping[str, Any]) -> Any:
    """Load the model of an experiment, and check that it is the one in the name."""
    from fprc.experiments.trained import refuse_other_data
    from fprc.models import load_model

    models, which = settings["models"], f"{file}, the model of {name}"
    inputs, needed = entries(models)[driver].inputs, load_class(driver, models)
    fitted = load_model(file, outside_classes(models))
    if type(fitted) is not needed:
        raise ConfigError(
            f"{which}, is a {type(fitted).__name__}, must be a {needed.__name__}; give another "
            "--model, or choose the experiment that is named after it"
        )
    if (columns := fitted.n_features_in_) != len(inputs):
        raise ConfigError(
            f"{which}, was fitted to {columns} inputs, must have {len(inputs)}, "
            f"{in_words(inputs)}; train it again"
        )
    units = [unit_of(channel) for channel in ("p_target_kpa", *inputs)]
    refuse_other_data(fitted, which, settings["control"]["sample_rate_hz"], units)
    return fitted
