"""The results, what they are made of, which of them the logs allow; the settings of each stage."""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from fprc import registry
from fprc.channels import CHANNELS
from fprc.config import Settings
from fprc.errors import LogError
from fprc.escape import in_words
from fprc.logs import Columns, read_columns
from fprc.logs.columns import read_each
from fprc.paper import DISTURBANCE, EXPERIMENTS, LOOPS, REFERENCES, run_log

#: Settings as plain data, of which a stage gets only what it reads.
Plain = Mapping[str, Any]


#: Raw logs that a result is made from, and channels that each of them must have, by the target of
#: the workflow; a result that is not listed needs none.
NEEDS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    **dict.fromkeys(("table2", "table3", "timing", "fig4", "fig10"), (EXPERIMENTS, ())),
    **dict.fromkeys(("fig5", "fig8", "fig11"), (EXPERIMENTS, ("p_o_kpa",))),
    "fig9": (EXPERIMENTS[:1], ("p_o_kpa",)),
    **{
        f"fig{number}": ((run_log(reference, "fprc"), run_log(reference, "fprc_pd")), ())
        for number, reference in enumerate(REFERENCES, start=12)
    },
    "fig16": (tuple(run_log(name, loop) for name in LOOPS for loop in ("pd", "fprc_pd")), ()),
    "fig17": ((run_log(DISTURBANCE, "fprc_pd"),), ("p_i_kpa", "p_o_kpa", "phi_deg")),
}

#: Why some results need a simulated rig.
_ON_RIGS = {
    "seeds": "needs source: sim: further seeds are further simulated rigs",
    "claims": "needs source: sim: the verdicts are taken over further simulated rigs",
}

_TITLES = {
    **{f"table{n}": f"Table {roman}" for n, roman in enumerate(("I", "II", "III", "IV"), start=1)},
    "timing": "Execution times",
    "seeds": "Tables II to IV over further seeds",
}


def title_of_result(target: str) -> str:
    """Return a result's name for readers."""
    return _TITLES.get(target, target.capitalize().replace("Fig", "Fig. "))


class Plan:
    """Models, runs and files of the workflow, and the results that cannot be made.

    ``existing`` are the raw logs that exist, without samples, by name.
    """

    def __init__(self, settings: Settings, existing: Mapping[str, Columns]) -> None:
        self.settings, self.existing = settings, existing
        self._raw, self._results = settings.folders.raw, settings.folders.results
        section = settings.models.model_dump(mode="json")
        #: Whether the rig is simulated, so that there can be further rigs.
        self.on_simulated_rig = settings.source == "sim"
        #: Whether the workflow records logs.
        self.records = settings.source != "recorded"
        #: Controllers of the closed-loop runs, and the models that drive them.
        self.controllers = registry.controllers(section)
        driving = map(registry.feedforward_of, self.controllers)
        self.feedforward = list(dict.fromkeys(filter(None, driving)))
        #: Logs of every closed-loop run, and of all that the results need.
        references = (*REFERENCES, DISTURBANCE)
        self.every_run = [run_log(name, loop) for loop in self.controllers for name in references]
        self.every_log = [*EXPERIMENTS, *self.every_run]
        #: Names of the training logs beside ``sweep`` among recorded logs: ``sweep_2``, ...
        self.further = sorted(set(existing) - {*self.every_log}, key=lambda name: (len(name), name))
        #: Channels of the raw logs that exist or will be recorded, by the log's name.
        self.contents = {name: existing[name].names for name in self.every_log if name in existing}
        if self.records:
            measured = {channel.name for channel in CHANNELS}
            if not self.on_simulated_rig and not settings.hardware.phi:
                measured.remove("phi_deg")
            kept = {} if self.on_simulated_rig else self.contents
            self.contents = dict.fromkeys(self.every_log, frozenset(measured)) | kept
        #: Hysteresis experiments and closed-loop runs whose logs exist or will be recorded.
        self.experiments = [name for name in EXPERIMENTS if name in self.contents]
        self.runs = [run for run in self.every_run if run in self.contents]
        reasons = {name: self._why_not(*need) for name, need in NEEDS.items()}
        if not self.on_simulated_rig:
            reasons |= _ON_RIGS
        if not self.runs:
            every = self.log(run_log("*", "*"))
            reasons["table4"] = f"needs closed-loop logs {every}; there is none"
        #: Results that cannot be made, with their reasons.
        self.unavailable = {name: reason for name, reason in reasons.items() if reason}
        #: Models that are not in the tables, with their reasons, and those that are.
        needed = {} if "table2" in self.unavailable else registry.entries(section)
        lacks = {name: self._why_not(EXPERIMENTS, of.inputs) for name, of in needed.items()}
        self.left_out = {name: reason for name, reason in lacks.items() if reason}
        self.models = [name for name in registry.entries(section) if name not in self.left_out]

    def _why_not(self, logs: Sequence[str], channels: Sequence[str]) -> str:
        """Return why a result cannot be made from the logs; nothing if it can."""
        missing = [f"{log}.h5" for log in logs if log not in self.contents]
        if missing:
            return f"needs {in_words(missing)} in {self._raw}"
        lacking = [
            f"{channel} in {log}.h5"
            for log in logs
            for channel in channels
            if channel not in self.contents[log]
        ]
        return f"needs {in_words(lacking)}" if lacking else ""

    def log(self, name: str) -> str:
        """Return the file of a raw log."""
        return f"{self._raw}/{name}.h5"

    def logs_of(self, experiment: str) -> list[str]:
        """Return the raw logs of an experiment."""
        further = self.further if experiment == "sweep" else []
        return [self.log(name) for name in (experiment, *further)]

    @property
    def data(self) -> list[str]:
        """Raw and preprocessed logs of the experiments."""
        raw = [file for log in self.experiments for file in self.logs_of(log)]
        return [*raw, *(f"{self._results}/data/{name}.h5" for name in self.experiments)]

    def judged(self, experiment: str, model: str) -> dict[str, str]:
        """Return the files of ``fprc.stages.models.judge``, by its arguments, for one log."""
        predictions = f"{self._results}/predictions/{experiment}_{model}"
        return {
            "errors": f"{self._results}/crossval/{experiment}_{model}.json",
            "fitted": f"{self._results}/models/{experiment}_{model}.h5",
            "fits": f"{predictions}_train.h5",
            "predictions": f"{predictions}_test.h5",
        }

    def driver(self, log: str) -> list[str]:
        """Return the file of the model that a raw log is recorded with; an experiment has none."""
        model = registry.model_of_run(log)
        return [] if log in EXPERIMENTS else [self.judged("sweep", model)["fitted"]]

    def replicates(self, part: str) -> list[str]:
        """Return one part of each further seed's report; none where there is no further rig."""
        seeds = self.settings.evaluation.replicate_seeds if self.on_simulated_rig else ()
        return [f"{self._results}/replicates/{part}_{seed}.json" for seed in seeds]

    def table(self, name: str) -> list[str]:
        """Return the files of a table: numbers, and pages with title and note."""
        return [f"{self._results}/{name}.{kind}" for kind in ("csv", "md", "tex", "json")]

    def figure(self, name: str, *numbers: str) -> list[str]:
        """Return the files of a figure; with "csv" also the numbers that it shows."""
        return [f"{self._results}/figures/{name}.{kind}" for kind in ("pdf", "png", *numbers)]

    def possible(self, **files: list[str]) -> dict[str, list[str]]:
        """Return those of the results, named with their files, that can be made."""
        return {name: made for name, made in files.items() if name not in self.unavailable}

    def source_of(self, target: str) -> str:
        """Return the source of the data that a figure shows; ``none`` if it shows none."""
        logs, _ = NEEDS.get(target, ((), ()))
        if logs and logs[0] in self.existing and not self.on_simulated_rig:
            return str(self.existing[logs[0]].attributes.get("source", "none"))
        return self.settings.source if logs else "none"


