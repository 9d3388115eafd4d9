"""Every command of ``fprc`` with its arguments."""

import argparse
import sys
import textwrap
from functools import partial
from importlib import import_module
from typing import Any, NoReturn

from fprc import __version__
from fprc.paper import EXPERIMENTS, MODELS

_CONFIGURATION = (
    "configuration; later files override earlier ones (default: config/config.yaml if there is "
    "one, else the defaults)"
)
_WORKERS = "processes (default: one per processor)"


def parser() -> argparse.ArgumentParser:
    """Return the parser of the command line.

    After parsing, ``run`` of the namespace is a function that takes it and runs the command.
    """
    whole = argparse.ArgumentParser(
        prog="fprc",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        description=_folded(
            "Hysteresis compensation by pneumatic physical reservoir computing. "
            "`snakemake --cores 2 all` makes the tables and figures of the paper."
        ),
        epilog="examples:\n  fprc simulate sweep --out sweep.h5\n"
        "  fprc train sweep.h5 --out model.h5\n\n`fprc COMMAND --help` explains a command.",
    )
    whole.add_argument("--version", action="version", version=f"fprc {__version__}")
    whole.set_defaults(run=lambda _: whole.print_help())
    commands = _Commands(whole, "command")
    for add in (
        _add_simulate, _add_train, _add_predict, _add_export, _add_import, _add_log, _add_readout,
        _add_config, _add_calibrate, _add_rig, _add_completion,
    ):  # fmt: skip
        add(commands)
    return whole


def _folded(text: str) -> str:
    return textwrap.fill(text, 79, break_on_hyphens=False)


class _Commands:
    """The commands below a parser, or the verbs of a command."""

    def __init__(self, parser: argparse.ArgumentParser, kind: str) -> None:
        self._parsers = parser.add_subparsers(title=f"{kind}s", metavar=kind.upper())

    def group(self, name: str, what: str) -> "_Commands":
        """Add a command that has verbs, and return the place to add them."""
        group = self._parsers.add_parser(
            name, help=what, description=f"{what[0].upper()}{what[1:]}."
        )
        group.set_defaults(run=partial(_refuse_without_verb, group))
        return _Commands(group, "verb")

    def add(
        self, name: str, run: str, what: str, *examples: str, more: str = ""
    ) -> argparse.ArgumentParser:
        """Add a command.

        Parameters
        ----------
        run : str
            Its function in ``fprc.commands``, as ``module.function``; the options are its
            arguments.
        what : str
            What it does, for the list of commands.
        *examples : str
            Whole command lines.
        more : str
            What else it does, sentences.
        """
        command = self._parsers.add_parser(
            name,
            help=what,
            formatter_class=argparse.RawDescriptionHelpFormatter,
            description=_folded(f"{what[0].upper()}{what[1:]}. {more}"),
            epilog="\n  ".join([f"example{'s' * (len(examples) > 1)}:", *examples]),
        )
        command.set_defaults(run=partial(_call, run))
        return command


def _refuse_without_verb(group: argparse.ArgumentParser, _: argparse.Namespace) -> NoReturn:
    group.print_help(sys.stderr)
    group.exit(2, f"\n{group.prog}: error: a verb is missing\n")


def _call(name: str, options: argparse.Namespace) -> Any:
    """Import the function of a command and call it; `fprc --help` imports none."""
    module, _, function = name.partition(".")
    given = {key: value for key, value in vars(options).items() if key != "run"}
    return getattr(import_module(f"fprc.commands.{module}"), function)(**given)


def _add_simulate(commands: _Commands) -> None:
    simulate = commands.add(
        "simulate",
        "simulate.simulate",
        "simulate an experiment and write its raw log",
        "fprc simulate sweep --out sweep.h5",
        "fprc simulate complex --seed 2 --rig viscous --out complex.h5",
        more="The simulated rig performs a hysteresis experiment of the paper, as in `snakemake "
        "logs`.",
    )
    simulate.add_argument(
        "experiment", choices=EXPERIMENTS, help="the paper trains on sweep and tests on complex"
    )
    simulate.add_argument(
        "--seed", type=int, help="seed of sensors and noise (default: the configuration's, 1)"
    )
    simulate.add_argument(
        "--rig",
        metavar="NAME|FILE.yaml",
        help="simulated rig, or a file of `fprc calibrate` (default: the configuration's, dry)",
    )
    _add_config_option(simulate)
    simulate.add_argument("--out", metavar="FILE.h5", required=True, help="raw log to write")


