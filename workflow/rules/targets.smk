# Targets that a user can name.


for target in PLAN.unavailable:

    rule:
        name:
            target
        input:
            refused(PLAN.refusal(target)),
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
        message:
            f"Target {target}"


rule logs:
    input:
        [PATHS.log(experiment) for experiment in PLAN.experiments],
    localrule: True
    message:
        "Target logs"
