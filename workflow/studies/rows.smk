# The rules of STUDY_RESULTS and STUDY_TARGETS.

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
        priority: shown.priority
        threads: shown.threads
        resources:
            **shown.resources,
        params:
            **shown.params,
        message:
            shown.words
        script:
            "../scripts/stage.py"


for target, files in STUDY_TARGETS.items():

    rule:
        name:
            target
        input:
            files,
        localrule: True
