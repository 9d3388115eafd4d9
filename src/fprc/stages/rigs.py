"""Compare rigs side by side, and judge the claims on sets of many rigs."""

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from fprc import tables
from fprc.artifacts import read_json, write_csv, write_json, write_text
from fprc.claims import Results, judge_claims, parts_of, status_of
from fprc.claims.ensemble import JUDGED_BY_RIG, shares_of
from fprc.claims.ledger import TIMED
from fprc.errors import FprcError
from fprc.paper import SOURCES
from fprc.yaml_file import read_yaml


def compare_rigs(
    published: str,
    models: Sequence[str],
    grids: Sequence[str],
    controls: Sequence[str],
    csv: str,
    md: str,
    tex: str,
    *,
    fitted: Mapping[str, Sequence[str]],
    deciding: int,
    brief: bool = False,
) -> None:
    """Write the table of the rigs; the page, if ``brief``, sums the errors up.

    Parameters
    ----------
    models, grids, controls : sequence of str
        Reports of the further seeds, those of the first rig first, equally many of each.
    fitted : Mapping
        Terms that each rig was fitted to, by its name.
    deciding : int
        Number of the first seeds that decide the verdicts.
    """
    printed = read_yaml(published)
    claims = [claim for claim in printed["claims"] if claim["id"] not in TIMED]
    seeds = len(models) // len(fitted)
    errors, ledgers, sentences = {}, {}, []
    for i, (name, terms) in enumerate(fitted.items()):
        own = slice(i * seeds, (i + 1) * seeds)
        replicates, cells, measures = (
            [read_json(path) for path in paths[own]] for paths in (models, grids, controls)
        )
        errors[name] = tables.rig_errors(replicates, measures, printed)
        results = Results(replicates, cells, measures, {}, {})
        ledgers[name] = [
            {**row, "rig": status_of(row["id"], terms)}
            for row in judge_claims(claims, results.first(deciding), printed)
        ]
        off = 100 * errors[name]["deviation"][:18].abs()
        sentences.append(
            f"Rig {name}: the 18 errors of Tables II and III are off print by "
            f"{np.median(off):.0f} % in the median and {off.max():.0f} % at most."
        )
    source = read_json(models[0])["source"]
    note = (
        f"Rigs side by side: mean and its 95 % interval over {seeds} seeds, deviation from print; "
        f"verdicts of the first {min(deciding, seeds)} seeds.\nData: {SOURCES[source]}. "
        + " ".join(sentences)
    )
    page = tables.rigs_page(errors, ledgers, brief=brief)
    named = [table.assign(rig=name, source=source) for name, table in errors.items()]
    write_csv(csv, pd.concat(named, ignore_index=True))
    write_text(md, tables.markdown(page, note))
    write_text(tex, tables.latex(page, note))


def summarise_rigs(published: str, chunks: Sequence[str], summary: str, *, drawn: str) -> None:
    """Judge the claims rig by rig; write shares, intervals and correlations.

    ``drawn`` says how the rigs were drawn.
    """
    printed = read_yaml(published)
    rigs = [rig for path in chunks for rig in read_json(path)["rigs"]]
    good = [rig for rig in rigs if "failed" not in rig]
    if not good:
        raise FprcError(
            f"none of the {len(rigs)} rigs of the ensemble could be judged; the first: "
            f"{rigs[0]['failed']}"
        )
    claims = [claim for claim in parts_of(printed["claims"]) if claim["id"] in JUDGED_BY_RIG]
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
            "drawn": drawn,
            "seeds": [rig["seed"] for rig in rigs],
            "parameters": list(parameters[0]),
            "rigs": len(rigs),
            "failed": len(rigs) - len(good),
            "draws": sum(rig.get("draws", 0) for rig in rigs),
            "claims": shares_of(claims, verdicts, parameters),
        },
    )
