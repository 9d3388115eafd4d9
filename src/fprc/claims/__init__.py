"""The paper's claims C1-C18, tested on result files; verdicts are computed, never typed."""
