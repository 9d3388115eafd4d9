"""What the rules pass to their stages: a stage gets only the settings that it reads."""

from collections.abc import Mapping
from typing import Any

from fprc.registry import settings_of

Settings = Mapping[str, Any]


def pick(section: Settings, *names: str) -> dict[str, Any]:
    """Return some keys of a section."""
    return {name: section[name] for name in names}


def paper_models(settings: Settings) -> dict[str, Any]:
    """Return the section ``models`` without the models from outside the package."""
    return {**settings["models"], "others": {}}


def validation(
    settings: Settings, model: str | None = None, *, without: str = "", **changed: Any
) -> dict[str, Any]:
    """Return the arguments of ``CrossValidation`` for one model, or for all of them.

    ``without`` is an argument that the stage adds itself; ``changed`` differ from the settings.
    """
    models = settings_of(model, settings["models"]) if model else settings["models"]
    how = pick(settings["evaluation"], "folds", "split", "purge_s") | pick(settings, "seed")
    arguments = {"models": models, **how, **changed}
    return {name: value for name, value in arguments.items() if name != without}


def of_pressures(settings: Settings) -> dict[str, Any]:
    """Return the section ``control`` without what tracks an angle."""
    tracks = ("feedback", "pd", "feedforward")
    return {name: value for name, value in settings["control"].items() if name not in tracks}


def feedback_in_words(settings: Settings) -> str:
    """Return a sentence on the PD controller, for the notes of tables."""
    if settings["source"] == "recorded":
        return "The controllers are those of the logs."
    control = settings["control"]
    kp, kd = control["pd"].values()
    law = {"positional": "=", "incremental": "is the running sum of"}[control["feedback"]]
    return f"PD: P_fb {law} kp e + kd de/dt, with {kp:g} kPa/deg and {kd:g} kPa s/deg."


def on_rig(settings: Settings) -> dict[str, Any]:
    """Return the arguments of ``RigSettings``."""
    return {
        **pick(settings, "rig", "control"),
        "signals": settings["experiments"],
        "target": settings["evaluation"]["target"],
    }
