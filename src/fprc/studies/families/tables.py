"""The paper's tables and claims on families of rigs, side by side."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from fprc.artifacts import read_json, write_json
from fprc.claims.claim import ASSUMED, COUNTED, Results
from fprc.claims.ledger import Fit, judge_claims, members_of
from fprc.claims.paper import CLAIMS
from fprc.errors import FprcError
from fprc.paper import ERRORS, REFERENCE_NAMES, SOURCES
from fprc.registry import controller_title, title_of
from fprc.tables.models import over_seeds
from fprc.tables.text import format_mean, spread, write_table
from fprc.tables.tracking import tracking_over_seeds
from fprc.yaml_file import read_yaml

#: Claims that Tables II to IV, weights and loops decide; the others need grids or counts, or are
#: assumed.
JUDGED_BY_RIG = [claim for claim in CLAIMS if claim.over == "seeds" and claim.kind != ASSUMED]

_ERRORS_NOTE = (
    "Families of rigs: errors, and their deviation from print. Of one rig: mean and its 95 % "
    "interval over seeds. Of many rigs, one recording of each: median and 95 % of the rigs."
)
_CLAIMS_NOTE = (
    "Claims on families of rigs. Of one rig: the verdict over seeds, and whether the rig was "
    "fitted to the claim. Of many rigs: on how many the claim holds with one seed; grids are not "
    "judged on them."
)


def tabulate_families(
    published: str,
    models: Sequence[str],
    grids: Sequence[str],
    controls: Sequence[str],
    ensemble: str,
    *,
    named: Mapping[str, Fit],
    errors: Sequence[str],
    claims: Sequence[str],
    members: str,
) -> None:
    """Judge every family; write its errors beside the printed ones, and the verdicts.

    Parameters
    ----------
    models, grids, controls : sequence of str
        Results over seeds, rig by rig; every named rig has the same number of them.
    ensemble : str
        Result of ``judge_tables`` on the ensemble.
    named : Mapping
        What each named rig was fitted to, see ``judge_claims``.
    errors, claims : sequence of str
        The tables to write, as CSV and as Markdown: see ``family_errors`` and ``family_claims``.
    members : str
        What ``members_of`` returns of the ensemble, as JSON.

    Raises
    ------
    FprcError
        No rig of the ensemble could be judged.
    """
    printed = read_yaml(published)
    # one rig with the results of its seeds, grids among them, or many rigs without grids
    families: dict[str, tuple[Fit, list[Results]]] = {}
    for k, (name, fitted) in enumerate(named.items()):
        of_models, of_grids, of_control = (
            [read_json(path) for path in np.array_split(paths, len(named))[k]]
            for paths in (models, grids, controls)
        )
        families[f"Rig {name}"] = fitted, [Results(of_models, of_grids, of_control, {}, {})]
    report = read_json(ensemble)
    good = [
        Results([cell["compared"]], [], [cell["measured"]], {}, {})
        for cell in report["cells"]
        if "failed" not in cell
    ]
    if not good:
        raise FprcError(f"{ensemble}: no rig could be judged: {report['cells'][0]['failed']}")
    families["Ensemble"] = {"to": report["fitted"]}, good
    write_json(members, members_of(good, printed, JUDGED_BY_RIG))
    of_errors = pd.concat(
        family_errors(rigs, printed).assign(rigs=title) for title, (_, rigs) in families.items()
    )
    of_claims = pd.concat(
        family_claims(rigs, fitted, printed).assign(rigs=title)
        for title, (fitted, rigs) in families.items()
    )
    heads = {"number": "Number", "paper": "Paper", "id": "Id", "claim": "Claim"}
    for table, rows, note, files in (
        (of_errors, ["number", "paper"], _ERRORS_NOTE, errors),
        (of_claims, ["id", "claim"], _CLAIMS_NOTE, claims),
    ):
        page = table.pivot(index=rows, columns="rigs", values="text")
        page = page.reindex(index=table.set_index(rows).index.unique(), columns=[*families])
        page = page.fillna("-").reset_index().rename(columns=heads)
        tidy = table.drop(columns=["text", "paper"], errors="ignore").assign(source="sim")
        tidy.insert(0, "rigs", tidy.pop("rigs"))
        write_table(tidy, page, f"{note}\nData: {SOURCES['sim']}.", *files)


def family_errors(rigs: Sequence[Results], printed: Mapping[str, Any]) -> pd.DataFrame:
    """Return the errors of ``rig_errors``, of the seeds of one rig or over many rigs.

    Also ``paper`` and ``text``, for readers.
    """
    units = [rig_errors(rig.replicates, rig.controls, printed) for rig in rigs]
    table = units[0]
    if not rigs[0].grids:
        found = np.quantile([unit["middle"] for unit in units], (0.5, 0.025, 0.975), axis=0)
        table = table.assign(**dict(zip(("middle", "low", "high"), found, strict=True)))
    off = 100 * (table["middle"] / table["published"] - 1.0)
    texts = [
        _percent(row) if pd.isna(away) else f"{format_mean(row, 'middle')}, {away:+.0f} %"
        for row, away in zip(table.to_dict("records"), off, strict=True)
    ]
    return table.assign(paper=[spread(value, None) for value in table["published"]], text=texts)


def _percent(row: Mapping[str, float]) -> str:
    middle, low, high = (f"{100 * row[end]:.0f}" for end in ("middle", "low", "high"))
    return f"{middle} %" if low == high else f"{middle} % ({low} to {high})"


def rig_errors(
    models: Sequence[Mapping[str, Any]],
    controls: Sequence[Mapping[str, Any]],
    published: Mapping[str, Any],
) -> pd.DataFrame:
    """Return the errors of Tables II to IV on one rig that the paper prints.

    Columns ``number``, ``published``, ``middle``, ``low`` and ``high``; in the last rows, without
    ``published``, absolute deviations from print as shares.
    """
    tables = []
    for number, log in (("II", "sweep"), ("III", "complex")):
        errors = over_seeds(models, published, log).rename(columns={"published_mean": "published"})
        what = errors["model"].map(title_of) + ", " + errors["metric"].map(ERRORS)
        tables.append(errors.assign(table=number, what=what))
    loops = tracking_over_seeds(controls, published).rename(
        columns={"rmse_deg": "mean", "published_rmse_deg": "published"}
    )
    of_loops = loops["controller"].map(controller_title), loops["reference"].map(REFERENCE_NAMES)
    tables.append(loops.assign(table="IV", unit="deg", what=of_loops[0] + ", " + of_loops[1]))
    table = pd.concat(tables).dropna(subset="published").rename(columns={"mean": "middle"})
    off, loop = (table["middle"] / table["published"] - 1.0).abs(), table["controller"]
    sums = {
        "Tables II and III, median deviation": off[table["table"] != "IV"].median(),
        "Tables II and III, largest deviation": off[table["table"] != "IV"].max(),
        "Table IV, open loop, largest deviation": off[loop == "fprc"].max(),
        "Table IV, closed loop, median deviation": off[loop == "fprc_pd"].median(),
        "Table IV, closed loop, largest deviation": off[loop == "fprc_pd"].max(),
    }
    table["number"] = "Table " + table["table"] + ", " + table["what"] + " [" + table["unit"] + "]"
    last = [{"number": what, **dict.fromkeys(("middle", "low", "high"), value)}
            for what, value in sums.items()]  # fmt: skip
    columns = ["number", "published", "middle", "low", "high"]
    return pd.concat([table[columns], pd.DataFrame(last)], ignore_index=True)


def family_claims(rigs: Sequence[Results], fitted: Fit, printed: Mapping[str, Any]) -> pd.DataFrame:
    """Return the verdicts on one rig over its seeds, or on how many of several rigs a claim holds.

    Columns are ``id`` and ``claim``; of one rig ``verdict`` and ``fitted``; of several ``holds``,
    their number, of ``judged``; and ``text``, for readers.
    """
    if rigs[0].grids:
        claims = [claim for claim in CLAIMS if claim.kind != COUNTED]
        table = pd.DataFrame(judge_claims(rigs[0], printed, fitted, claims))
        table = table[["id", "claim", "verdict", "rig"]].rename(columns={"rig": "fitted"})
        return table.assign(text=table["verdict"] + " (" + table["fitted"] + ")")
    holds = members_of(rigs, printed, JUDGED_BY_RIG)["holds"]
    return pd.DataFrame(
        {"id": claim.id, "claim": claim.text, "holds": holds[claim.id], "judged": len(rigs),
         "text": f"{holds[claim.id]} of {len(rigs)}"}
        for claim in JUDGED_BY_RIG
    )  # fmt: skip
