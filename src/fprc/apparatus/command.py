"""`fprc rig`: the experiments on the real rig by name, and how they are started."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from fprc import __version__, registry
from fprc.apparatus.guardian import guard
from fprc.artifacts import refuse_output
from fprc.channels import unit_of
from fprc.config import from_files
from fprc.config.settings import Control, Signal, Tracking
from fprc.control import Law, hysteresis_law
from fprc.errors import ConfigError, ControlError
from fprc.escape import in_words
from fprc.paper import DISTURBANCE, EXPERIMENTS, reference_and_controller, run_log
from fprc.signals import pressure_command


def check(*, armed: bool = False, config: Sequence[str] = ()) -> None:
    """Check valves and sensors one by one."""
    settings = from_files(config).model_dump(mode="json")
    guard({"what": "check", "settings": settings, "armed": armed})


def run(
    name: str,
    *,
    out: str | None = None,
    model: str | None = None,
    armed: bool = False,
    config: Sequence[str] = (),
) -> str:
    """Run one experiment and write its raw log."""
    settings = from_files(config).model_dump(mode="json")
    if name == "list":
        return "\n".join(_names(settings)) + "\n"
    _refuse_unknown(name, settings)
    folders = settings["folders"]
    trained = f"{folders['results']}/models/sweep_{registry.model_of_run(name)}.h5"
    model = model or (trained if Path(trained).exists() else "")
    raw = out or f"{folders['raw']}/{name}.h5"
    record(raw, name=name, settings=settings, armed=armed, model=model)
    return ""


def record(
    raw: str, *, name: str, settings: Mapping[str, Any], armed: bool, model: str = ""
) -> None:
    """Run one experiment on the real rig and write its raw log.

    FprcError: the log exists, or cannot be written. ControlError: not armed, or the run was
    stopped; names the experiment, or the file of its samples. Others are those of ``plan``.
    """
    refuse_output(raw, ".h5")
    plan(name, settings, model)  # refuses what the process would refuse, before it starts
    if not armed:
        limits = settings["hardware"]["limits"]
        raise ControlError(
            f"{name}: not armed, nothing was moved; would write {raw}, and stop above "
            f"{limits['p_exp_kpa'][1]:g} kPa in the actuator, {limits['p_i_kpa'][1]:g} kPa in PAM "
            "A; inspect the rig, run `fprc rig check --armed`, then give --armed (fprc rig run) or "
            "--config armed=true (snakemake)"
        )
    run = {"name": name, "raw": raw, "model": model}
    guard({"what": "run", "settings": dict(settings), "run": run})


def _names(settings: Mapping[str, Any]) -> list[str]:
    references, laws = settings["tracking"]["references"], registry.controllers(settings["models"])
    return [*EXPERIMENTS, *(run_log(reference, law) for reference in references for law in laws)]


def _refuse_unknown(name: str, settings: Mapping[str, Any]) -> None:
    if name not in (known := _names(settings)):
        raise ConfigError(f"no experiment {name}; must be one of {', '.join(known)}")


class Experiment(NamedTuple):
    """Experiment on the real rig, and what its log has."""

    law: Law  #: see ``fprc.control.run``
    samples: int
    attributes: dict[str, Any]
    extra: tuple[str, ...]  #: channels that the law returns after the setpoints
    hint: str  #: what the user at the rig must do, after a semicolon


def plan(name: str, settings: Mapping[str, Any], model: str = "") -> Experiment:
    """Return the experiment of that name, with the model in a file if it needs one.

    FprcError: there is no such experiment, its commands are beyond ``hardware.limits``, or its
    reference is impossible; the model is missing, was changed, is another than the experiment's, or
    was trained at another rate or in other units.
    """
    _refuse_unknown(name, settings)
    control, extra, hint = Control(**settings["control"]), tuple[str, ...](), ""
    if name in EXPERIMENTS:
        signal = Signal(**settings["experiments"][name])
        p_exp_kpa = pressure_command(signal, control.sample_rate_hz)
        law, samples = hysteresis_law(p_exp_kpa, control), len(p_exp_kpa)
        highest_kpa = {"p_exp_kpa": p_exp_kpa.max(), "p_i_kpa": control.reservoir_limit_kpa}
        attributes = {
            "experiment": name,
            "sample_rate_hz": control.sample_rate_hz,
            "seed": settings["seed"],
            "rig": {"control": settings["control"], "signal": settings["experiments"][name]},
        }
    else:
        # imported here because it takes a second, for which the other experiments need not wait
        from fprc.experiments.tracking import Track, describe_model

        tracking = Tracking(**settings["tracking"])
        bench = Track(tracking, control, {}, settings["seed"])
        reference, controller = reference_and_controller(name)
        theta_d, fitted = bench.reference(reference), None
        attributes, extra = bench.describe(reference, controller), bench.channels(controller)
        driver = registry.feedforward_of(controller)
        if driver and model:  # without a file the law refuses to start
            fitted = _load(model, name, driver, settings)
            attributes |= describe_model(fitted, model)
        law, samples = bench.law(theta_d, controller, fitted), len(theta_d)
        p_i_kpa = control.k_in_kpa_per_deg * theta_d.max()
        highest_kpa = {"p_exp_kpa": tracking.pressure_limit_kpa, "p_i_kpa": p_i_kpa}
        if reference == DISTURBANCE:
            hint = f"; push the reservoir by hand from {tracking.pushes.quiet_s:g} s on"
    for sensor, kpa in highest_kpa.items():
        if kpa > (limit := settings["hardware"]["limits"][sensor][1]):  # its reading ends the run
            raise ConfigError(
                f"commands go up to {kpa:g} kPa, and a reading above {limit:g} ends a run "
                f"(hardware.limits.{sensor}); lower the amplitude, tracking.pressure_limit_kpa or "
                "control.reservoir_limit_kpa"
            )
    rig = {"hardware": settings["hardware"], **attributes["rig"]}
    attributes |= {"source": "rig", "software": f"fprc {__version__}", "rig": rig}
    return Experiment(law, samples, attributes, extra, hint)


def _load(file: str, name: str, driver: str, settings: Mapping[str, Any]) -> Any:
    """Load the model of an experiment, and check that it is the one in the name."""
    from fprc.experiments.data import refuse_other_data
    from fprc.models import load_model

    models, which = settings["models"], f"{file}, the model of {name}"
    inputs, needed = registry.entries(models)[driver].inputs, registry.load_class(driver, models)
    fitted = load_model(file, registry.outside_classes(models))
    columns = getattr(fitted, "n_features_in_", 0)  # a part of a model may have none
    if type(fitted) is not needed or columns != len(inputs):
        raise ConfigError(
            f"{which}, is a {type(fitted).__name__} of {columns} inputs, must be a "
            f"{needed.__name__} of {len(inputs)}, {in_words(inputs)}; train it again, give another "
            "--model, or choose the experiment that is named after it"
        )
    units = [unit_of(channel) for channel in ("p_target_kpa", *inputs)]
    refuse_other_data(fitted, which, settings["control"]["sample_rate_hz"], units)
    return fitted
