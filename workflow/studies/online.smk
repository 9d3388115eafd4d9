# A model that learns while it runs, on families of rigs with a disturbed P_o.

ONLINE = SETTINGS["online"]


rule judge_online:
    input:
        near_print=NEAR_PRINT,
    output:
        judged=PATHS.below("online/{world}.json"),
    log:
        PATHS.messages("online_{world}"),
    wildcard_constraints:
        world="|".join(WORLDS),
    threads: workflow.cores
    resources:
        mem_mb=memory_of,
        runtime=120,
    params:
        **judging("online.judge.judge_online", *COMPETITORS),
        families=lambda wildcards: [
            world_of(wildcards) | {"first_seed": ONLINE["first_seed"], "seeds_per_rig": 1}
        ],
        units=list(range(ONLINE["units"])),
        how={"tracking": SETTINGS["tracking"], "models": paper_models(SETTINGS)},
        workers=workers_over(ONLINE["units"]),
        checkpoint=placed(PATHS.below("online/{world}.partial.jsonl")),
    message:
        "Learning while it runs: family {wildcards.world}"
    script:
        "../scripts/stage.py"


for table in ("verdicts", "errors"):

    rule:
        name:
            f"online_{table}"
        input:
            families=expand(PATHS.below("online/{world}.json"), world=WORLDS),
        output:
            **PATHS.table(f"online/{table}"),
        log:
            PATHS.messages(f"online_{table}"),
        params:
            **stage("studies.online.tabulate_online"),
            table=table,
        message:
            f"Learning while it runs: {table}, table"
        script:
            "../scripts/stage.py"


rule online_figure:
    input:
        errors=PATHS.below("online/errors.csv"),
    output:
        **drawn(PATHS.below("online/figure")),
    log:
        PATHS.messages("online_figure"),
    params:
        **stage("studies.online.draw_online"),
        names=WORLDS[:3],
    message:
        "Learning while it runs: tracking error over the offset of P_o, figure"
    script:
        "../scripts/stage.py"


rule online:
    input:
        expand(PATHS.below("online/{table}.md"), table=("verdicts", "errors")),
        PATHS.below("online/figure.pdf"),
    localrule: True
