# Targets that a user can name: one for each named output of the rules in SHOWN.

#: Files of each result, and of each target: a result, then what it is made from. Otherwise a result
#: of an earlier run would count as complete after a job has failed, since Snakemake removes only the
#: outputs of that job.
MADE = {target: list(files) for shown in SHOWN for target, files in shown.output.items()}
TARGETS = {
    target: [*MADE[target], *shown.input] for shown in SHOWN for target in shown.output.keys()
}
TARGETS["report"] = [PATHS.below("report.html"), *sorted(set(sum(TARGETS.values(), [])))]

for target, files in TARGETS.items():

    rule:
        name:
            target
        input:
            files,
        localrule: True
        message:
            f"Target {target}"


for target in PLAN.unavailable:

    rule:
        name:
            target
        log:
            PATHS.messages(target),
        localrule: True
        message:
            PLAN.refusal(target)
        shell:
            "exit 1"


rule logs:
    input:
        [PATHS.log(experiment) for experiment in PLAN.experiments],
    localrule: True
    message:
        "Target logs"
