# Targets that a user can name.


for target in PLAN.unavailable_targets:

    rule:
        name:
            target
        input:
            refused(target),
        localrule: True


EVERYTHING = sorted(set(sum(PLAN.targets.values(), [])))
TARGETS = PLAN.targets | {"report": [PATHS.below("report.html"), *EVERYTHING]}

for target, files in TARGETS.items():

    rule:
        name:
            target
        input:
            files,
        localrule: True


rule logs:
    input:
        [PATHS.log(experiment) for experiment in PLAN.experiments],
    localrule: True


rule smoke:
    log:
        PATHS.messages("smoke"),
    localrule: True
    threads: workflow.cores
    message:
        "The whole workflow on small settings, into results/smoke"
    shell:
        "snakemake --cores {threads} --nolock --configfile config/smoke.yaml"
        " -- all 2>&1 | tee {log:q}"


if "readme" not in PLAN.unavailable:

    rule readme:
        input:
            pages=PLAN.pages[1:],
            orders=PATHS.below("tables/orders.csv"),
            seeds=[path.replace(".md", ".csv") for path in PLAN.seeds_tables[:2]],
            ledger=PATHS.below("claims.json"),
            drawn=PATHS.below("ensemble/claims.csv"),
            figure=PATHS.below("figures/fig08_training.png"),
            made_from=TARGETS["report"],
        log:
            PATHS.messages("readme"),
        localrule: True
        params:
            **stage("documents.update_readme"),
            readme="README.md",
            results="docs/results.md",
            picture="docs/images/fig08_training.png",
        message:
            "README.md and docs/results.md: numbers and picture from the results"
        script:
            "../scripts/stage.py"
