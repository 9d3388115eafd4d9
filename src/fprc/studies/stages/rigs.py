"""Compare rigs side by side, and judge the claims on sets of many rigs."""

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from fprc.artifacts import read_json, write_json
from fprc.claims.finding import REPRODUCED, Results
from fprc.claims.ledger import judge_claims, status_of
from fprc.claims.paper import CLAIMS, TIMED
from fprc.errors import FprcError
from fprc.paper import SOURCES
from fprc.signals import rms
from fprc.studies.calibration.objective import errors_of, printed_errors
from fprc.studies.families.claims import JUDGED_BY_RIG, WORTH, share_of, shares_of, worth_given
from fprc.studies.families.rigs import rig_errors, rigs_answer, rigs_page, within_limits
from fprc.tables.text import read_markdown, write_table
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
) -> None:
    """Write the table of the rigs.

    Parameters
    ----------
    models, grids, controls : sequence of str
        Reports of the further seeds, rig by rig; every rig has the same number of them.
    fitted : Mapping
        Terms that each rig was fitted to, by its name.
    """
    printed = read_yaml(published)
    seeds = len(models) // len(fitted)
    errors, ledgers, deviations = {}, {}, {}
    judged = _judged_rigs(printed, fitted, models, grids, controls)
    for name, rig in zip(fitted, judged, strict=True):
        errors[name] = rig.errors
        ledgers[name] = rig.ledger
        deviations[name] = _rms_deviation(rig.models, printed)
    source = read_json(models[0])["source"]
    note = (
        f"Rigs side by side: mean and its 95 % interval over {seeds} seeds, deviation from print.\n"
        f"Data: {SOURCES[source]}."
    )
    page = rigs_page(errors, ledgers, deviations)
    named = [table.assign(rig=name, source=source) for name, table in errors.items()]
    write_table(pd.concat(named, ignore_index=True), page, note, csv, md, tex)


class _JudgedRig(NamedTuple):
    models: list[dict[str, Any]]  #: reports on the models, one per seed
    errors: pd.DataFrame
    ledger: list[dict[str, Any]]


def _judged_rigs(
    printed: Mapping[str, Any],
    fitted: Mapping[str, Sequence[str]],
    models: Sequence[str],
    grids: Sequence[str],
    controls: Sequence[str],
) -> Iterator[_JudgedRig]:
    """Judge rigs, one after the other, whose reports follow each other in equal numbers."""
    claims = [*(claim for claim in CLAIMS if claim.kind != TIMED), WORTH]
    seeds = len(models) // len(fitted)
    for k, terms in enumerate(fitted.values()):
        own = slice(k * seeds, (k + 1) * seeds)
        replicates, cells, measures = (
            [read_json(path) for path in paths[own]] for paths in (models, grids, controls)
        )
        results = Results(replicates, cells, measures, {}, {})
        yield _JudgedRig(
            replicates,
            rig_errors(replicates, measures, printed),
            judge_claims(results, printed, terms, claims),
        )


def tabulate_answer(rigs: str, sets: Sequence[str], csv: str, md: str, tex: str) -> None:
    """Write deviations, claims and the reservoir's worth on all rigs, a row for each.

    Parameters
    ----------
    rigs : str
        Page of the fitted rigs, as ``compare_rigs`` writes it.
    sets : sequence of str
        Summaries of sets of rigs, as ``summarise_rigs`` writes them.
    """
    _, page = read_markdown(Path(rigs).read_text(encoding="utf-8"))
    table = rigs_answer(page, [read_json(path) for path in sets])
    note = (
        "The rigs beside the paper. Deviations from print: root mean square of the logarithms of "
        "the training and test errors of single seeds over the printed ones; for open-loop Table "
        "IV, the largest deviation of the four means over seeds. Claims are all but those on "
        "execution times. A ratio below 1 says that P_o is worth more than a low-pass of theta_d. "
        "For a rig, it is the mean with its 95 % interval over seeds; "
        f"for a set, it is the median and the range over the rigs.\nData: {SOURCES['sim']}."
    )
    write_table(table, table, note, csv, md, tex)


def summarise_rigs(
    published: str,
    chunks: Sequence[str],
    summary: str,
    *,
    drawn: str,
    terms: Sequence[str],
) -> None:
    """Judge the claims rig by rig; write shares, intervals and correlations.

    Parameters
    ----------
    drawn : str
        How the rigs were drawn.
    terms : sequence of str
        What they were fitted to, as in ``calibration.fit``.

    Raises
    ------
    FprcError
        No rig could be judged.
    """
    printed = read_yaml(published)
    rigs = [rig for path in chunks for rig in read_json(path)["rigs"]]
    good = [rig for rig in rigs if "failed" not in rig]
    if not good:
        first = rigs[0]["failed"] if rigs else "there are none"
        raise FprcError(f"none of the {len(rigs)} rigs could be judged; the first: {first}")
    ledgers = [
        judge_claims(
            Results([rig["compared"]], [], [rig["measured"]], {}, {}), printed, terms, JUDGED_BY_RIG
        )
        for rig in good
    ]
    verdicts = [{row["id"]: row["verdict"] for row in ledger} for ledger in ledgers]
    own = [row["statements"] for ledger in ledgers for row in ledger if row["id"] == "B1"]
    worth = [statement["mean"] for (statement,) in own]
    parameters = [rig["parameters"] for rig in good]
    write_json(
        summary,
        {
            "source": "sim",
            "drawn": drawn,
            "terms": list(terms),
            "seeds": [rig["seed"] for rig in rigs],
            "parameters": list(parameters[0]),
            "rigs": len(rigs),
            "failed": len(rigs) - len(good),
            "draws": sum(rig.get("draws", 0) for rig in rigs),
            "deviation": _rms_deviation([rig["compared"] for rig in good], printed),
            "worth": np.quantile(worth, (0.5, 0.025, 0.975)).tolist(),
            "worth_given": worth_given(verdicts, worth),
            "near_print": _near_print(good, verdicts, printed),
            "claims": [
                {**row, "rig": status_of(claim, terms)}
                for claim, row in zip(
                    JUDGED_BY_RIG, shares_of(JUDGED_BY_RIG, verdicts, parameters), strict=True
                )
            ],
        },
    )


def _near_print(
    rigs: Sequence[Mapping[str, Any]],
    verdicts: Sequence[Mapping[str, str]],
    printed: Mapping[str, Any],
) -> list[dict[str, Any]]:
    """Count the rigs within each limit of the printed errors, and the claims on these rigs."""
    sim = {"source": "sim"}
    met = pd.DataFrame(
        within_limits(rig_errors([rig["compared"] | sim], [rig["measured"] | sim], printed))
        for rig in rigs
    )
    holds = pd.DataFrame(verdicts) == REPRODUCED
    return [
        {
            "limit": name,
            **share_of(met[name].to_numpy()),
            "claims": {claim: int((holds[claim] & met[name]).sum()) for claim in holds},
        }
        for name in met
    ]


def _rms_deviation(reports: Sequence[Mapping[str, Any]], printed: Mapping[str, Any]) -> float:
    """Return the root mean square of the logarithms of errors over the printed ones."""
    targets = printed_errors(printed)
    off = [
        math.log(own[key] / target)
        for own in map(errors_of, reports)
        for key, target in targets.items()
    ]
    return rms(np.array(off))
