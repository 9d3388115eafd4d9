# Claims on many simulated rigs: drawn from the physical ranges, or compatible with the paper's tables.

DRAWN = pick(ENSEMBLE, "seed", "angle_deg", "p_o_swing_kpa")
CHUNKS = {
    first: list(range(first, min(first + ENSEMBLE["chunk"], ENSEMBLE["rigs"])))
    for first in range(0, ENSEMBLE["rigs"], ENSEMBLE["chunk"])
}
CHUNK_FILES = [PATHS.below(f"ensemble/rigs_{first}.json") for first in CHUNKS]
POSTERIOR = SETTINGS["posterior"]
MEMBERS = {
    first: list(range(first, first + POSTERIOR["chunk"]))
    for first in range(0, POSTERIOR["rigs"], POSTERIOR["chunk"])
}
MEMBER_FILES = [PATHS.below(f"posterior/rigs_{first}.json") for first in MEMBERS]
#: How the rigs of each set were drawn, and what they were fitted to.
SETS = {
    "ensemble": ("rigs that were drawn from the physical ranges, not fitted", []),
    "posterior": (
        "rigs that are compatible with the training and test errors of Tables II and III, not "
        "fitted to the other claims",
        ["tables"],
    ),
}


rule ensemble_chunk:
    output:
        rigs=PATHS.below("ensemble/rigs_{chunk}.json"),
    log:
        PATHS.messages("ensemble_{chunk}"),
    # files of another chunk size are not outputs of this rule
    wildcard_constraints:
        chunk="|".join(map(str, CHUNKS)),
    resources:
        mem_mb=2000,
        runtime=120,  # grows with ensemble.chunk
    params:
        **stage("studies.ensemble.judge_rigs", *MODELS, key="version"),
        **EVERY_SEED,
        tracking=SETTINGS["tracking"],
        numbers=lambda wildcards: CHUNKS[int(wildcards.chunk)],
        ensemble=DRAWN,
        free=FREE,
        checkpoint=placed(PATHS.below("ensemble/rigs_{chunk}.partial.jsonl")),
    message:
        "Ensemble: Tables II to IV on the rigs from number {wildcards.chunk}"
    script:
        "../scripts/stage.py"


rule posterior_members:
    input:
        published=PUBLISHED,
    output:
        members=PATHS.below("posterior/members.json"),
    log:
        PATHS.messages("posterior_members"),
    threads: workflow.cores
    resources:
        mem_mb=memory_of,
        runtime=480,
    params:
        **stage("studies.posterior.draw_members", *MODELS, key="version"),
        **EVERY_SEED,
        posterior=pick(POSTERIOR, "rigs", "seed", "tolerance", "assimilations", "sweeps"),
        ensemble=pick(ENSEMBLE, "angle_deg", "p_o_swing_kpa"),
        free=FREE,
        surrogate=SURROGATE,
        workers=lambda wildcards, threads: threads,
        checkpoint=placed(PATHS.below("posterior/members.partial.jsonl")),
    message:
        "Posterior: rigs that are compatible with Tables II and III"
    script:
        "../scripts/stage.py"


rule posterior_chunk:
    input:
        members=PATHS.below("posterior/members.json"),
    output:
        rigs=PATHS.below("posterior/rigs_{chunk}.json"),
    log:
        PATHS.messages("posterior_{chunk}"),
    wildcard_constraints:
        chunk="|".join(map(str, MEMBERS)),
    resources:
        mem_mb=2000,
        runtime=120,  # grows with posterior.chunk
    params:
        **stage("studies.posterior.judge_members", *MODELS, key="version"),
        **EVERY_SEED,
        tracking=SETTINGS["tracking"],
        numbers=lambda wildcards: MEMBERS[int(wildcards.chunk)],
        free=FREE,
        checkpoint=placed(PATHS.below("posterior/rigs_{chunk}.partial.jsonl")),
    message:
        "Posterior: Tables II to IV on the rigs from number {wildcards.chunk}"
    script:
        "../scripts/stage.py"


rule posterior_history:
    input:
        members=PATHS.below("posterior/members.json"),
    output:
        **PATHS.table("posterior/history"),
    log:
        PATHS.messages("posterior_history"),
    params:
        **stage("studies.robustness.tabulate_history"),
    message:
        "Posterior: deviation from print, step by step"
    script:
        "../scripts/stage.py"


rule posterior_worth:
    input:
        summary=PATHS.below("posterior/summary.json"),
    output:
        **PATHS.table("posterior/worth"),
    log:
        PATHS.messages("posterior_worth"),
    params:
        **stage("studies.robustness.tabulate_worth"),
    message:
        "Posterior: how often P_o is worth more than a low-pass, also where other claims hold"
    script:
        "../scripts/stage.py"


rule posterior_near_print:
    input:
        summary=PATHS.below("posterior/summary.json"),
    output:
        **PATHS.table("posterior/near_print"),
    log:
        PATHS.messages("posterior_near_print"),
    params:
        **stage("studies.robustness.tabulate_near_print"),
    message:
        "Posterior: how many rigs are within limits of the printed errors"
    script:
        "../scripts/stage.py"


rule rigs_summary:
    input:
        published=PUBLISHED,
        chunks=lambda wildcards: CHUNK_FILES if wildcards.set == "ensemble" else MEMBER_FILES,
    output:
        summary=PATHS.below("{set}/summary.json"),
    log:
        PATHS.messages("{set}_summary"),
    wildcard_constraints:
        set="|".join(SETS),
    params:
        **stage("studies.rigs.summarise_rigs"),
        drawn=lambda wildcards: SETS[wildcards.set][0],
        terms=lambda wildcards: SETS[wildcards.set][1],
    message:
        "Claims rig by rig: {wildcards.set}"
    script:
        "../scripts/stage.py"


rule shares_table:
    input:
        summary=PATHS.below("{set}/summary.json"),
    output:
        **PATHS.table("{set}/claims"),
    log:
        PATHS.messages("{set}_table"),
    wildcard_constraints:
        set="|".join(SETS),
    params:
        **stage("studies.robustness.tabulate_ensemble"),
    message:
        "Share of rigs on which each claim holds: {wildcards.set}, table"
    script:
        "../scripts/stage.py"


rule shares_figure:
    input:
        summary=PATHS.below("{set}/summary.json"),
    output:
        **drawn(PATHS.below("{set}/claims")),
    log:
        PATHS.messages("{set}_figure"),
    wildcard_constraints:
        set="|".join(SETS),
    params:
        **stage("studies.draw_ensemble.draw_ensemble"),
    message:
        "Share of rigs on which each claim holds: {wildcards.set}, figure"
    script:
        "../scripts/stage.py"


rule ensemble:
    input:
        PATHS.below("ensemble/claims.md"),
        PATHS.below("ensemble/claims.pdf"),
        PATHS.below("ensemble/summary.json"),
        CHUNK_FILES,
    localrule: True


rule posterior:
    input:
        PATHS.below("posterior/claims.md"),
        PATHS.below("posterior/claims.pdf"),
        PATHS.below("posterior/worth.md"),
        PATHS.below("posterior/near_print.md"),
        PATHS.below("posterior/history.md"),
        PATHS.below("posterior/summary.json"),
        MEMBER_FILES,
    localrule: True
