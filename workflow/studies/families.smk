# Families of simulated rigs side by side: named rigs with several seeds, and the ensemble.

#: Rigs that can be named, beside that of the configuration.
OTHER_RIGS = {
    name: path for name, path in rig_files().items() if name != SETTINGS["fitted"]["name"]
}
#: Those of them that were fitted.
FITTED_RIGS = [name for name in OTHER_RIGS if named_rig(name)["fitted"]["to"]]
#: Families of many rigs, and the terms that they were fitted to.
SETS = {"ensemble": SETTINGS["calibration"]["fit"]}
FAMILY_TABLES = ("errors", "claims")


use rule replicate as replicate_on_rig with:
    output:
        compared=PATHS.below("rigs/{rig}/models_{seed}.json"),
        cells=PATHS.below("rigs/{rig}/grids_{seed}.json"),
        measures=PATHS.below("rigs/{rig}/control_{seed}.json"),
    log:
        PATHS.messages("replicate_on_rig_{rig}_{seed}"),
    wildcard_constraints:
        rig="|".join(OTHER_RIGS) or "none",
    params:
        code=computes(*MODELS),
        on_rig=lambda wildcards: on_rig(SETTINGS) | {"rig": named_rig(wildcards.rig)["rig"]},
        validation=lambda wildcards: validation(
            SETTINGS, models=paper_models(SETTINGS), seed=int(wildcards.seed)
        ),
    message:
        "Rig {wildcards.rig}: tables, grids and closed loops with seed {wildcards.seed}"


wildcard_constraints:
    family="|".join(SETS),


rule judge_family:
    input:
        ensemble=ENSEMBLE,
    output:
        judged=PATHS.below("families/{family}.json"),
    log:
        PATHS.messages("judge_family_{family}"),
    threads: workflow.cores
    resources:
        mem_mb=memory_of,
        runtime=120,
    params:
        stage="studies.stages.judge.judge_family",
        version=studies_with(*MODELS),
        judge="families.family.judge_tables",
        family=lambda wildcards: family_named(wildcards.family),
        units=list(range(BEYOND["units"])),
        how={
            "tracking": SETTINGS["tracking"],
            "validation": validation(SETTINGS, without="seed", models=paper_models(SETTINGS)),
        },
        workers=lambda wildcards, threads: threads,
        checkpoint=checkpoint_of("families/{family}"),
    message:
        "Family {wildcards.family}: the paper's tables on its rigs"
    script:
        "../scripts/stage.py"


rule tabulate_families:
    input:
        **{name: PATHS.below(f"families/{name}.json") for name in SETS},
        published=PUBLISHED,
        models=on_rigs("models"),
        grids=on_rigs("grids"),
        controls=on_rigs("control"),
    output:
        **{name: table(f"families/{name}")[:2] for name in FAMILY_TABLES},
        members=PATHS.below("families/members.json"),
    log:
        PATHS.messages("tabulate_families"),
    params:
        stage="studies.stages.families.tabulate_families",
        code=SHOWS,
        named=lambda wildcards: {
            SETTINGS["fitted"]["name"]: SETTINGS["fitted"],
            **{rig: named_rig(rig)["fitted"] for rig in FITTED_RIGS},
        },
    message:
        "Errors and claims on families of rigs"
    script:
        "../scripts/stage.py"


STUDY_TARGETS["families"] = [
    *(PATHS.below(f"families/{name}.md") for name in FAMILY_TABLES),
    *rules.tabulate_families.input,
]
