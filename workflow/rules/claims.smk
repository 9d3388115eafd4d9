# The ledger of the paper's claims, and the check of its verdicts.


rule ledger:
    input:
        published="config/published.yaml",
        replicates=REPLICATES,
        times=TIMES[0],
        times_over_n_c=TIMES[1],
        weights=f"{RESULTS}/weights/fprc.json",
        sweeps=list(SWEEPS.values()),
        runs=[path for paths in TRACKED.values() for path in paths],
        sweep=f"{RESULTS}/data/sweep.h5",
    output:
        json=f"{RESULTS}/claims.json",
        md=f"{RESULTS}/claims.md",
    log:
        f"{RESULTS}/logs/ledger.log",
    params:
        quiet_s=SETTINGS["tracking"]["pushes"]["quiet_s"],
        code=code_of("claims"),
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
        code=code_of("claims"),
    message:
        "Verdicts against those declared in config/verdicts.yaml"
    script:
        "../scripts/check.py"