def _add_train(commands: _Commands) -> None:
    train = commands.add(
        "train",
        "models.train",
        "train a model on raw logs",
        "fprc train sweep.h5 --out model.h5",
        "fprc train monday.h5 tuesday.h5 --model fuzzy_linear --out model.h5",
        more="Keeps the model of the best fold of a cross-validation, as in Table II, and prints "
        "its training and validation error.",
    )
    train.add_argument("logs", nargs="+", metavar="LOG.h5", help="raw log; several train together")
    train.add_argument(
        "--model",
        default="fprc",
        metavar="NAME",
        help=f"{', '.join(MODELS)}, or one of models.others in the configuration (default: "
        "%(default)s)",
    )
    train.add_argument(
        "--seed", type=int, help="seed of folds and clusters (default: the configuration's, 1)"
    )
    _add_config_option(train)
    train.add_argument("--out", metavar="MODEL.h5", required=True, help="model to write")


def _add_predict(commands: _Commands) -> None:
    predict = commands.add(
        "predict",
        "models.predict",
        "compute the pressure P_ff that a trained model gives for a raw log",
        "fprc predict model.h5 complex.h5 --out predicted.csv",
        more="Prints the error against the log's P_exp.",
    )
    predict.add_argument("model", metavar="MODEL.h5", help="model that `fprc train` wrote")
    predict.add_argument("raw", metavar="LOG.h5", help="raw log")
    _add_config_option(predict)
    predict.add_argument(
        "--out", metavar="FILE", required=True, help="table to write: FILE.csv or FILE.h5"
    )


def _add_config_option(command: argparse.ArgumentParser) -> None:
    command.add_argument("--config", nargs="+", metavar="FILE", default=[], help=_CONFIGURATION)


def _add_config(commands: _Commands) -> None:
    verbs = commands.group("config", "check or explain the configuration")
    check = verbs.add(
        "check",
        "configuration.check_files",
        "check configuration files, merged in this order",
        "fprc config check config/config.yaml mine.yaml",
    )
    check.add_argument("files", nargs="+", metavar="FILE", help="configuration, YAML")
    for name, what in (
        ("defaults", "print config/config.yaml"),
        ("schema", "print config/schema.json"),
        ("reference", "print docs/configuration.md"),
    ):
        page = verbs.add(name, "configuration.print_page", what, f"fprc config {name}")
        page.set_defaults(page=name)
    rig = verbs.add(
        "rig",
        "configuration.print_rig",
        "print the parameters of a fitted rig",
        "fprc config rig viscous",
    )
    rig.add_argument(
        "name", nargs="?", metavar="NAME", help="name of the rig (default: that of the defaults)"
    )
    verbs.add(
        "published",
        "configuration.print_published",
        "print the numbers of the paper, as YAML",
        "fprc config published",
    )


def _add_calibrate(commands: _Commands) -> None:
    calibrate = commands.add(
        "calibrate",
        "calibrate.calibrate_from_files",
        "fit the simulated rig to Tables II and III",
        "fprc calibrate",
        "fprc calibrate mine.yaml --minutes 20 --out config/rigs/mine.yaml",
        more="Fits the free parameters of the rig to the published numbers and writes a parameter "
        "file. Repeat the command to continue a search that was stopped.",
    )
    calibrate.add_argument("files", nargs="*", metavar="FILE", help=_CONFIGURATION)
    calibrate.add_argument(
        "--out",
        metavar="FILE.yaml",
        default="config/rigs/fitted.yaml",
        help="parameter file to write (default: %(default)s)",
    )
    calibrate.add_argument(
        "--published",
        metavar="FILE",
        help="numbers to fit (default: what `fprc config published` prints)",
    )
    calibrate.add_argument(
        "--minutes", type=float, help="time limit (default: the configuration's)"
    )
    calibrate.add_argument("--workers", type=int, help=_WORKERS)


def _add_import(commands: _Commands) -> None:
    importer = commands.add(
        "import",
        "import_recording.import_recording",
        "turn a CSV, HDF5 or MATLAB file into a raw log",
        "fprc import arm.csv --list",
        "fprc import arm.csv --map arm.yaml --out sweep.h5",
        more="Also diagnoses the recording. docs/own-data.md describes the map.",
    )
    importer.add_argument("source", metavar="SOURCE", help="recording: CSV, HDF5 or MATLAB file")
    importer.add_argument("--list", action="store_true", help="print the file's columns and exit")
    importer.add_argument("--map", metavar="MAP.yaml", help="columns, units, clock, rate")
    importer.add_argument("--out", metavar="FILE.h5", help="raw log to write")
    importer.set_defaults(run=partial(_import, importer))


def _import(importer: argparse.ArgumentParser, options: argparse.Namespace) -> None:
    from fprc.commands.import_recording import import_recording, list_source

    if options.list:
        list_source(options.source, options.map)
    elif options.map and options.out:
        import_recording(options.source, options.map, options.out)
    else:
        importer.error("give --list, or both --map and --out")


