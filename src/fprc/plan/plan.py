"""The workflow's plan: the results, what they are made of, and which of them the logs allow."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

from fprc.channels import CHANNELS
from fprc.config import Settings
from fprc.errors import LogError
from fprc.escape import in_words
from fprc.logs import Columns, read_columns
from fprc.logs.columns import read_each
from fprc.paper import DISTURBANCE, EXPERIMENTS, LOOPS, REFERENCES, run_log
from fprc.registry import controllers, entries, feedforward_of, outside_classes

#: The experiment that trains the models, of which recorded logs may be several: ``sweep_2``, ...
TRAINING = EXPERIMENTS[0]


class Need(NamedTuple):
    """What a result is made from."""

    logs: tuple[str, ...] = ()  #: raw logs that it needs
    channels: tuple[str, ...] = ()  #: channels that each of these logs must have
    on_rigs: str = ""  #: why it needs a simulated rig, if it does


_P_O = ("p_o_kpa",)

#: By the target of the workflow; a result that is not listed needs none.
NEEDS = {
    "table2": Need(EXPERIMENTS),
    "table3": Need(EXPERIMENTS),
    "timing": Need(EXPERIMENTS),
    "seeds": Need(on_rigs="needs source: sim: further seeds are further simulated rigs"),
    "claims": Need(on_rigs="needs source: sim: the verdicts are taken over further simulated rigs"),
    "fig4": Need(EXPERIMENTS),
    "fig5": Need(EXPERIMENTS, _P_O),
    "fig8": Need(EXPERIMENTS, _P_O),
    "fig9": Need(EXPERIMENTS[:1], _P_O),
    "fig10": Need(EXPERIMENTS),
    "fig11": Need(EXPERIMENTS, _P_O),
    **{
        f"fig{number}": Need((run_log(reference, "fprc"), run_log(reference, "fprc_pd")))
        for number, reference in enumerate(REFERENCES, start=12)
    },
    "fig16": Need(tuple(run_log(name, loop) for name in LOOPS for loop in ("pd", "fprc_pd"))),
    "fig17": Need((run_log(DISTURBANCE, "fprc_pd"),), ("p_i_kpa", "p_o_kpa", "phi_deg")),
}

_TITLES = {
    **{f"table{n}": f"Table {roman}" for n, roman in enumerate(("I", "II", "III", "IV"), start=1)},
    "timing": "Execution times",
    "seeds": "Tables II to IV over further seeds",
}


def title_of_result(target: str) -> str:
    """Return a result's name for readers."""
    return _TITLES.get(target, target.capitalize().replace("Fig", "Fig. "))


