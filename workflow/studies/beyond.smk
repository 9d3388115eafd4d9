# Beyond the paper: competitors of its models, on several worlds of simulated rigs.

#: Settings of the tuned models; they were made by this workflow.
TUNED = file_of_workflow("../../config/tuned.yaml")
#: Families: the rig of the configuration, every other named rig, and the sets of rigs.
CONFIGURED_WORLD = SETTINGS["fitted"]["name"]
WORLDS = [CONFIGURED_WORLD, *OTHER_RIGS, *SETS]
#: Figures: their tables, stages and captions.
FIGURES_BEYOND = {
    "pairs": (
        "claims",
        stage("studies.show_beyond.draw_pairs") | {"worlds": WORLDS},
        "error ratios of pairs of models",
    ),
    "tracking": (
        "tracking",
        stage("studies.show_beyond.draw_tracking") | {"world": CONFIGURED_WORLD},
        "tracking errors against test errors",
    ),
    "offsets": (
        "offsets",
        stage("studies.show_beyond.draw_offsets") | {"world": CONFIGURED_WORLD},
        "offset of P_o",
    ),
    "capacities": (
        "capacities",
        stage("studies.show_beyond.draw_capacities") | {"world": CONFIGURED_WORLD},
        "capacities",
    ),
    "settings": (
        "settings",
        stage("studies.show_beyond.draw_settings"),
        "what P_o is worth over epsilon and n_c",
    ),
}
CONTEST = {
    "models": paper_models(SETTINGS),
    "tracking": SETTINGS["tracking"],
    "restarts": BEYOND["restarts"],
    **BEYOND["disturbances"],
}


rule beyond_world:
    input:
        near_print=NEAR_PRINT,
        tuned=TUNED,
    output:
        judged=PATHS.below("beyond/{world}.json"),
    log:
        PATHS.messages("beyond_{world}"),
    wildcard_constraints:
        world="|".join(WORLDS),
    threads: workflow.cores
    resources:
        mem_mb=memory_of,
        runtime=120,
    params:
        **judging("beyond.contest.judge_models", *COMPETITORS),
        families=lambda wildcards: [world_of(wildcards)],
        units=lambda wildcards: list(range(units_of(wildcards))),
        how={"contest": CONTEST, "slow": BEYOND["slow"]},
        workers=workers_over(units_of),
        checkpoint=placed(PATHS.below("beyond/{world}.partial.jsonl")),
    message:
        "Beyond the paper: the models and their competitors, world {wildcards.world}, workers: {params.workers}"
    script:
        "../scripts/stage.py"


rule tune_world:
    input:
        near_print=NEAR_PRINT,
    output:
        tuning=PATHS.below("beyond/tuning_{world}.json"),
    log:
        PATHS.messages("tune_{world}"),
    wildcard_constraints:
        world="|".join(WORLDS),
    threads: workflow.cores
    resources:
        mem_mb=memory_of,
        runtime=120,
    params:
        **stage("studies.beyond.tune_world", *COMPETITORS, key="version"),
        world=world_of,
        units=units_of_tuning,
        candidates=BEYOND["tuning"]["candidates"],
        seed=BEYOND["tuning"]["seed"],
        restarts=BEYOND["restarts"],
        judgement=judgement(SETTINGS, models=paper_models(SETTINGS), split="blocked"),
        workers=workers_over(BEYOND["tuning"]["units"] * BEYOND["tuning"]["candidates"]),
        checkpoint=placed(PATHS.below("beyond/tuning_{world}.partial.jsonl")),
    message:
        "Beyond the paper: tuning of the competitors, world {wildcards.world}"
    script:
        "../scripts/stage.py"


rule join_tuned:
    input:
        tunings=expand(PATHS.below("beyond/tuning_{world}.json"), world=WORLDS),
    output:
        tuned=PATHS.below("beyond/tuned.yaml"),
    log:
        PATHS.messages("join_tuned"),
    params:
        **stage("studies.beyond.join_tuned"),
    message:
        "Beyond the paper: settings of the tuned competitors"
    script:
        "../scripts/stage.py"


rule beyond_training:
    input:
        tuned=TUNED,
    output:
        judged=PATHS.below("beyond/training_logs.json"),
    log:
        PATHS.messages("beyond_training"),
    threads: workflow.cores
    resources:
        mem_mb=memory_of,
        runtime=120,
    params:
        **judging("beyond.contest.judge_lengths", *COMPETITORS),
        families=lambda wildcards: [family_named(CONFIGURED_WORLD)],
        units=list(range(BEYOND["training"]["seeds"])),
        how={
            "contest": CONTEST,
            "seconds": BEYOND["training"]["seconds"],
            "second_log": {
                **SETTINGS["experiments"]["complex"],
                "f_hz": BEYOND["training"]["second_f_hz"],
            },
        },
        workers=workers_over(BEYOND["training"]["seeds"]),
        checkpoint=placed(PATHS.below("beyond/training_logs.partial.jsonl")),
    message:
        "Beyond the paper: length and number of the training logs"
    script:
        "../scripts/stage.py"


