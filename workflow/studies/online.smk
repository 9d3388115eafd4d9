# A model that learns while it runs, on families of rigs with a disturbed P_o.

#: First seed of the study; no other study has seen it.
FIRST_ONLINE = 1001


use rule judge_family as judge_online with:
    input:
        ensemble=ENSEMBLE,
    output:
        judged=PATHS.below("online/{world}.json"),
    log:
        PATHS.messages("judge_online_{world}"),
    params:
        version=studies_with(*COMPETITORS),
        judge="online.judge.judge_online",
        family=lambda wildcards: (family_named(wildcards.world) | {"first_seed": FIRST_ONLINE}),
        units=list(range(min(BEYOND["units"], 10))),  # fewer than eight decide nothing
        how={"tracking": SETTINGS["tracking"], "models": paper_models(SETTINGS)},
        checkpoint=checkpoint_of("online/{world}"),
    message:
        "Family {wildcards.world}: a model that learns while it runs"


rule tabulate_verdicts:
    input:
        families=expand(PATHS.below("online/{world}.json"), world=FAMILIES),
    output:
        csv=PATHS.below("online/verdicts.csv"),
        md=PATHS.below("online/verdicts.md"),
    log:
        PATHS.messages("tabulate_verdicts"),
    params:
        stage="studies.stages.online.tabulate_verdicts",
        code=SHOWS,
    message:
        "Verdicts on learning while it runs"
    script:
        "../scripts/stage.py"


use rule tabulate_verdicts as tabulate_errors with:
    output:
        csv=PATHS.below("online/errors.csv"),
        md=PATHS.below("online/errors.md"),
    log:
        PATHS.messages("tabulate_errors"),
    params:
        stage="studies.stages.online.tabulate_errors",
    message:
        "Errors with and without learning"


rule draw_online:
    input:
        errors=PATHS.below("online/errors.csv"),
    output:
        pdf=PATHS.below("online/figure.pdf"),
        png=PATHS.below("online/figure.png"),
    log:
        PATHS.messages("draw_online"),
    params:
        stage="studies.stages.online.draw_online",
        code=SHOWS,
        names=FAMILIES[:3],
    message:
        "Figure of learning while it runs"
    script:
        "../scripts/stage.py"


STUDY_TARGETS["online"] = [
    PATHS.below("online/verdicts.md"),
    PATHS.below("online/errors.md"),
    PATHS.below("online/figure.pdf"),
    *rules.tabulate_errors.input,
]
