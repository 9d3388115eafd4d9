"""Compare the fitted rigs: errors of Tables II to IV, and verdicts of the claims."""

from collections.abc import Mapping, Sequence

import numpy as np
import pandas as pd

from fprc import tables
from fprc.artifacts import read_json, write_csv, write_text
from fprc.claims import Results, judge_claims, status_of
from fprc.claims.ledger import TIMED
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
