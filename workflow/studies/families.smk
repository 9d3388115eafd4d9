# Families of simulated rigs, named ones with several seeds and the ensemble: the paper's claims on
# the ensemble, models beyond the paper's, and a model that learns while it runs.


rule judge_family:
    input:
        ensemble=ENSEMBLE,
    output:
        judged=f"{RESULTS}/{{study}}/{{family}}.json",
    log:
        f"{RESULTS}/logs/judge_{{study}}_{{family}}.log",
    wildcard_constraints:
        study="|".join(STUDIES),
        family="|".join(FAMILIES),
    threads: workflow.cores
    resources:
        # each process holds the logs and one model
        mem_mb=lambda wildcards, threads: 1000 * (1 + threads),
        runtime=120,
    params:
        stage="studies.family.judge_family",
        code=code_that_computes(*COMPETITORS, also=("studies",)),
        judge=lambda wildcards: STUDIES[wildcards.study]["judge"],
        how=lambda wildcards: STUDIES[wildcards.study]["how"],
        family=family_of,
        units=lambda wildcards: list(range(STUDIES[wildcards.study].get("units", BEYOND["units"]))),
        workers=lambda wildcards, threads: threads,
    message:
        "Family {wildcards.family}: {wildcards.study}"
    script:
        "../scripts/stage.py"


rule count_members:
    input:
        judged=f"{RESULTS}/families/ensemble.json",
    output:
        members=f"{RESULTS}/families/members.json",
    log:
        f"{RESULTS}/logs/count_members.log",
    params:
        stage="studies.family.count_members",
        code=SHOWS,
    message:
        "On how many rigs of the ensemble each claim holds"
    script:
        "../scripts/stage.py"


rule tabulate_beyond:
    input:
        families=expand(f"{RESULTS}/beyond/{{family}}.json", family=FAMILIES),
    output:
        **{name: f"{RESULTS}/beyond/{name}.csv" for name in PAGES_BEYOND[:2]},
        pages=expand(f"{RESULTS}/beyond/{{page}}.md", page=PAGES_BEYOND),
        figure=[f"{RESULTS}/beyond/figure_pairs.pdf", f"{RESULTS}/beyond/figure_pairs.png"],
    log:
        f"{RESULTS}/logs/tabulate_beyond.log",
    params:
        stage="studies.beyond.tabulate_beyond",
        code=SHOWS,
        family=CONFIGURED,
    message:
        "Claims and models beyond the paper"
    script:
        "../scripts/stage.py"


rule tabulate_online:
    input:
        families=expand(f"{RESULTS}/online/{{family}}.json", family=FAMILIES),
    output:
        verdicts=table("online/verdicts")[:2],
        errors=table("online/errors")[:2],
        figure=[f"{RESULTS}/online/figure.pdf", f"{RESULTS}/online/figure.png"],
    log:
        f"{RESULTS}/logs/tabulate_online.log",
    params:
        stage="studies.online.tabulate_online",
        code=SHOWS,
        shown=FAMILIES[:3],
    message:
        "Verdicts and errors of learning while it runs"
    script:
        "../scripts/stage.py"


#: Files of each target; the Snakefile has their rules.
STUDY_TARGETS = {
    "families": [*rules.count_members.output, *rules.count_members.input],
    "beyond": [*rules.tabulate_beyond.output, *rules.tabulate_beyond.input],
    "online": [*rules.tabulate_online.output, *rules.tabulate_online.input],
}
