# The rules of LONG_JOBS, STUDY_RESULTS and STUDY_TARGETS.

for rule_name, job in LONG_JOBS.items():

    rule:
        name:
            rule_name
        input:
            **job.given,
        output:
            **job.made,
        log:
            PATHS.messages("_".join(Path(job.stem).parts)),
        priority: job.priority
        threads: job.threads
        resources:
            mem_mb=memory_of,
            runtime=job.runtime,
        params:
            **job.params,
            workers=lambda wildcards, threads: threads,
            checkpoint=with_prefix(PATHS.below(f"{job.stem}.partial.jsonl")),
        message:
            job.words
        script:
            "../scripts/stage.py"


for rule_name, shown in STUDY_RESULTS.items():

    rule:
        name:
            rule_name
        input:
            **shown.given,
        output:
            **shown.made,
        log:
            shown.log,
        params:
            **shown.params,
        message:
            f"{shown.words}, {shown.kind}"
        script:
            "../scripts/stage.py"


for target, files in STUDY_TARGETS.items():

    rule:
        name:
            target
        input:
            files,
        localrule: True
