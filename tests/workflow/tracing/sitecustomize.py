"""Trace the processes of a build; each process imports this if its folder is on PYTHONPATH.

FPRC_TRACE names a folder. Each process writes a file there. A line has either a rule's fingerprint
and a module of which a function ran for that rule, or a fingerprint and the modules from which it
was computed.
"""

import builtins
import importlib
import json
import os
import sys

FUNCTION = 0x1  # CO_OPTIMIZED: not the body of a module or a class


def writer(folder):
    file = open(f"{folder}/{os.getpid()}.txt", "a", buffering=1, encoding="utf-8")  # noqa: SIM115

    def write(*words):
        file.write(" ".join(words) + "\n")

    return write


def note_fingerprints(write):
    fingerprint = importlib.import_module("fprc.fingerprint")
    given = fingerprint.fingerprint

    def noted(*modules):
        found = given(*modules)
        write("asked", found, json.dumps(modules))
        return found

    fingerprint.fingerprint = noted


def watch(write):
    seen, early = {}, []  # codes are kept, so that no id comes twice

    def on_call(frame, event, _):
        code = frame.f_code
        if id(code) in seen:
            return None
        seen[id(code)] = code
        module = frame.f_globals.get("__name__") or ""
        if not module.startswith("fprc.") or not code.co_flags & FUNCTION:
            return None
        if code.co_filename.startswith("<"):  # the decorator of a dataclass runs it on import
            return None
        if module == "fprc.stages.run" and code.co_name == "run_stage":
            params = dict(frame.f_locals["job"].params.items())
            os.environ["FPRC_TRACED_RULE"] = params.get("code") or params["version"]
        if not code.co_qualname.startswith("<"):  # a lambda or comprehension at a module's top
            early.append(module)
        rule = os.environ.get("FPRC_TRACED_RULE")
        while rule and early:
            write("ran", rule, early.pop())
        return None

    sys.settrace(on_call)
    importing = builtins.__import__

    def untraced(name, *rest, **more):
        """Import other packages without the trace: none of our functions runs meanwhile."""
        if sys.gettrace() is None or name.startswith("fprc"):
            return importing(name, *rest, **more)
        sys.settrace(None)
        try:
            return importing(name, *rest, **more)
        finally:
            sys.settrace(on_call)

    builtins.__import__ = untraced


if os.environ.get("FPRC_TRACE"):
    write = writer(os.environ["FPRC_TRACE"])
    # Snakemake itself runs no stage, and a trace would double its time
    (note_fingerprints if "snakemake" in sys.orig_argv else watch)(write)
