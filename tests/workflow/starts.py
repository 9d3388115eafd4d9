"""Run Snakemake as often as asked and import it once: each run is a fork of this process.

A line of the input is a JSON list of the folder, the arguments and the environment; the answer is a
line with the exit code and what the run printed. Most of a dry run is imports, and so are two
thirds of a job of the smoke run: jobs are forks too, of a process that has the libraries imported.
A run that needs processes of its own starts its jobs as Snakemake does. The package itself is not
imported here: a test may edit a copy of it.
"""

import gc
import importlib
import json
import os
import runpy
import signal
import subprocess
import sys
import tempfile

# what Snakemake and the Snakefile import in every run
import h5py  # noqa: F401
import nbformat  # noqa: F401
import numpy  # noqa: F401
import pandas  # noqa: F401
import pydantic  # noqa: F401
import smart_open  # noqa: F401
import snakemake.cli
import snakemake.report.html_reporter
import snakemake.script
import snakemake.storage  # noqa: F401
import yaml  # noqa: F401
import yte  # noqa: F401

LIMIT_S = 1800
DRY = {"-n", "--dry-run", "--lint", "--list", "--summary", "--unlock", "--touch"}
#: What the jobs import.
LIBRARIES = (
    "matplotlib.backends.backend_agg",
    "matplotlib.backends.backend_pdf",
    "numba",
    "scipy.signal",
    "scipy.stats",
    "sklearn.cluster",
    "sklearn.model_selection",
)


def run(printed, folder, arguments, environment, forked):
    """Do in a child what ``python -m snakemake`` does in a process of its own."""
    signal.alarm(LIMIT_S)
    os.chdir(folder)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.dup2(printed.fileno(), 1)
    os.dup2(printed.fileno(), 2)
    os.environ.update(environment)
    folders = list(filter(None, environment.get("PYTHONPATH", "").split(os.pathsep)))
    sys.path[:0] = folders
    script = forking() if forked else None
    sys.argv = sys.orig_argv = [script] if script else ["snakemake", *arguments]
    if script:
        runpy.run_path(script, run_name="__main__")
    else:
        runpy.run_module("snakemake", run_name="__main__")


def forking():
    """Let Snakemake run scripts in forks of a child, which has no threads.

    Returns in Snakemake's process without a value, and in each fork with the path of its script.
    """
    asked, ask = os.pipe()
    if not os.fork():
        os.close(ask)
        with os.fdopen(asked) as requests:
            for line in requests:
                script, answer, folder = json.loads(line)
                if not os.fork():
                    if not (job := os.fork()):
                        os.chdir(folder)  # --directory may have named another one
                        return script
                    code = os.waitstatus_to_exitcode(os.waitpid(job, 0)[1])
                    with open(answer, "w") as file:
                        file.write(str(code))
                    os._exit(0)
        os._exit(0)
    os.close(asked)

    def execute_script(self, fname, edit=False):
        with tempfile.TemporaryDirectory() as folder:
            answer = f"{folder}/code"
            os.mkfifo(answer)
            # shorter than PIPE_BUF, so that requests of two threads do not mix
            os.write(ask, (json.dumps([fname, answer, os.getcwd()]) + "\n").encode())
            with open(answer) as file:
                code = int(file.read())
        if code:
            raise subprocess.CalledProcessError(code, [sys.executable, fname])

    snakemake.script.PythonScript.execute_script = execute_script
    return None


def main():
    """Answer until the input ends."""
    for line in sys.stdin:
        folder, arguments, environment, forked = json.loads(line)
        forked = forked and not DRY.intersection(arguments)
        for name in LIBRARIES if forked else ():
            importlib.import_module(name)
        gc.freeze()  # a collection in a child would copy every page
        with tempfile.TemporaryFile() as printed:
            child = os.fork()
            if not child:
                run(printed, folder, arguments, environment, forked)
                return
            code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
            printed.seek(0)
            print(json.dumps([code, printed.read().decode(errors="replace")]), flush=True)


if __name__ == "__main__":
    main()
