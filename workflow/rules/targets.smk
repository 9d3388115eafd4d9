# What a user asks for by name.


for target in REFUSED:

    rule:
        name:
            target
        input:
            refused(target),
        localrule: True


for target, files in TARGETS.items():

    rule:
        name:
            target
        input:
            files,
        localrule: True


rule logs:
    input:
        expand("{raw}/{experiment}.h5", raw=RAW, experiment=LOGS),
    localrule: True


rule smoke:
    log:
        f"{RESULTS}/logs/smoke.log",
    localrule: True
    threads: workflow.cores
    message:
        "The whole workflow on small settings, into results/smoke"
    shell:
        "snakemake --cores {threads} --nolock --configfile config/smoke.yaml"
        " -- all 2>&1 | tee {log:q}"


if "readme" not in UNAVAILABLE:

    rule readme:
        input:
            pages=[
                *(TABLES[number] for number in (2, 3, 4)),
                *SEEDS_TABLES[:3],
                *TIMING,
                READOUT,
            ],
            orders=SEEDS_TABLES[3],
            seeds=[path.replace(".md", ".csv") for path in SEEDS_TABLES[:2]],
            ledger=f"{RESULTS}/claims.json",
            figure=f"{RESULTS}/figures/fig08_training.png",
            made_from=sorted(set(sum(TARGETS.values(), []))),
        log:
            f"{RESULTS}/logs/readme.log",
        localrule: True
        params:
            readme="README.md",
            picture="docs/images/fig08_training.png",
            code=code_of("readme"),
        message:
            "Numbers and picture of the README, from the results"
        script:
            "../scripts/readme.py"
