"""FPRC and its competitors on a recording: errors, verdicts and their table."""

from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from fprc.artifacts import write_json
from fprc.evaluation.cells import judged_cells
from fprc.experiments.data import judge_files, read_data
from fprc.experiments.settings import Judgement
from fprc.paper import SOURCES
from fprc.recordings.claims import judge_recording
from fprc.recordings.competitors import ON_RECORDINGS, judge_competitor, recording_blocks
from fprc.recordings.competitors_table import competitors_page, competitors_table
from fprc.tables.text import write_table


def compare_competitors(
    train: str,
    test: str,
    folder: Path,
    *,
    judgement: Mapping[str, Any],
    **run: Any,
) -> dict[str, Any]:
    """Judge FPRC and its competitors on blocks of the training log, and on the test log.

    Writes errors and verdicts as ``competitors.json``, and their table as CSV and Markdown. A model
    that cannot be judged on these logs has a ``reason`` in place of errors. A repeated call
    continues one that was stopped.

    Parameters
    ----------
    judgement : Mapping
        Arguments of ``fprc.experiments.settings.Judgement``.
    **run
        ``workers`` and ``version`` of ``judged_cells``.

    Returns
    -------
    dict
        What the JSON file holds.
    """
    data, how = read_data(train), Judgement(**judgement)
    folds = recording_blocks(data, how)
    described = {
        "source": data.attributes["source"],
        "target": data.attributes["target"],
        "seed": how.seed,
        "unit": data.unit,
        "purge_s": how.purge_s,
        "block_s": [len(block) * data.period_s for _, block in folds],
        # samples that judge per sample that trains
        "overlap": float(np.mean([len(block) / len(rows) for rows, block in folds])),
    }
    with judged_cells(
        partial(judge_files, judge=judge_competitor, train=train, test=test, judgement=how),
        [{"model": name} for name in ON_RECORDINGS],
        settings=judgement,
        files=[train, test],
        checkpoint=str(folder / "competitors.partial.jsonl"),
        **run,
    ) as judged:
        report = described | {"cells": judged}
        report["verdicts"] = judge_recording(report)
        write_json(folder / "competitors.json", report)
    table = competitors_table(report)
    csv, md = (str(folder / f"competitors.{kind}") for kind in ("csv", "md"))
    write_table(table, competitors_page(table), _note(report), csv, md)
    return report


def _note(report: Mapping[str, Any]) -> str:
    shortest, longest = min(report["block_s"]), max(report["block_s"])
    length = f"{shortest:.3g}" if longest - shortest < 0.1 else f"{shortest:.3g} to {longest:.3g}"
    return (
        f"RMSE on the test data, and on {len(report['block_s'])} blocks of {length} s of the "
        "training data, mean ± standard deviation. Each block is predicted by a model trained on "
        f"the other blocks, without {report['purge_s']:g} s on each side of it.\n"
        f"Data: {SOURCES[report['source']]}, seed {report['seed']}. No model was tuned to this "
        "recording."
    )
