"""The command line: every command, its arguments and its help.

A command is imported when it runs, so that the help appears at once.
"""

import argparse
from functools import partial
from pkgutil import resolve_name
from typing import Any

from fprc import __version__
from fprc.paper import EXPERIMENTS

_ABOUT = """\
Hysteresis compensation by pneumatic physical reservoir computing.
`snakemake --cores 2 all` makes the tables and figures of the paper.

to begin:
  fprc simulate sweep --out sweep.h5
  fprc train sweep.h5 --out model.h5
  fprc predict model.h5 sweep.h5 --out predicted.csv
"""

#: The first words of commands of two words, and what these commands do.
_GROUPS = {
    "log": "Check or repair experiment logs",
    "config": "Check or explain the configuration",
    "rig": "Check and run the real rig",
}

Argument = tuple[str, dict[str, Any]]


def _arg(name: str, metavar: str | None, text: str, **settings: Any) -> Argument:
    return name, {"help": text, **({"metavar": metavar} if metavar else {}), **settings}


# fmt: off
_ON: dict[str, Any] = {"action": "store_true"}
_OUT: dict[str, Any] = {"required": True}
_MANY: dict[str, Any] = {"nargs": "+", "default": ()}
_FILES = "configuration, later files over earlier ones; by default config/config.yaml if it exists"
_CONFIG = _arg("--config", "FILE", _FILES, **_MANY)
_MODEL = _arg("model", "MODEL.h5", "model of `fprc train` or the workflow")
_SOURCE = _arg("source", "SOURCE", "recording: text, MATLAB, HDF5, Excel or others")

