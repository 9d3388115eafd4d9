# Names that several rules share.
#
# A rule's script calls the function of the package that the param `stage` names, with the rule's
# named inputs, outputs and params as arguments, except `stage` and `code`. The param `code` is a
# digest, which lets a rule run again when its code has changed.

#: Priorities: LONG starts long jobs early; ALONE is for jobs that need the whole machine. The
#: scheduler sums the priorities of jobs that start together, so ALONE exceeds LONG on every core.
LONG, ALONE = 1, workflow.cores + 1
#: What tables, figures and pages are made with.
SHOWS = code_that_shows()


def computes(*models):
    """Return the digest of the code that computes with models."""
    return code_that_computes(*models, settings=SETTINGS["models"])


def table(name):
    """Return the files of a table, named below the results: numbers, and pages with title and note."""
    return [f"{RESULTS}/{name}.{kind}" for kind in ("csv", "md", "tex", "json")]


def figure(name, *numbers):
    """Return the files of a figure; with "csv" also the numbers that it shows."""
    return [f"{RESULTS}/figures/{name}.{kind}" for kind in ("pdf", "png", *numbers)]
