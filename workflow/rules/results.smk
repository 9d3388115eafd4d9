# The rules of TABLES and FIGURES.

for rule_name, shown in (TABLES | FIGURES).items():

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
        params:
            **shown.params,
        message:
            shown.words
        script:
            "../scripts/stage.py"
