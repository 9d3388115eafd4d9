"""Command line: ``fprc config``, ``calibrate``, ``import``, ``rig``, ``readout``, and others."""

import argparse
import os
import sys
from collections.abc import Sequence
from typing import Any

from fprc import __version__
from fprc.errors import FprcError

#: What ``add_subparsers`` returns; argparse has no public name for it.
Groups = Any

_CONFIGURATION = (
    "configuration; later files override earlier ones (default: config/config.yaml if there is "
    "one, else the defaults)"
)


#: Exit code of a program whose reader has gone, as shells give it.
_BROKEN_PIPE = 141


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code."""
    try:
        try:
            return _run(arguments)
        finally:
            sys.stdout.flush()
    except BrokenPipeError:  # nothing reads the output any more, as after `| head`
        # Python flushes once more when it exits
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return _BROKEN_PIPE


def _run(arguments: Sequence[str] | None) -> int:
    options = _parser().parse_args(arguments)
    try:
        return options.run(options) or 0
    except FprcError as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    except ModuleNotFoundError as error:
        print(
            f"error: {error}; install what the workflow needs: pip install 'fprc[workflow]'",
            file=sys.stderr,
        )
        return 1
    except KeyboardInterrupt:
        print("stopped; finished results are kept", file=sys.stderr)
        return 130


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="fprc",
        description="Hysteresis compensation by pneumatic physical reservoir computing. "
        "Tables and figures are made by `snakemake --cores 2 all`.",
    )
    parser.add_argument("--version", action="version", version=f"fprc {__version__}")
    groups = parser.add_subparsers(required=True, metavar="GROUP")
    for add in (
        _add_config, _add_calibrate, _add_import, _add_rig, _add_readout, _add_export, _add_log,
    ):  # fmt: skip
        add(groups)
    return parser


def _add_config(groups: Groups) -> None:
    config = groups.add_parser("config", help="check or explain the configuration")
    verbs = config.add_subparsers(required=True, metavar="VERB")
    check = verbs.add_parser("check", help="check configuration files, merged in this order")
    check.add_argument("files", nargs="+", metavar="FILE")
    check.set_defaults(run=_check_config)
    for name, what in (
        ("defaults", "print config/config.yaml"),
        ("schema", "print config/schema.json"),
        ("reference", "print docs/configuration.md"),
    ):
        verbs.add_parser(name, help=what).set_defaults(run=_print_config, page=name)
    rig = verbs.add_parser("rig", help="print the parameters of a fitted rig")
    rig.add_argument("name", nargs="?", metavar="NAME", help="default: the rig of the defaults")
    rig.set_defaults(run=_print_rig)
    published = verbs.add_parser("published", help="print the numbers of the paper, as YAML")
    published.set_defaults(run=_print_published)


def _check_config(options: argparse.Namespace) -> None:
    from fprc.config import from_files

    from_files(options.files)
    print("no errors")


def _print_config(options: argparse.Namespace) -> None:
    from fprc.config import reference

    print(getattr(reference, options.page)(), end="")


def _print_rig(options: argparse.Namespace) -> None:
    from fprc.config.load import RIG, rig_file

    print(rig_file(options.name or RIG).read_text(encoding="utf-8"), end="")


def _print_published(options: argparse.Namespace) -> None:
    from fprc.config import PUBLISHED

    print(PUBLISHED.read_text(encoding="utf-8"), end="")


def _add_calibrate(groups: Groups) -> None:
    calibrate = groups.add_parser(
        "calibrate",
        help="fit the simulated rig to Tables II and III",
        description="Fit the free parameters of the simulated rig to the published numbers and "
        "write a parameter file. Repeat the command to continue a search that was stopped.",
    )
    calibrate.add_argument(
        "files",
        nargs="*",
        metavar="FILE",
        help=_CONFIGURATION,
    )
    calibrate.add_argument("--out", default="config/rigs/fitted.yaml", help="default: %(default)s")
    calibrate.add_argument(
        "--published", metavar="FILE", help="default: what `fprc config published` prints"
    )
    calibrate.add_argument(
        "--minutes", type=float, help="time limit (default: the configuration's)"
    )
    calibrate.add_argument("--workers", type=int, help="processes (default: one per processor)")
    calibrate.set_defaults(run=_calibrate)


def _calibrate(options: argparse.Namespace) -> None:
    from fprc.commands.calibrate import calibrate_from_files

    calibrate_from_files(
        options.files,
        options.published,
        options.out,
        minutes=options.minutes,
        workers=options.workers,
    )


def _add_import(groups: Groups) -> None:
    importer = groups.add_parser(
        "import",
        help="turn a CSV, HDF5 or MATLAB file into a raw log",
        description="Turn a CSV, HDF5 or MATLAB file into a raw log, and diagnose the recording. "
        "docs/own-data.md describes the map.",
    )
    importer.add_argument("source", metavar="SOURCE")
    importer.add_argument("--list", action="store_true", help="print the file's columns and exit")
    importer.add_argument("--map", metavar="MAP.yaml", help="columns, units, clock, rate")
    importer.add_argument("--out", metavar="FILE.h5", help="raw log to write")
    importer.set_defaults(run=_import, usage=importer.error)


def _import(options: argparse.Namespace) -> None:
    from fprc.commands.import_recording import import_recording, list_source

    if options.list:
        list_source(options.source, options.map)
    elif options.map and options.out:
        import_recording(options.source, options.map, options.out)
    else:
        options.usage("give --list, or both --map and --out")


def _add_rig(groups: Groups) -> None:
    rig = groups.add_parser("rig", help="check and run the real rig")
    verbs = rig.add_subparsers(required=True, metavar="VERB")
    check = verbs.add_parser("check", help="check valves and sensors one by one")
    check.set_defaults(run=_check_rig)
    experiment = verbs.add_parser("run", help="run one experiment and write its raw log")
    experiment.add_argument("experiment", metavar="EXPERIMENT", help="`list` prints them")
    experiment.add_argument(
        "--out", metavar="FILE.h5", help="default: EXPERIMENT.h5 in folders.raw"
    )
    experiment.add_argument("--model", help="fitted FPRC (default: that in the results folder)")
    experiment.add_argument("--gains", help="gains (default: those in the results folder)")
    experiment.set_defaults(run=_run_rig)
    for verb in (check, experiment):
        verb.add_argument("--armed", action="store_true", help="let valves move")
        verb.add_argument(
            "--config",
            nargs="+",
            metavar="FILE",
            default=[],
            help=_CONFIGURATION,
        )


def _check_rig(options: argparse.Namespace) -> None:
    from fprc.commands.rig import check

    check(options.config, armed=options.armed)


def _run_rig(options: argparse.Namespace) -> None:
    from fprc.commands.rig import run_by_name

    run_by_name(
        options.experiment,
        options.config,
        armed=options.armed,
        raw=options.out,
        model=options.model,
        gains=options.gains,
    )


def _add_readout(groups: Groups) -> None:
    readout = groups.add_parser(
        "readout",
        help="measure how much the readout P_o of a recording improves FPRC",
        description="Import a recording, train FPRC with and without P_o on its first part, test "
        "on its second, and write a report. The map gives test_from_s; docs/own-data.md describes "
        "it. Repeat the command to continue a run that was stopped.",
    )
    readout.add_argument("source", metavar="SOURCE")
    readout.add_argument("--map", required=True, metavar="MAP.yaml", help="columns, units, parts")
    readout.add_argument(
        "--train",
        nargs="+",
        default=[],
        metavar="FILE",
        help="further recordings with the same columns, which train as a whole",
    )
    readout.add_argument("--out", metavar="FOLDER", help="default: results/ and SOURCE's name")
    readout.add_argument(
        "--config", nargs="+", default=[], metavar="FILE", help="settings of the models"
    )
    readout.add_argument("--workers", type=int, help="processes (default: one per processor)")
    readout.set_defaults(run=_readout)


def _readout(options: argparse.Namespace) -> None:
    from fprc.commands.readout import report_readout

    report_readout(
        options.source,
        options.map,
        options.out,
        train=options.train,
        config=options.config,
        workers=options.workers,
    )


def _add_export(groups: Groups) -> None:
    export = groups.add_parser(
        "export",
        help="turn a fitted model into C code for a controller",
        description="Turn a fitted FPRC or Fuzzy-linear into one C99 header without memory "
        "allocation. docs/deploy.md shows its use.",
    )
    export.add_argument("model", metavar="MODEL.h5", help="for example models/sweep_fprc.h5")
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
    export.set_defaults(run=_export)


def _export(options: argparse.Namespace) -> None:
    from fprc.commands.export import export_c

    export_c(options.model, options.header, single=options.single)


def _add_log(groups: Groups) -> None:
    log = groups.add_parser("log", help="check or repair experiment logs")
    verbs = log.add_subparsers(required=True, metavar="VERB")
    quality = verbs.add_parser("check", help="read raw logs and print their quality records")
    quality.add_argument("files", nargs="+", metavar="FILE")
    quality.set_defaults(run=_check_logs)
    repair = verbs.add_parser(
        "repair",
        help="recover a raw log from a journal or a damaged log",
        description="Copy the readable part of a journal or of a damaged raw log to a new raw log, "
        "and print what is lost. Exit code 0: nothing is lost; 3: some is; 1: nothing is readable.",
    )
    repair.add_argument("file", metavar="FILE", help="FILE.journal or FILE.h5; is not changed")
    repair.add_argument("--out", metavar="COPY.h5", required=True, help="raw log to write")
    repair.set_defaults(run=_repair_log)


def _check_logs(options: argparse.Namespace) -> int:
    from fprc.commands.logs import inspect_logs

    return inspect_logs(options.files)


def _repair_log(options: argparse.Namespace) -> int:
    from fprc.commands.logs import repair_log

    return repair_log(options.file, options.out)
