# Calibration of the simulated rig, and what depends on it. None of this is part of `all`.

ENSEMBLE = SETTINGS["ensemble"]
TARGET_NAMES = ["command", "measured"]
SURROGATE = pick(SETTINGS["calibration"], "stride", "esn_nodes")
DRAWN = pick(ENSEMBLE, "seed", "angle_deg", "p_o_swing_kpa")
FREE = {"paths": SETTINGS["calibration"]["free"], "ranges": SETTINGS["calibration"]["ranges"]}
CHUNKS = {
    first: list(range(first, min(first + ENSEMBLE["chunk"], ENSEMBLE["rigs"])))
    for first in range(0, ENSEMBLE["rigs"], ENSEMBLE["chunk"])
}
#: Where the end points of searches are.
SEARCHES = Path("config/rigs/searches")
#: Tables of rigs side by side, by their folder: rigs that can be named, and end points of searches.
RIGS = {
    "rigs": {
        name: path for name, path in rig_files().items() if name != SETTINGS["fitted"]["name"]
    },
    "searches": {path.stem: path for path in sorted(SEARCHES.glob("*.yaml"))},
}
RIG_FILES = RIGS["rigs"] | RIGS["searches"]
#: Seeds that judge the end points of the searches.
SEARCH_SEEDS = 10


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
        "rigs that are compatible with the training and test errors of Tables II and III; the "
        "other claims were not asked of them",
        ["tables"],
    ),
}


rule fit_rig:
    input:
        published=PUBLISHED,
    output:
        fitted=PATHS.below("calibration/rig.yaml"),
        report=PATHS.below("calibration/fit.json"),
    log:
        PATHS.messages("fit_rig"),
    threads: workflow.cores
    resources:
        mem_mb=memory_of,
        runtime=480,
    params:
        **stage("calibrate.calibrate", *MODELS, key="version"),
        on_rig=on_rig(SETTINGS),
        judgement=judgement(SETTINGS, without="seed", models=paper_models(SETTINGS)),
        calibration=SETTINGS["calibration"],
        grids=pick(SETTINGS["grids"], "epsilon", "n_c"),
        tracking=SETTINGS["tracking"],
        workers=lambda wildcards, threads: threads,
        checkpoint=placed(PATHS.below("calibration/search.partial.jsonl")),
    message:
        "Fit of the rig to Tables II and III"
    script:
        "../scripts/stage.py"


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
        **stage("ensemble.judge_rigs", *MODELS, key="version"),
        on_rig=on_rig(SETTINGS),
        judgement=judgement(SETTINGS, without="seed", models=paper_models(SETTINGS)),
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
        **stage("posterior.draw_members", *MODELS, key="version"),
        on_rig=on_rig(SETTINGS),
        judgement=judgement(SETTINGS, without="seed", models=paper_models(SETTINGS)),
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
        **stage("posterior.judge_members", *MODELS, key="version"),
        on_rig=on_rig(SETTINGS),
        judgement=judgement(SETTINGS, without="seed", models=paper_models(SETTINGS)),
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
        **stage("tabulate.tabulate_history"),
    message:
        "Posterior: deviation from print, step by step"
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
        **stage("rigs.summarise_rigs"),
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
        **stage("tabulate.tabulate_ensemble"),
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
        **stage("draw_ensemble.draw_ensemble"),
    message:
        "Share of rigs on which each claim holds: {wildcards.set}, figure"
    script:
        "../scripts/stage.py"


rule measure_sensitivity:
    output:
        effects=PATHS.below("calibration/sensitivity.json"),
    log:
        PATHS.messages("measure_sensitivity"),
    threads: workflow.cores
    resources:
        mem_mb=memory_of,
        runtime=240,
    params:
        **stage("ensemble.measure_sensitivity", *MODELS, key="version"),
        on_rig=on_rig(SETTINGS),
        models=paper_models(SETTINGS),
        paths=SETTINGS["calibration"]["free"],
        steps=ENSEMBLE["sensitivity_steps"],
        seeds=SETTINGS["evaluation"]["replicate_seeds"][:2],
        surrogate=SURROGATE,
        workers=lambda wildcards, threads: threads,
        checkpoint=placed(PATHS.below("calibration/sensitivity.partial.jsonl")),
    message:
        "Sensitivity of the errors to each parameter of the rig"
    script:
        "../scripts/stage.py"


rule sensitivity_table:
    input:
        effects=PATHS.below("calibration/sensitivity.json"),
    output:
        **PATHS.table("calibration/sensitivity"),
    log:
        PATHS.messages("sensitivity_table"),
    params:
        **stage("tabulate.tabulate_sensitivity"),
    message:
        "Sensitivity: table"
    script:
        "../scripts/stage.py"


