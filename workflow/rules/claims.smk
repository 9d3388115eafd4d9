# The ledger of the paper's claims; the check of its verdicts and of what lies in the folders.


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


if "check" not in UNAVAILABLE:

    rule check:
        input:
            ledger=f"{RESULTS}/claims.json",
            known="config/verdicts.yaml",
        log:
            f"{RESULTS}/logs/check.log",
        localrule: True
        params:
            folders=SETTINGS["folders"],
            made=lambda wildcards: made_by_rules(),
            # the documentation shows the paper's results, not those of other settings
            pictures=lambda wildcards: pictures_of_documentation() if RESULTS == "results" else {},
            code=code_of("check"),
        message:
            "Verdicts against those declared in config/verdicts.yaml, files, pictures"
        script:
            "../scripts/check.py"
