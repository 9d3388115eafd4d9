# Families of simulated rigs, named ones with several seeds and the ensemble: the paper's tables and
# claims on them, models beyond the paper's, and a model that learns while it runs.


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


rule judge_family:
    input:
        ensemble=ENSEMBLE,
    output:
        judged=PATHS.below("{study}/{family}.json"),
    log:
        PATHS.messages("judge_{study}_{family}"),
    wildcard_constraints:
        study="|".join(STUDIES),
        family="|".join(FAMILIES),
    threads: workflow.cores
    resources:
        # each process holds the logs and one model
        mem_mb=lambda wildcards, threads: 1000 * (1 + threads),
        runtime=120,
    params:
        stage="studies.families.family.judge_family",
        version=code_that_computes(*COMPETITORS, also=["studies"]),
        judge=lambda wildcards: STUDIES[wildcards.study]["judge"],
        how=lambda wildcards: STUDIES[wildcards.study]["how"],
        family=family_of,
        units=lambda wildcards: list(range(STUDIES[wildcards.study].get("units", BEYOND["units"]))),
        workers=lambda wildcards, threads: threads,
        checkpoint=with_prefix(PATHS.below("{study}/{family}.partial.jsonl")),
    message:
        "Family {wildcards.family}: {wildcards.study}"
    script:
        "../scripts/stage.py"


rule tabulate_families:
    input:
        ensemble=PATHS.below("families/ensemble.json"),
        published=PUBLISHED,
        models=on_rigs("models"),
        grids=on_rigs("grids"),
        controls=on_rigs("control"),
    output:
        errors=table("families/errors")[:2],
        claims=table("families/claims")[:2],
        members=PATHS.below("families/members.json"),
    log:
        PATHS.messages("tabulate_families"),
    params:
        stage="studies.families.tables.tabulate_families",
        code=SHOWS,
        named=lambda wildcards: {
            CONFIGURED: SETTINGS["fitted"],
            **{rig: named_rig(rig)["fitted"] for rig in FITTED_RIGS},
        },
    message:
        "Errors and claims on families of rigs"
    script:
        "../scripts/stage.py"


rule tabulate_beyond:
    input:
        families=expand(PATHS.below("beyond/{family}.json"), family=FAMILIES),
    output:
        **{name: PATHS.below(f"beyond/{name}.csv") for name in PAGES_BEYOND[:2]},
        pages=expand(PATHS.below("beyond/{page}.md"), page=PAGES_BEYOND),
        figure=[PATHS.below("beyond/figure_pairs.pdf"), PATHS.below("beyond/figure_pairs.png")],
    log:
        PATHS.messages("tabulate_beyond"),
    params:
        stage="studies.beyond.tables.tabulate_beyond",
        code=SHOWS,
        family=CONFIGURED,
    message:
        "Claims and models beyond the paper"
    script:
        "../scripts/stage.py"


rule tabulate_online:
    input:
        families=expand(PATHS.below("online/{family}.json"), family=FAMILIES),
    output:
        verdicts=table("online/verdicts")[:2],
        errors=table("online/errors")[:2],
        figure=[PATHS.below("online/figure.pdf"), PATHS.below("online/figure.png")],
    log:
        PATHS.messages("tabulate_online"),
    params:
        stage="studies.online.pages.tabulate_online",
        code=SHOWS,
        shown=FAMILIES[:3],
    message:
        "Verdicts and errors of learning while it runs"
    script:
        "../scripts/stage.py"


#: Files of each target; the Snakefile has their rules.
STUDY_TARGETS = {
    "families": [*rules.tabulate_families.output, *rules.tabulate_families.input],
    "beyond": [*rules.tabulate_beyond.output, *rules.tabulate_beyond.input],
    "online": [*rules.tabulate_online.output, *rules.tabulate_online.input],
}
