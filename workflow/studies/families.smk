# Families of simulated rigs side by side: named rigs with several seeds, rigs near print, rigs drawn
# at random.

#: Rigs that can be named, beside that of the configuration.
OTHER_RIGS = {
    name: path for name, path in rig_files().items() if name != SETTINGS["fitted"]["name"]
}
#: Those of them that were fitted.
FITTED_RIGS = [name for name in OTHER_RIGS if named_rig(name)["fitted"]["to"]]
#: Families of many rigs, and the terms that they were fitted to.
SETS = {"near_print": ["tables"], "drawn": []}
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
        **stage("stages.replicate.replicate", *MODELS),
        on_rig=lambda wildcards: on_rig(SETTINGS) | {"rig": named_rig(wildcards.rig)["rig"]},
        judgement=lambda wildcards: judgement(
            SETTINGS, models=paper_models(SETTINGS), seed=int(wildcards.seed)
        ),
    message:
        "Rig {wildcards.rig}: tables, grids and closed loops with seed {wildcards.seed}"


wildcard_constraints:
    family="|".join(SETS),


STUDY_RESULTS["judge_family"] = judgement_spec(
    "families/{family}",
    "families.family.judge_tables",
    *MODELS,
    given={"near_print": NEAR_PRINT},
    family=lambda wildcards: family_named(wildcards.family),
    units=list(range(BEYOND["units"])),
    how={"tracking": SETTINGS["tracking"], "judgement": EVERY_SEED},
)


STUDY_RESULTS["families_tables"] = result_spec(
    "families/tables",
    "tables",
    {
        **{name: PATHS.below(f"families/{name}.json") for name in SETS},
        "published": PUBLISHED,
        "models": on_rigs("models"),
        "grids": on_rigs("grids"),
        "controls": on_rigs("control"),
    },
    {
        table: [PATHS.below(f"families/{table}.{kind}") for kind in ("csv", "md")]
        for table in FAMILY_TABLES
    },
    **stage("studies.stages.families.tabulate_families"),
    named=lambda wildcards: {
        SETTINGS["fitted"]["name"]: SETTINGS["fitted"],
        **{rig: named_rig(rig)["fitted"] for rig in FITTED_RIGS},
    },
)


STUDY_TARGETS |= {
    "families": [
        *expand(PATHS.below("families/{table}.md"), table=FAMILY_TABLES),
        *STUDY_RESULTS["families_tables"].given.values(),
    ],
}
