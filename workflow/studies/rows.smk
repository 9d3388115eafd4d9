# The rules of JUDGED, STUDY_TABLES, STUDY_FIGURES and STUDY_TARGETS.

for rule_name, judged in JUDGED.items():

    rule:
        name:
            rule_name
        input:
            **judged.given,
        output:
            judged=PATHS.below(f"{judged.stem}.json"),
        log:
            PATHS.messages("_".join(Path(judged.stem).parts)),
        priority: judged.priority
        threads: judged.threads
        resources:
            mem_mb=memory_of,
            runtime=120,
        params:
            **judged.params,
            stage="studies.judge.judge_families",
            workers=one_per_thread,
            checkpoint=with_prefix(PATHS.below(f"{judged.stem}.partial.jsonl")),
        message:
            judged.words
        script:
            "../scripts/stage.py"


for rule_name, shown in STUDY_TABLES.items():

    rule:
        name:
            rule_name
        input:
            **shown.given,
        output:
            **PATHS.table(shown.stem),
        log:
            PATHS.messages(rule_name),
        params:
            **shown.params,
        message:
            f"{shown.words}, table"
        script:
            "../scripts/stage.py"


for rule_name, shown in STUDY_FIGURES.items():

    rule:
        name:
            rule_name
        input:
            **shown.given,
        output:
            **figure_files(PATHS.below(shown.stem), shown.statistics),
        log:
            PATHS.messages(rule_name),
        params:
            **shown.params,
        message:
            f"{shown.words}, figure"
        script:
            "../scripts/stage.py"


for target, files in STUDY_TARGETS.items():

    rule:
        name:
            target
        input:
            files,
        localrule: True
