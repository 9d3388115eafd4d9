"""FPRC and its competitors on a recording: errors, verdicts and their table."""

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np

from fprc.artifacts import read_json, write_csv, write_json, write_text
from fprc.claims.recording import judge_recording
from fprc.evaluation.cells import judged_cells
from fprc.experiments.competitors import ON_RECORDINGS, judge_competitor, recording_blocks
from fprc.experiments.data import judge_files, read_data, refuse_mixture
from fprc.experiments.settings import Judgement
from fprc.paper import SOURCES
from fprc.tables.competitors import competitors_page, competitors_table
from fprc.tables.text import markdown


def compare_competitors(
    train: str, test: str, competitors: str, *, judgement: Mapping[str, Any], **run: Any
) -> None:
    """Judge FPRC and its competitors on blocks of the training log, and on the test log.

    A model that cannot be judged on these logs has a ``reason`` in place of errors.

    Parameters
    ----------
    judgement : Mapping
        Arguments of ``fprc.experiments.settings.Judgement``.
    **run
        ``workers``, ``checkpoint`` and ``version`` of ``judged_cells``.
    """
    data, how = read_data(train), Judgement(**judgement)
    refuse_mixture(data, read_data(test))
    folds = recording_blocks(data, how)
    described = {
        "source": data.attributes["source"],
        "seed": judgement["seed"],
        "unit": data.unit,
        "purge_s": judgement["purge_s"],
        "block_s": [len(block) * data.period_s for _, block in folds],
        # samples that judge per sample that trains
        "overlap": float(np.mean([len(block) / len(rows) for rows, block in folds])),
    }
    with judged_cells(
        partial(judge_files, judge=judge_competitor, train=train, test=test, judgement=how),
        [{"model": name} for name in ON_RECORDINGS],
        settings=judgement,
        files=[train, test],
        **run,
    ) as judged:
        report = described | {"cells": judged}
        write_json(competitors, {**report, "verdicts": judge_recording(report)})


def tabulate_competitors(competitors: str, csv: str, md: str) -> None:
    """Write the errors of FPRC and its competitors as CSV and Markdown."""
    report = read_json(competitors)
    table = competitors_table(report)
    write_csv(csv, table)
    shortest, longest = min(report["block_s"]), max(report["block_s"])
    length = f"{shortest:.3g}" if longest - shortest < 0.1 else f"{shortest:.3g} to {longest:.3g}"
    note = (
        f"RMSE on the test data, and on {len(report['block_s'])} blocks of {length} s of the "
        "training data, mean ± standard deviation. Each block is predicted by a model trained on "
        f"the other blocks, without {report['purge_s']:g} s on each side of it.\n"
        f"Data: {SOURCES[report['source']]}, seed {report['seed']}. No model was tuned to this "
        "recording."
    )
    write_text(md, markdown(competitors_page(table), note))