def _add_rig(commands: _Commands) -> None:
    verbs = commands.group("rig", "check and run the real rig")
    check = verbs.add(
        "check",
        "rig.check",
        "check valves and sensors one by one",
        "fprc rig check",
        "fprc rig check --armed",
    )
    experiment = verbs.add(
        "run",
        "rig.run_by_name",
        "run one experiment and write its raw log",
        "fprc rig run list",
        "fprc rig run sweep --armed",
    )
    experiment.add_argument(
        "name", metavar="EXPERIMENT", help="experiment to run; `list` prints their names"
    )
    experiment.add_argument(
        "--out",
        dest="raw",
        metavar="FILE.h5",
        help="raw log to write (default: EXPERIMENT.h5 in folders.raw)",
    )
    experiment.add_argument(
        "--model",
        metavar="MODEL.h5",
        help="fitted model of the experiment's name (default: that in the results folder)",
    )
    for verb in (check, experiment):
        verb.add_argument("--armed", action="store_true", help="let the valves move")
        verb.add_argument(
            "--config", dest="files", nargs="+", metavar="FILE", default=[], help=_CONFIGURATION
        )


def _add_readout(commands: _Commands) -> None:
    readout = commands.add(
        "readout",
        "readout.report_readout",
        "measure how much the readout P_o of a recording improves FPRC",
        "fprc readout recording.csv --map map.yaml --out results/mine",
        more="Imports a recording, trains FPRC with and without P_o and other models on its first "
        "part, tests on its second, and writes a report with verdicts. The map gives test_from_s; "
        "docs/own-data.md describes it. Repeat the command to continue a run that was stopped.",
    )
    readout.add_argument("source", metavar="SOURCE", help="recording: CSV, HDF5 or MATLAB file")
    readout.add_argument(
        "--map", dest="map_file", required=True, metavar="MAP.yaml", help="columns, units, parts"
    )
    readout.add_argument(
        "--train",
        nargs="+",
        default=[],
        metavar="FILE",
        help="further recordings with the same columns, used for training only",
    )
    readout.add_argument(
        "--out", metavar="FOLDER", help="folder to write (default: results/ and SOURCE's name)"
    )
    readout.add_argument(
        "--config", nargs="+", default=[], metavar="FILE", help="configuration; later files win"
    )
    readout.add_argument("--workers", type=int, help=_WORKERS)


def _add_export(commands: _Commands) -> None:
    export = commands.add(
        "export",
        "export.export_c",
        "turn a trained model into C code for a controller",
        "fprc export model.h5 --c fprc_model.h",
        "fprc export results/models/sweep_fprc.h5 --c fprc_model.h --float",
        more="Writes an FPRC or Fuzzy-linear as one C99 header without memory allocation. "
        "docs/deploy.md shows its use.",
    )
    export.add_argument("model", metavar="MODEL.h5", help="model of `fprc train` or the workflow")
    export.add_argument(
        "--c",
        metavar="NAME.h",
        dest="header",
        required=True,
        help="header to write; NAME begins every name in it",
    )
    export.add_argument(
        "--float", action="store_true", dest="single", help="compute with float (default: double)"
    )


def _add_log(commands: _Commands) -> None:
    verbs = commands.group("log", "check or repair experiment logs")
    check = verbs.add(
        "check",
        "logs.inspect_logs",
        "check raw logs and say what is wrong with them",
        "fprc log check sweep.h5 complex.h5",
        "fprc log check --json sweep.h5",
        more="Exit code 1: a log cannot be used, or a check fails.",
    )
    check.add_argument("paths", nargs="+", metavar="FILE.h5", help="raw log")
    check.add_argument(
        "--json", action="store_true", dest="as_json", help="print a JSON list, one record per log"
    )
    repair = verbs.add(
        "repair",
        "logs.repair_log",
        "recover a raw log from a journal or a damaged log",
        "fprc log repair sweep.journal --out sweep.h5",
        more="Copies the readable part to a new raw log and prints what is lost. Exit code 0: "
        "nothing is lost; 3: some is; 1: nothing is readable.",
    )
    repair.add_argument("source", metavar="FILE", help="FILE.journal or FILE.h5; it is not changed")
    repair.add_argument(
        "--out", dest="raw", metavar="COPY.h5", required=True, help="raw log to write"
    )


def _add_completion(commands: _Commands) -> None:
    completion = commands.add(
        "completion",
        "completion.print_completion",
        "print a script with which a shell completes commands, options and files",
        'eval "$(fprc completion bash)"',
        more="Needs shtab: pip install 'fprc[completion]'. docs/commands.md says where to put it.",
    )
    completion.add_argument("shell", choices=("bash", "zsh", "fish"), help="shell of the script")
