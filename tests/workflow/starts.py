"""Run Snakemake as often as asked and import it once: each run is a fork of this process.

A line of the input is a JSON list of the folder, the arguments and the environment; the answer is a
line with the exit code and what the run printed. Most of a dry run is imports, and the tests make
more than a hundred. The package itself is not imported here: a test may edit a copy of it.
"""

import gc
import json
import os
import runpy
import signal
import sys
import tempfile

# what Snakemake and the Snakefile import in every run
import h5py  # noqa: F401
import nbformat  # noqa: F401
import numpy  # noqa: F401
import pydantic  # noqa: F401
import smart_open  # noqa: F401
import snakemake.cli
import snakemake.report.html_reporter
import snakemake.storage  # noqa: F401
import yaml  # noqa: F401
import yte  # noqa: F401

LIMIT_S = 1800


def run(printed, folder, arguments, environment):
    """Do in a child what ``python -m snakemake`` does in a process of its own."""
    signal.alarm(LIMIT_S)
    os.chdir(folder)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.dup2(printed.fileno(), 1)
    os.dup2(printed.fileno(), 2)
    os.environ.update(environment)
    sys.path[:0] = filter(None, environment.get("PYTHONPATH", "").split(os.pathsep))
    sys.argv = ["snakemake", *arguments]
    runpy.run_module("snakemake", run_name="__main__")


def main():
    """Answer until the input ends."""
    gc.freeze()  # a collection in a child would copy every page
    for line in sys.stdin:
        with tempfile.TemporaryFile() as printed:
            child = os.fork()
            if not child:
                run(printed, *json.loads(line))
                return
            code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
            printed.seek(0)
            print(json.dumps([code, printed.read().decode(errors="replace")]), flush=True)


if __name__ == "__main__":
    main()
