# Simulated rigs side by side: those that can be named, end points of searches, repeats of the fit, and
# fits with other settings.

#: Folders of the end points of searches, repeats of the fit, and fits with other settings, docs/searches.md.
SEARCHES, REPEATS, VARIANTS = (
    Path("config/rigs", name) for name in ("searches", "repeats", "variants")
)
#: Rigs that can be named, beside that of the configuration.
OTHER_RIGS = {
    name: path for name, path in rig_files().items() if name != SETTINGS["fitted"]["name"]
}
#: Tables of rigs side by side, by their folder: rigs that were fitted, and end points of searches.
RIGS = {
    "rigs": {name: path for name, path in OTHER_RIGS.items() if path.with_suffix(".json").exists()},
    "searches": {path.stem: path for path in sorted(SEARCHES.glob("*.yaml"))},
}
REPEATED, VARIED = (
    {path.stem: path for path in sorted(folder.glob("*.yaml"))} for folder in (REPEATS, VARIANTS)
)
# a fit that has another rig's name gives way here, and is refused when the repeats are judged
RIG_FILES = VARIED | REPEATED | RIGS["searches"] | OTHER_RIGS
#: Seeds that judge the end points of searches.
SEARCH_SEEDS = 10


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


rule repeats_table:
    input:
        published=PUBLISHED,
        models=lambda wildcards: of_repeats("models", wildcards.table),
        grids=lambda wildcards: of_repeats("grids", wildcards.table),
        controls=lambda wildcards: of_repeats("control", wildcards.table),
    output:
        **PATHS.table("rigs/{table}"),
    log:
        PATHS.messages("{table}_table"),
    wildcard_constraints:
        table="repeats|spread",
    params:
        **stage("rigs.compare_repeats"),
        rigs=lambda wildcards: fits_of(wildcards.table).rigs,
        limits=lambda wildcards: fits_of(wildcards.table).limits,
        spread_of=lambda wildcards: fits_of(wildcards.table).spread_of,
    message:
        "Repeats of the fit: {wildcards.table}"
    script:
        "../scripts/stage.py"


rule variants_table:
    input:
        published=PUBLISHED,
        models=lambda wildcards: of_repeats("models", "variants"),
        grids=lambda wildcards: of_repeats("grids", "variants"),
        controls=lambda wildcards: of_repeats("control", "variants"),
    output:
        **PATHS.table("rigs/variants"),
    log:
        PATHS.messages("variants_table"),
    params:
        **stage("rigs.compare_variants"),
        repeats=lambda wildcards: fits_of("variants").repeats,
        variants=lambda wildcards: fits_of("variants").variants,
    message:
        "Fits with other settings, beside repeats of the fit"
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
        **stage("rigs.tabulate_answer"),
    message:
        "Worth of the reservoir on all rigs"
    script:
        "../scripts/stage.py"


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
        "Searches: trade-off between tables and claims"
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


rule repeats:
    input:
        tables_of_repeats,
        lambda wildcards: [
            path
            for table in tests_of_repeats()
            for part in ("models", "grids", "control")
            for path in of_repeats(part, table)
        ],
    localrule: True


rule variants:
    input:
        PATHS.below("rigs/variants.md"),
        *(
            lambda wildcards, part=part: of_repeats(part, "variants")
            for part in ("models", "grids", "control")
        ),
    localrule: True
