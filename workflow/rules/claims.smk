# The ledger of the paper's claims; the check of its verdicts and of what lies in the folders.
from snakemake.io import regex_from_filepattern


def made_by_rules():
    """Return regular expressions of all that the rules write: outputs, logs, checkpoints."""
    checkpoints = [rule.params.get("checkpoint") for rule in workflow.rules]
    kept = [rf"{regex_from_filepattern(path)}(\.old)?" for path in checkpoints if path]
    files = [path for rule in workflow.rules for path in (*rule.output, *rule.log)]
    return sorted({path.regex().pattern for path in files}.union(kept))


def pictures_of_documentation():
    """Return the pictures that rules put into the documentation, and the figures they are."""
    rules = [rule for rule in workflow.rules if rule.params.get("picture")]
    return {rule.params.picture: str(rule.input.figure) for rule in rules}


rule ledger:
    input:
        published="config/published.yaml",
        replicates=REPLICATES,
        sweeps=REPLICATED_SWEEPS,
        controls=REPLICATED_CONTROL,
        times=TIMES[0],
        times_over_n_c=TIMES[1],
    output:
        json=f"{RESULTS}/claims.json",
        md=f"{RESULTS}/claims.md",
    log:
        f"{RESULTS}/logs/ledger.log",
    params:
        code=code_of("ledger"),
    message:
        "Claims C1 to C18"
    script:
        "../scripts/ledger.py"


rule check:
    input:
        ledger=f"{RESULTS}/claims.json",
        known="config/verdicts.yaml",
    log:
        f"{RESULTS}/logs/check.log",
    localrule: True
    params:
        results=RESULTS,
        raw=RAW,
        made=lambda wildcards: made_by_rules(),
        # the documentation shows the paper's results, not those of other settings
        pictures=lambda wildcards: pictures_of_documentation() if RESULTS == "results" else {},
        code=code_of("check"),
    message:
        "Verdicts against those declared in config/verdicts.yaml, files, pictures"
    script:
        "../scripts/check.py"
