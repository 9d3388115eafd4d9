# Simulated rigs side by side: those that can be named.

#: Rigs that can be named, beside that of the configuration.
OTHER_RIGS = {
    name: path for name, path in rig_files().items() if name != SETTINGS["fitted"]["name"]
}
#: Those of them that were fitted, with a report of the fit.
FITTED_RIGS = [name for name, path in OTHER_RIGS.items() if path.with_suffix(".json").exists()]


rule replicate_on_rig:
    output:
        compared=PATHS.below("rigs/{rig}/models_{seed}.json"),
        cells=PATHS.below("rigs/{rig}/grids_{seed}.json"),
        measures=PATHS.below("rigs/{rig}/control_{seed}.json"),
    log:
        PATHS.messages("replicate_on_rig_{rig}_{seed}"),
    wildcard_constraints:
        rig="|".join(OTHER_RIGS) or "none",
    resources:
        mem_mb=2000,
        runtime=60,
    params:
        **stage("replicate.replicate", *MODELS),
        on_rig=lambda wildcards: on_rig(SETTINGS) | {"rig": named_rig(wildcards.rig)["rig"]},
        judgement=lambda wildcards: judgement(
            SETTINGS, models=paper_models(SETTINGS), seed=int(wildcards.seed)
        ),
        values=pick(SETTINGS["grids"], "epsilon", "n_c", "n_u", "n_y"),
        tracking=SETTINGS["tracking"],
    message:
        "Rig {wildcards.rig}: tables, grids and closed loops with seed {wildcards.seed}"
    script:
        "../scripts/stage.py"


rule rigs_table:
    input:
        published=PUBLISHED,
        models=on_rigs("models"),
        grids=on_rigs("grids"),
        controls=on_rigs("control"),
    output:
        **PATHS.table("rigs/rigs"),
    log:
        PATHS.messages("rigs_table"),
    params:
        **stage("studies.rigs.compare_rigs"),
        fitted=lambda wildcards: {
            SETTINGS["fitted"]["name"]: SETTINGS["fitted"]["to"],
            **{rig: named_rig(rig)["fitted"]["to"] for rig in FITTED_RIGS},
        },
    message:
        "Rigs side by side"
    script:
        "../scripts/stage.py"


rule answer_table:
    input:
        rigs=PATHS.below("rigs/rigs.md"),
        sets=[PATHS.below("posterior/summary.json"), PATHS.below("ensemble/summary.json")],
    output:
        **PATHS.table("rigs/answer"),
    log:
        PATHS.messages("answer_table"),
    params:
        **stage("studies.rigs.tabulate_answer"),
    message:
        "Worth of the reservoir on all rigs"
    script:
        "../scripts/stage.py"


rule rigs:
    input:
        PATHS.below("rigs/rigs.md"),
        *(on_rigs(part) for part in ("models", "grids", "control")),
    localrule: True
