# The paper from raw logs to tables and figures. Targets: workflow/rules/targets.smk
from snakemake.exceptions import WorkflowError
from snakemake.utils import min_version

from fprc.config import check
from fprc.errors import ConfigError
from fprc.fingerprint import fingerprint

min_version("9.0")


configfile: "config/config.yaml"
configfile: "config/rig.yaml"


try:
    SETTINGS = check(config).model_dump(mode="json")
except ConfigError as error:
    raise WorkflowError(str(error)) from None

RAW = SETTINGS["folders"]["raw"]
RESULTS = SETTINGS["folders"]["results"]


container: "docker://python:3.12-slim"


include: "workflow/rules/common.smk"


wildcard_constraints:
    experiment="sweep|complex",
    model="|".join(MODELS),
    seed=r"\d+",


include: "workflow/rules/targets.smk"
include: "workflow/rules/logs.smk"
include: "workflow/rules/models.smk"
include: "workflow/rules/tables.smk"
include: "workflow/rules/figures.smk"


rule all:
    default_target: True
    input:
        TABLES,
        FIGURES,
        TIMING,
    localrule: True
