"""The paper's claims C1 to C22, tested on result files; verdicts are computed, never typed."""

from pathlib import Path

#: Declared verdicts, and the sentences of the paper that are not tested.
VERDICTS = Path(__file__).with_name("verdicts.yaml")

#: On how many rigs of the ensemble each claim holds, see ``fprc.claims.ledger.Members``.
MEMBERS = Path(__file__).with_name("members.json")