@dataclass(frozen=True)
class Plan:
    """Models and runs of the workflow, and the results that cannot be made."""

    settings: Settings  #: the whole configuration
    existing: Mapping[str, Columns]  #: the existing raw logs, without samples, by name

    @cached_property
    def section_models(self) -> dict[str, Any]:
        """The section ``models``, as the registry takes it."""
        return self.settings.models.model_dump(mode="json")

    @property
    def on_simulated_rig(self) -> bool:
        """Whether the rig is simulated, so that there can be further rigs."""
        return self.settings.source == "sim"

    @property
    def records(self) -> bool:
        """Whether the workflow records logs."""
        return self.settings.source != "recorded"

    @cached_property
    def controllers(self) -> list[str]:
        """Controllers of the closed-loop runs."""
        return controllers(self.section_models)

    @cached_property
    def every_run(self) -> list[str]:
        """Logs of every closed-loop run."""
        references = (*REFERENCES, DISTURBANCE)
        return [run_log(name, loop) for loop in self.controllers for name in references]

    @cached_property
    def every_log(self) -> list[str]:
        """Names of all raw logs that the results need."""
        return [*EXPERIMENTS, *self.every_run]

    @cached_property
    def further(self) -> list[str]:
        """Names of the training logs beside ``sweep``, in order."""
        return sorted(filter(_is_further, self.existing), key=lambda name: (len(name), name))

    @cached_property
    def contents(self) -> dict[str, Columns]:
        """The raw logs that exist or will be recorded, without samples, by name."""
        logs = {name: self.existing[name] for name in self.every_log if name in self.existing}
        has_phi = self.on_simulated_rig or self.settings.hardware.phi
        lacking = set() if has_phi else {"phi_deg"}
        channels = frozenset(channel.name for channel in CHANNELS) - lacking
        source = {"source": self.settings.source}
        for name in self.every_log if self.records else ():
            if self.on_simulated_rig or name not in logs:
                logs[name] = Columns(Path(self.log(name)), {}, source, names=channels)
        return logs

    @cached_property
    def experiments(self) -> list[str]:
        """Hysteresis experiments whose logs exist or will be recorded."""
        return [name for name in EXPERIMENTS if name in self.contents]

    @cached_property
    def runs(self) -> list[str]:
        """Closed-loop runs whose logs exist or will be recorded."""
        return [run for run in self.every_run if run in self.contents]

    @cached_property
    def unavailable(self) -> dict[str, str]:
        """Results that cannot be made, with their reasons."""
        reasons = {name: self._why_not(need) for name, need in NEEDS.items()}
        if not self.runs:
            every = self.log(run_log("*", "*"))
            reasons["table4"] = f"needs closed-loop logs {every}; there is none"
        if not self.on_simulated_rig:
            reasons |= {name: need.on_rigs for name, need in NEEDS.items() if need.on_rigs}
        return {name: reason for name, reason in reasons.items() if reason}

    def _why_not(self, need: Need) -> str | None:
        """Return why a result cannot be made from the logs; None if it can."""
        logs = self.contents
        absent = [f"{name}.h5" for name in need.logs if name not in logs]
        if absent:
            return f"needs {in_words(absent)} in {self.settings.folders.raw}"
        lacking = [
            f"{channel} in {name}.h5"
            for name in need.logs
            for channel in need.channels
            if channel not in logs[name].names
        ]
        return f"needs {in_words(lacking)}" if lacking else None

    @property
    def _results(self) -> str:
        return self.settings.folders.results

    def log(self, name: str) -> str:
        """Return the file of a raw log."""
        return f"{self.settings.folders.raw}/{name}.h5"

    def judged(self, experiment: str, model: str) -> dict[str, str]:
        """Return the files of ``fprc.stages.models.judge``, by its arguments, for one log."""
        return {
            "errors": f"{self._results}/crossval/{experiment}_{model}.json",
            "fitted": f"{self._results}/models/{experiment}_{model}.h5",
            "fits": f"{self._results}/predictions/{experiment}_{model}_train.h5",
            "predictions": f"{self._results}/predictions/{experiment}_{model}_test.h5",
        }

    def possible(self, **files: list[str]) -> dict[str, list[str]]:
        """Return those of the results, named with their files, that can be made."""
        return {name: made for name, made in files.items() if name not in self.unavailable}

    def refusal(self, target: str) -> str:
        """Return the message on a target that cannot be made."""
        why = f"{title_of_result(target)} {self.unavailable[target]}"
        return f"{target}: not available for this data: {why}"

    @cached_property
    def left_out(self) -> dict[str, str]:
        """Models that are not in the tables, with their reasons."""
        if "table2" in self.unavailable:
            return {}
        needed = entries(self.section_models).items()
        reasons = {model: self._why_not(Need(EXPERIMENTS, entry.inputs)) for model, entry in needed}
        return {model: reason for model, reason in reasons.items() if reason}

    @cached_property
    def models(self) -> list[str]:
        """The models whose inputs are in the logs."""
        return [name for name in entries(self.section_models) if name not in self.left_out]

    @cached_property
    def feedforward(self) -> list[str]:
        """The models that drive the closed loops."""
        models = (feedforward_of(name) for name in self.controllers)
        return list(dict.fromkeys(name for name in models if name))

    def source_of(self, target: str) -> str:
        """Return the source of the data that a figure shows; ``none`` if it shows none."""
        logs = NEEDS[target].logs if target in NEEDS else ()
        return self.contents[logs[0]].attributes.get("source", "none") if logs else "none"

    def replicates(self, part: str) -> list[str]:
        """Return one part of each further seed's report."""
        seeds = self.settings.evaluation.replicate_seeds
        return [f"{self._results}/replicates/{part}_{seed}.json" for seed in seeds]

    @property
    def grids(self) -> list[str]:
        """Reports that Figs. 10 and 11 show: of further seeds, or of the logs of one rig."""
        if self.on_simulated_rig:
            return self.replicates("grids")
        return [f"{self._results}/grids.json"]

    def logs_of(self, experiment: str) -> list[str]:
        """Return the raw logs of an experiment."""
        further = self.further if experiment == TRAINING else []
        return [self.log(name) for name in (experiment, *further)]

    @property
    def data(self) -> list[str]:
        """Raw and preprocessed logs of the experiments."""
        logs = self.experiments
        raw = [file for log in logs for file in self.logs_of(log)]
        return [*raw, *(f"{self._results}/data/{name}.h5" for name in logs)]


def read_plan(settings: Settings) -> Plan:
    """Return the plan for the raw logs that exist.

    Raises
    ------
    ConfigError
        A class of ``models.others`` is no model.
    LogError
        Names every log that cannot be read or that has another source than ``source`` says; or
        there is none to use.
    """
    outside_classes(settings.models.model_dump())
    raw, empty = Path(settings.folders.raw), Plan(settings, {})
    names = [name for name in empty.every_log if (raw / f"{name}.h5").exists()]
    if not empty.records:
        names += [path.stem for path in raw.glob("*.h5") if _is_further(path.stem)]
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


def _is_further(log: str) -> bool:
    return re.fullmatch(rf"{TRAINING}_([2-9]|[1-9]\d+)", log) is not None