rule replicate_on_rig:
    output:
        compared=PATHS.below("rigs/{rig}/models_{seed}.json"),
        cells=PATHS.below("rigs/{rig}/grids_{seed}.json"),
        measures=PATHS.below("rigs/{rig}/control_{seed}.json"),
    log:
        PATHS.messages("replicate_on_rig_{rig}_{seed}"),
    wildcard_constraints:
        rig="|".join(RIG_FILES) or "none",
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
        models=lambda wildcards: on_rigs("models", wildcards.table),
        grids=lambda wildcards: on_rigs("grids", wildcards.table),
        controls=lambda wildcards: on_rigs("control", wildcards.table),
    output:
        **PATHS.table("rigs/{table}"),
    log:
        PATHS.messages("{table}_table"),
    wildcard_constraints:
        table="|".join(RIGS),
    params:
        **stage("rigs.compare_rigs"),
        fitted=lambda wildcards: {
            SETTINGS["fitted"]["name"]: SETTINGS["fitted"]["to"],
            **{rig: named_rig(rig)["fitted"]["to"] for rig in RIGS[wildcards.table]},
        },
        deciding=SETTINGS["evaluation"]["verdict_seeds"],
        brief=lambda wildcards: wildcards.table == "searches",
    message:
        "Rigs side by side: {wildcards.table}"
    script:
        "../scripts/stage.py"


rule targets_table:
    input:
        published=PUBLISHED,
        replicates=PLAN.replicates("models", TARGET_NAMES),
        controls=PLAN.replicates("control", TARGET_NAMES),
    output:
        **PATHS.table("calibration/targets"),
    log:
        PATHS.messages("targets_table"),
    params:
        **stage("tabulate.tabulate_targets"),
        names=TARGET_NAMES,
    message:
        "Commanded compared with measured pressure as the models' target"
    script:
        "../scripts/stage.py"


rule calibration_page:
    input:
        fit=lambda wildcards: rig_file(SETTINGS["fitted"]["name"]).with_suffix(".json"),
        seeds=[path.replace(".md", ".csv") for path in PLAN.seeds_tables[:2]],
        pages=[
            PLAN.seeds_tables[2],
            PATHS.below("rigs/rigs.md"),
            PATHS.below("rigs/searches.md"),
            PATHS.below("ensemble/claims.md"),
            PATHS.below("posterior/claims.md"),
            PATHS.below("posterior/history.md"),
            PATHS.below("calibration/sensitivity.md"),
            PATHS.below("calibration/targets.md"),
        ],
        figures=[
            PATHS.below(f"{name}.png")
            for name in (
                "ensemble/claims",
                "posterior/claims",
                "rigs/front",
                "calibration/channels",
            )
        ],
        made_from=[
            *CHUNK_FILES,
            *MEMBER_FILES,
            PATHS.below("ensemble/summary.json"),
            PATHS.below("calibration/sensitivity.json"),
            *PLAN.replicates("models", TARGET_NAMES),
            *PLAN.replicates("control", TARGET_NAMES),
        ],
    log:
        PATHS.messages("calibration_page"),
    localrule: True
    params:
        **stage("documents.update_calibration_page"),
        page="docs/calibration.md",
        pictures=[
            f"docs/images/{name}.png" for name in ("ensemble", "posterior", "front", "channels")
        ],
        rig=SETTINGS["rig"],
    message:
        "docs/calibration.md: numbers and picture from the results"
    script:
        "../scripts/stage.py"


rule calibrate:
    input:
        PATHS.below("calibration/rig.yaml"),
        PATHS.below("calibration/fit.json"),
    localrule: True


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
        PATHS.below("posterior/history.md"),
        PATHS.below("posterior/summary.json"),
        MEMBER_FILES,
    localrule: True


rule sensitivity:
    input:
        PATHS.below("calibration/sensitivity.md"),
        PATHS.below("calibration/sensitivity.json"),
    localrule: True


rule targets:
    input:
        PATHS.below("calibration/targets.md"),
        PLAN.replicates("models", TARGET_NAMES),
        PLAN.replicates("control", TARGET_NAMES),
    localrule: True


rule front_figure:
    input:
        fits=[
            *(
                local(str(fit))
                for path in rig_files().values()
                if (fit := path.with_suffix(".json")).exists()
            ),
            *map(local, map(str, sorted(SEARCHES.glob("*.json")))),
        ],
    output:
        **drawn(PATHS.below("rigs/front"), statistics=True),
    log:
        PATHS.messages("front_figure"),
    params:
        **stage("draw_ensemble.draw_front"),
    message:
        "Searches: tables against claims"
    script:
        "../scripts/stage.py"


rule channels_figure:
    input:
        sweep=PATHS.log("sweep"),
    output:
        **drawn(PATHS.below("calibration/channels"), statistics=True),
    log:
        PATHS.messages("channels_figure"),
    params:
        **stage("draw.draw_channels"),
    message:
        "C18: loops over the commanded and over the measured pressure"
    script:
        "../scripts/stage.py"


rule rigs:
    input:
        PATHS.below("rigs/rigs.md"),
        *(on_rigs(part, "rigs") for part in ("models", "grids", "control")),
    localrule: True


rule searches:
    input:
        PATHS.below("rigs/searches.md"),
        PATHS.below("rigs/front.pdf"),
        *(on_rigs(part, "searches") for part in ("models", "grids", "control")),
    localrule: True