rule beyond_steps:
    input:
        tuned=TUNED,
    output:
        judged=PATHS.below("beyond/steps.json"),
    log:
        PATHS.messages("beyond_steps"),
    priority: ALONE
    threads: workflow.cores
    params:
        **judging("beyond.contest.judge_steps", *COMPETITORS),
        families=lambda wildcards: [family_named(CONFIGURED_WORLD)],
        units=[0],
        how={"contest": CONTEST},
        workers=1,
        checkpoint=placed(PATHS.below("beyond/steps.partial.jsonl")),
    message:
        "Beyond the paper: time of a step"
    script:
        "../scripts/stage.py"


rule tuned:
    input:
        PATHS.below("beyond/tuned.yaml"),
    localrule: True


rule beyond_capacity:
    output:
        judged=PATHS.below("beyond/capacity.json"),
    log:
        PATHS.messages("beyond_capacity"),
    threads: workflow.cores
    resources:
        mem_mb=memory_of,
        runtime=120,
    params:
        **judging("beyond.driven_states.judge_capacity"),
        families=one_rig_each,
        units=list(range(BEYOND["capacity"]["seeds"])),
        how={
            "models": pick(SETTINGS["models"], "n_y", "fprc", "esn"),
            "capacity": {
                key: value for key, value in BEYOND["capacity"].items() if key != "seeds"
            },
        },
        workers=workers_over(BEYOND["capacity"]["seeds"] * (1 + len(OTHER_RIGS))),
        checkpoint=placed(PATHS.below("beyond/capacity.partial.jsonl")),
    message:
        "Beyond the paper: memory and nonlinear capacity"
    script:
        "../scripts/stage.py"


rule beyond_settings:
    input:
        tuned=TUNED,
    output:
        judged=PATHS.below("beyond/settings.json"),
    log:
        PATHS.messages("beyond_settings"),
    threads: workflow.cores
    resources:
        mem_mb=memory_of,
        runtime=120,
    params:
        **judging("beyond.contest.judge_settings", *COMPETITORS),
        families=one_rig_each,
        units=list(range(BEYOND["training"]["seeds"])),
        how={"contest": CONTEST, "grids": pick(SETTINGS["grids"], "epsilon", "n_c")},
        workers=workers_over(BEYOND["training"]["seeds"] * (1 + len(OTHER_RIGS))),
        checkpoint=placed(PATHS.below("beyond/settings.partial.jsonl")),
    message:
        "Beyond the paper: FPRC with and without P_o over epsilon and n_c"
    script:
        "../scripts/stage.py"


rule beyond_tables:
    input:
        worlds=expand(PATHS.below("beyond/{world}.json"), world=WORLDS),
        capacity=PATHS.below("beyond/capacity.json"),
        training=PATHS.below("beyond/training_logs.json"),
        steps=PATHS.below("beyond/steps.json"),
        over_settings=PATHS.below("beyond/settings.json"),
    output:
        verdicts=PATHS.below("beyond/claims.json"),
        models=PATHS.below("beyond/models.csv"),
        claims=PATHS.below("beyond/claims.csv"),
        tracking=PATHS.below("beyond/tracking.csv"),
        offsets=PATHS.below("beyond/offsets.csv"),
        capacities=PATHS.below("beyond/capacities.csv"),
        lengths=PATHS.below("beyond/lengths.csv"),
        settings=PATHS.below("beyond/settings.csv"),
    log:
        PATHS.messages("beyond_tables"),
    params:
        **stage("studies.show_beyond.tabulate_beyond"),
    message:
        "Beyond the paper: claims B1 to B8, tables"
    script:
        "../scripts/stage.py"


for figure_name, (table, shown, words) in FIGURES_BEYOND.items():

    rule:
        name:
            f"draw_{figure_name}"
        input:
            **{table: PATHS.below(f"beyond/{table}.csv")},
        output:
            **drawn(PATHS.below(f"beyond/figure_{figure_name}")),
        log:
            PATHS.messages(f"draw_{figure_name}"),
        params:
            **shown,
        message:
            f"Beyond the paper: {words}, figure"
        script:
            "../scripts/stage.py"


rule beyond:
    input:
        PATHS.below("beyond/claims.json"),
        expand(PATHS.below("beyond/figure_{name}.pdf"), name=FIGURES_BEYOND),
        expand(PATHS.below("beyond/{world}.json"), world=WORLDS),
        PATHS.below("beyond/capacity.json"),
        PATHS.below("beyond/training_logs.json"),
        PATHS.below("beyond/steps.json"),
    localrule: True