def read_plan(settings: Settings) -> Plan:
    """Return the plan for the raw logs that exist.

    LogError names every log that cannot be read or has another source than ``source`` says.
    ConfigError: a class of ``models.others`` is no model.
    """
    registry.outside_classes(settings.models.model_dump())
    raw, empty = Path(settings.folders.raw), Plan(settings, {})
    names = [name for name in empty.every_log if (raw / f"{name}.h5").exists()]
    if not empty.records:
        further = re.compile(r"sweep_([2-9]|[1-9]\d+)")
        names += [path.stem for path in raw.glob("*.h5") if further.fullmatch(path.stem)]
    read = read_each(read_columns, [empty.log(name) for name in names], names=())
    plan = Plan(settings, dict(zip(names, read, strict=True)))
    wrong = [
        f"{log.path}: its source is not {settings.source}, so it is not overwritten; move it away, "
        "set folders.raw and folders.results to other folders, or use it by source: recorded"
        for log in plan.existing.values()
        if plan.records and (log.attributes.get("source") == "sim") != plan.on_simulated_rig
    ]
    if wrong:
        raise LogError("\n".join(wrong))
    if not plan.contents:
        raise LogError(
            f"source is recorded, but {raw} contains no raw log: put sweep.h5 and complex.h5 "
            "there, or set folders.raw; see docs/own-data.md"
        )
    return plan


def pick(section: Plain, *names: str) -> dict[str, Any]:
    """Return some keys of a section."""
    return {name: section[name] for name in names}


def paper_models(settings: Plain) -> dict[str, Any]:
    """Return the section ``models`` without the models from outside the package."""
    return {**settings["models"], "others": {}}


def validation(settings: Plain, model: str | None = None, **changed: Any) -> dict[str, Any]:
    """Return the arguments of ``CrossValidation`` for one model, or for all of them."""
    models = registry.settings_of(model, settings["models"]) if model else settings["models"]
    folds = pick(settings["evaluation"], "folds", "split", "purge_s")
    return {"models": models, **folds, "seed": settings["seed"], **changed}


def of_pressures(settings: Plain) -> dict[str, Any]:
    """Return the section ``control`` without what tracks an angle."""
    tracks = ("feedback", "pd", "feedforward")
    return {name: value for name, value in settings["control"].items() if name not in tracks}


def feedback_in_words(settings: Plain) -> str:
    """Return a sentence on the PD controller, for the notes of tables."""
    if settings["source"] == "recorded":
        return "The controllers are those of the logs."
    control = settings["control"]
    kp, kd = control["pd"].values()
    law = {"positional": "=", "incremental": "is the running sum of"}[control["feedback"]]
    return f"PD: P_fb {law} kp e + kd de/dt, with {kp:g} kPa/deg and {kd:g} kPa s/deg."


def on_rig(settings: Plain) -> dict[str, Any]:
    """Return the arguments of ``RigSettings``."""
    return {
        **pick(settings, "rig", "control"),
        "signals": settings["experiments"],
        "target": settings["evaluation"]["target"],
    }
