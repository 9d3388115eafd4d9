# The paper from raw logs to tables and figures. Targets: workflow/rules/targets.smk
from functools import cache
from math import prod
from pathlib import Path

from snakemake.exceptions import WorkflowError
from snakemake.io import regex_from_filepattern
from snakemake.utils import min_version

from fprc.artifacts import refuse_unwritable
from fprc.config import PUBLISHED, from_files, rig_file, rig_files
from fprc.errors import FprcError
from fprc.fingerprint import fingerprint
from fprc.paper import EXPERIMENTS, REFERENCES, GRID_MODELS, GRID_SETTINGS, run_log
from fprc.plan import BY_NAME, read_plan, refusal
from fprc.plan.arguments import judgement, on_drawn_rigs, on_rig, paper_models, pick, tracking
from fprc.registry import MODELS, class_module, model_of_run, settings_of

min_version("9.0")


# We parse the files ourselves, also those of the command line: Snakemake takes the last of
# repeated keys without a warning, and 010 for 8.
OWN = ["config/config.yaml"]
if workflow.config_settings.replace_workflow_config:
    OWN = []
workflow.configfiles += OWN

try:
    SETTINGS = from_files(
        [*OWN, *workflow.overwrite_configfiles], workflow.config_settings.config
    ).model_dump(mode="json")
    config.update(SETTINGS)  # typed values of all keys, with the defaults
    # these belong to the run and do not change the results
    ARMED = SETTINGS.pop("armed")
    GRID_CHUNKS = SETTINGS["grids"].pop("chunks")
    RAW, RESULTS = SETTINGS["folders"]["raw"], SETTINGS["folders"]["results"]
    refuse_unwritable([RESULTS] if SETTINGS["source"] == "recorded" else [RAW, RESULTS])
    # every job reads this file again, but only the main process meets logs that may be damaged and
    # therefore reads them in a child process
    PLAN = read_plan(SETTINGS, isolate=workflow.is_main_process)
except FprcError as error:
    raise WorkflowError(str(error)) from None


# the image of the Containerfile
container: "docker-daemon://fprc:latest"


include: "workflow/rules/common.smk"


wildcard_constraints:
    experiment="|".join(EXPERIMENTS),
    model="|".join(PLAN.models),
    number="2|3",
    reference="|".join(SETTINGS["tracking"]["references"]),
    grid="epsilon|n_c|taps",
    seed=r"\d+",
    target="command|measured",


include: "workflow/rules/targets.smk"
include: "workflow/rules/logs.smk"
include: "workflow/rules/models.smk"
include: "workflow/rules/control.smk"
include: "workflow/rules/tables.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/claims.smk"
include: "workflow/rules/calibration.smk"
include: "workflow/rules/scaling.smk"
include: "workflow/rules/report.smk"
include: "workflow/rules/benchmark.smk"


rule all:
    default_target: True
    input:
        TARGETS["report"],
    localrule: True
