"""Judge the claims on every rig of the ensemble."""

from collections.abc import Sequence

from fprc.artifacts import read_json, write_json
from fprc.claims import Results, judge_claims
from fprc.claims.ensemble import JUDGED_BY_RIG, shares_of
from fprc.errors import FprcError
from fprc.yaml_file import read_yaml


def summarise_rigs(published: str, chunks: Sequence[str], summary: str) -> None:
    """Judge the claims rig by rig; write shares, intervals and correlations."""
    printed = read_yaml(published)
    rigs = [rig for path in chunks for rig in read_json(path)["rigs"]]
    good = [rig for rig in rigs if "failed" not in rig]
    if not good:
        raise FprcError(
            f"none of the {len(rigs)} rigs of the ensemble could be judged; the first: "
            f"{rigs[0]['failed']}"
        )
    claims = [claim for claim in printed["claims"] if claim["id"] in JUDGED_BY_RIG]
    verdicts = [
        {
            row["id"]: row["verdict"]
            for row in judge_claims(
                claims, Results([rig["compared"]], [], [rig["measured"]], {}, {}), printed
            )
        }
        for rig in good
    ]
    parameters = [rig["parameters"] for rig in good]
    write_json(
        summary,
        {
            "source": "sim",
            "seeds": [rig["seed"] for rig in rigs],
            "parameters": list(parameters[0]),
            "rigs": len(rigs),
            "failed": len(rigs) - len(good),
            "draws": sum(rig["draws"] for rig in rigs),
            "claims": shares_of(claims, verdicts, parameters),
        },
    )
