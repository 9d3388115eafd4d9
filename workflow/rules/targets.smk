# What a user asks for by name.


rule logs:
    input:
        expand("{raw}/{experiment}.h5", raw=RAW, experiment=EXPERIMENTS),
    localrule: True


rule table1:
    input:
        TABLES[0],
    localrule: True


rule table2:
    input:
        TABLES[1],
    localrule: True


rule table3:
    input:
        TABLES[2],
    localrule: True


rule table4:
    input:
        TABLES[3],
    localrule: True


rule seeds:
    input:
        SEEDS_TABLES,
    localrule: True


rule timing:
    input:
        TIMING,
    localrule: True


rule fig4:
    input:
        FIGURES["fig04"],
    localrule: True


rule fig5:
    input:
        FIGURES["fig05"],
    localrule: True


rule fig8:
    input:
        FIGURES["fig08"],
    localrule: True


rule fig9:
    input:
        FIGURES["fig09"],
    localrule: True


rule fig10:
    input:
        FIGURES["fig10"],
    localrule: True


rule fig11:
    input:
        FIGURES["fig11"],
    localrule: True


rule fig12:
    input:
        FIGURES["fig12"],
    localrule: True


rule fig13:
    input:
        FIGURES["fig13"],
    localrule: True


rule fig14:
    input:
        FIGURES["fig14"],
    localrule: True


rule fig15:
    input:
        FIGURES["fig15"],
    localrule: True


rule fig16:
    input:
        FIGURES["fig16"],
    localrule: True


rule fig17:
    input:
        FIGURES["fig17"],
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
        " -- all 2>&1 | tee {log}"


rule readme:
    input:
        errors=TABLES[1],
        seeds=SEEDS_TABLES[0],
        orders=SEEDS_TABLES[2],
        timing=f"{RESULTS}/timing/table2_timing.md",
        figure=f"{RESULTS}/figures/fig08_training.png",
    log:
        f"{RESULTS}/logs/readme.log",
    localrule: True
    params:
        readme="README.md",
        picture="docs/images/fig08_training.png",
        code=fingerprint("fprc.stages.readme"),
    message:
        "Numbers and picture of the README, from the results"
    script:
        "../scripts/readme.py"
