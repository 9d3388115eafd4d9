# Functions that several rules share.

PATHS = PLAN.paths

#: Priorities: LONG starts long jobs early; ALONE is for jobs that need the whole machine. The
#: scheduler sums the priorities of jobs that start together, so ALONE exceeds LONG on every core.
LONG, ALONE = 1, workflow.cores + 1


RULES = workflow.current_basedir


def file_of_workflow(name):
    """Return a file of this workflow, named from the folder of the rules.

    The path is relative, so that moving the workflow with its results reruns nothing.
    """
    if isinstance(RULES, os.PathLike):
        return local(os.path.relpath(os.path.join(RULES, name)))
    return workflow.source_path(name)  # a copy: the module comes from a git repository


def code_of(name, *models):
    """Return the fingerprint of the code of a stage and of the models that it runs."""
    modules = [class_module(model, SETTINGS["models"]) for model in models]
    return fingerprint("fprc.stages.run", module_of(name), *modules)


def stage(name, *models):
    """Return the params of a stage: its name, and the fingerprint of its code and its models."""
    # a function, so that a job's process reads the sources of its own stage only
    return {"stage": name, "code": lambda wildcards: code_of(name, *models)}


def result_spec(stem, kind, given, made, *, priority=0, threads=1, resources={}, **params):
    """Return what is peculiar to a table or a figure; ``stem`` are its files without suffix."""
    return SimpleNamespace(
        words=f"{kind.capitalize()} {stem}".replace("{", "{wildcards."),
        given=given,
        made=made,
        log=PATHS.messages("_".join([*Path(stem).parts, kind])),
        priority=priority,
        threads=threads,
        resources=resources,
        params=params,
    )


def table_spec(stem, given, **params):
    """Return what is peculiar to a table."""
    made = {kind: PATHS.below(f"{stem}.{kind}") for kind in ("csv", "md")}
    return result_spec(stem, "table", given, made, **params)


def figure_spec(stem, given, statistics=False, **params):
    """Return what is peculiar to a figure. With ``statistics`` its numbers are a file too."""
    path = PATHS.below(stem)
    made = {"pdf": f"{path}.pdf", "png": f"{path}.png"}
    made |= {"csv": f"{path}.csv"} if statistics else {}
    return result_spec(stem, "figure", given, made, **params)


def refused(why):
    """Return an input function that ends the workflow with the reason."""

    def input_of(wildcards):
        raise WorkflowError(why)

    return input_of
