"""The paper's claims C1 to C22, tested on result files; verdicts are computed, never typed."""

from pathlib import Path

#: Texts and declared verdicts of the claims, and the sentences of the paper that are not tested.
TEXTS = Path(__file__).with_name("claims.yaml")
