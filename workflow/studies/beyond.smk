# Beyond the paper: competitors of its models, on several families of simulated rigs.

#: Families: the rig of the configuration, every other named rig, and the sets of rigs.
CONFIGURED_FAMILY = SETTINGS["fitted"]["name"]
FAMILIES = [CONFIGURED_FAMILY, *OTHER_RIGS, *SETS]
#: Names of the tables in Markdown.
PAGES_BEYOND = "claims models offsets best memory worth fitted details leaderboard".split()
#: Settings of the models and of their competitors, with their own number of starts of a clustering.
CONTESTANTS = paper_models(SETTINGS) | {
    "fprc": SETTINGS["models"]["fprc"] | {"restarts": BEYOND["restarts"]}
}
CONTEST = {
    "models": CONTESTANTS,
    "tracking": SETTINGS["tracking"],
    "shifts_kpa": BEYOND["shifts_kpa"],
}


wildcard_constraints:
    world="|".join(FAMILIES),


use rule judge_family as judge_beyond with:
    input:
        ensemble=ENSEMBLE,
    output:
        judged=PATHS.below("beyond/{world}.json"),
    log:
        PATHS.messages("judge_beyond_{world}"),
    params:
        version=studies_with(*COMPETITORS),
        judge="beyond.contest.judge_models",
        family=lambda wildcards: family_named(wildcards.world),
        how={"contest": CONTEST, "slow": BEYOND["slow"]},
        checkpoint=checkpoint_of("beyond/{world}"),
    message:
        "Family {wildcards.world}: the paper's models and their competitors"


rule tabulate_beyond:
    input:
        families=expand(PATHS.below("beyond/{world}.json"), world=FAMILIES),
    output:
        **{name: PATHS.below(f"beyond/{name}.csv") for name in PAGES_BEYOND[:3]},
        pages=expand(PATHS.below("beyond/{page}.md"), page=PAGES_BEYOND),
    log:
        PATHS.messages("tabulate_beyond"),
    params:
        stage="studies.stages.beyond.tabulate_beyond",
        code=SHOWS,
        family=CONFIGURED_FAMILY,
    message:
        "Claims, models and offsets beyond the paper"
    script:
        "../scripts/stage.py"


rule draw_pairs:
    input:
        claims=PATHS.below("beyond/claims.csv"),
    output:
        pdf=PATHS.below("beyond/figure_pairs.pdf"),
        png=PATHS.below("beyond/figure_pairs.png"),
    log:
        PATHS.messages("draw_pairs"),
    params:
        stage="studies.stages.beyond.draw_pairs",
        code=SHOWS,
    message:
        "Figure of the claims beyond the paper"
    script:
        "../scripts/stage.py"


STUDY_TARGETS["beyond"] = [
    PATHS.below("beyond/claims.md"),
    PATHS.below("beyond/figure_pairs.pdf"),
    *rules.tabulate_beyond.input,
]