#: Name, function as ``module:function``, help with examples, arguments of each command.
COMMANDS: list[tuple[str, str, str, list[Argument]]] = [
    ("simulate", "commands.models:simulate", """Simulate an experiment and write its raw log.

          fprc simulate sweep --out sweep.h5
          fprc simulate complex --seed 2 --rig viscous --out complex.h5""", [
        _arg("experiment", None, "sweep trains, complex tests", choices=EXPERIMENTS),
        _arg("--seed", None, "seed of the sensors and their noise", type=int),
        _arg("--rig", "NAME", "simulated rig"),
        _CONFIG,
        _arg("--out", "FILE.h5", "raw log to write", **_OUT),
    ]),
    ("train", "commands.models:train", """Train a model on raw logs.

        Keeps the model of the best fold of a cross-validation, as in Table II, and
        prints its training and validation error.

          fprc train sweep.h5 --out model.h5
          fprc train monday.h5 tuesday.h5 --model fuzzy_linear --out model.h5""", [
        _arg("logs", "LOG.h5", "raw log; several train together", nargs="+"),
        _arg("--model", "NAME", "esn, fprc (the default), fuzzy_linear or one of models.others",
             default="fprc"),
        _arg("--seed", None, "seed of folds and clusters", type=int),
        _CONFIG,
        _arg("--out", "MODEL.h5", "model to write", **_OUT),
    ]),
    ("predict", "commands.models:predict", """Compute the pressure P_ff of a model for a raw log.

        Prints the error against the log's P_exp. The table has the time, the inputs of
        the model, P_exp (`p_target_kpa`) and P_ff.

          fprc predict model.h5 complex.h5 --out predicted.csv""", [
        _MODEL,
        _arg("raw", "LOG.h5", "raw log"),
        _CONFIG,
        _arg("--out", "FILE.csv", "table to write", **_OUT),
    ]),
    ("export", "commands.models:export", """Turn a trained model into C code for a controller.

        Writes an FPRC or Fuzzy-linear as one C99 header without memory allocation.
        docs/deploy.md shows its use.

          fprc export model.h5 --c fprc_model.h
          fprc export results/models/sweep_fprc.h5 --c fprc_model.h --learn""", [
        _MODEL,
        _arg("--c", "NAME.h", "header to write; every name in it begins with NAME", **_OUT),
        _arg("--learn", None, "let it learn on the controller, as control.feedforward says", **_ON),
        _CONFIG,
    ]),
    ("import", "recordings.import_recording:import_or_draft", """Turn a recording into a raw log.

        Says what is doubtful in it, and draws it. docs/own-data.md describes the map.

          fprc import arm.csv --draft > arm.yaml
          fprc import arm.csv --map arm.yaml --out sweep.h5""", [
        _SOURCE,
        _arg("--draft", None, "print a map that is guessed from the file, and exit", **_ON),
        _arg("--map", "MAP.yaml", "columns, units, clock and sample rate", dest="map_"),
        _arg("--out", "FILE.h5", "raw log to write"),
    ]),
    ("log check", "commands.files:check_logs", """Check raw logs and say what is wrong with them.

        With the default limits. Exit code 1: a log cannot be used, or a check fails.

          fprc log check sweep.h5 complex.h5""", [_arg("paths", "FILE.h5", "raw log", nargs="+")]),
    ("log repair", "commands.files:repair", """Recover a raw log from the journal of a run.

        Prints what is lost. Exit code 0: nothing is lost; 3: some is, or may be; 1:
        nothing is readable.

          fprc log repair sweep.journal --out sweep.h5""", [
        _arg("source", "FILE.journal", "journal; it is not changed"),
        _arg("--out", "COPY.h5", "raw log to write", **_OUT),
    ]),
    ("readout", "recordings.readout:report_readout", """Say whether P_o is worth a second sensor.

        Compares the best model of theta alone with the best one that also has P_o.
        docs/own-data.md describes the map and the answer. Writes `report.md`,
        `readout/answer.json` (every number) and two logs for the workflow.

          fprc readout recording.csv --map map.yaml --out results/mine""", [
        _SOURCE,
        _arg("--map", "MAP.yaml", "columns, units and parts", dest="map_", **_OUT),
        _arg("--out", "FOLDER", "folder to write; by default results/ and SOURCE's name"),
        _arg("--config", "FILE", "configuration; later files override earlier ones", **_MANY),
    ]),
    ("config check", "commands.files:check_config", """Check configuration files, merged in order.

          fprc config check config/config.yaml mine.yaml""", [
        _arg("files", "FILE", "configuration, YAML", nargs="+"),
    ]),
    ("config defaults", "config.load:defaults", "Print config/config.yaml.", []),
    ("config reference", "config.load:reference", "Print docs/configuration.md.", []),
    ("config rig", "commands.files:show_rig", "Print the parameters of a fitted rig.", [
        _arg("name", "NAME", "name of the rig; by default that of the defaults", nargs="?"),
    ]),
    ("calibrate", "commands.calibrate:calibrate_from_files", """Fit the simulated rig to the paper.

        From the ranges of its parameters, in up to an hour; docs/rigs.md says how.

          fprc calibrate
          fprc calibrate mine.yaml --out config/rigs/mine.yaml""", [
        _arg("files", "FILE", _FILES, nargs="*", default=()),
        _arg("--out", "FILE.yaml", "parameter file, by default config/rigs/fitted.yaml",
             default="config/rigs/fitted.yaml"),
        _arg("--ensemble", "FILE.json", "write 40 rigs around that of the configuration instead"),
    ]),
    ("rig check", "apparatus.command:check", """Check valves and sensors one by one.

          fprc rig check --config config/config.yaml config/bench.yaml
          fprc rig check --armed --config config/config.yaml config/bench.yaml""", [
        _arg("--armed", None, "let the valves move; otherwise only the sensors are checked", **_ON),
        _CONFIG,
    ]),
    ("rig run", "apparatus.command:run", """Run one experiment and write its raw log.

        Unless armed, prints what would be run, and ends with exit code 1.

          fprc rig run list
          fprc rig run sweep --armed --config config/config.yaml config/bench.yaml""", [
        _arg("name", "EXPERIMENT", "experiment to run; `list` prints their names"),
        _arg("--out", "FILE.h5", "raw log to write; by default EXPERIMENT.h5 in folders.raw"),
        _arg("--model", "MODEL.h5", "model of the run; by default that in the results folder"),
        _arg("--armed", None, "let the valves move", **_ON),
        _CONFIG,
    ]),
]
# fmt: on


def parser() -> argparse.ArgumentParser:
    """Return the parser of the command line.

    After parsing, ``run`` of the namespace is a function that takes it and runs the command.
    """
    shown: dict[str, Any] = {"formatter_class": argparse.RawDescriptionHelpFormatter}
    top = argparse.ArgumentParser("fprc", description=_ABOUT, **shown)
    top.add_argument("--version", action="version", version=f"fprc {__version__}")
    top.set_defaults(run=lambda _: top.print_help())
    groups: dict[str, Any] = {"": top.add_subparsers(title="commands", metavar="COMMAND")}
    for words, run, text, arguments in COMMANDS:
        group, _, name = words.rpartition(" ")
        if group not in groups:
            first = groups[""].add_parser(group, help=_GROUPS[group], description=_GROUPS[group])
            groups[group] = first.add_subparsers(title="verbs", required=True)
        about = text.replace("\n        ", "\n")
        summary = about.partition("\n")[0].removesuffix(".")
        command = groups[group].add_parser(name, help=summary, description=about, **shown)
        command.set_defaults(run=partial(_call, run))
        for argument, settings in arguments:
            command.add_argument(argument, **settings)
    return top


def _call(run: str, options: argparse.Namespace) -> int:
    """Call a function with the options; print the text, or return the exit code, that it gives."""
    given = {key: value for key, value in vars(options).items() if key != "run"}
    answer = resolve_name(f"fprc.{run}")(**given)
    if isinstance(answer, str):
        print(answer, end="")
    return answer if isinstance(answer, int) else 0
