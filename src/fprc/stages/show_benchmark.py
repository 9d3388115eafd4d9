"""Tables and figure of the benchmark, from its measurements."""

from base64 import urlsafe_b64decode
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from fprc.artifacts import read_json, write_csv, write_text
from fprc.figures import style
from fprc.figures.benchmark import plot_growth
from fprc.tables.benchmark import (
    benchmark,
    benchmark_page,
    bound_note,
    growth,
    rules_note,
    rules_page,
    step_note,
)
from fprc.tables.text import markdown


def tabulate_benchmark(
    report: str, rules: str, csv: str, growth_csv: str, md: str, rules_md: str, *, whole: str
) -> None:
    """Write the comparisons, the growth of the cost, and the times of the rules.

    ``whole`` is the file of ``tests/plain.py`` on the whole workflow; it need not exist.
    """
    content = read_json(report)
    table = benchmark(content | ({"all": read_json(whole)} if Path(whole).exists() else {}))
    write_csv(csv, table)
    write_csv(growth_csv, growth(content))
    note = (
        f"Speed compared with other libraries: medians of {content['rounds']} alternating rounds "
        f"on {content['cpu']}, {content['threads']} BLAS thread ({content['blas']}); in brackets "
        "the smallest and largest ratio of a round.\n"
        f"{bound_note(content)}\n{step_note(content['step'])}"
    )
    write_text(md, markdown(benchmark_page(table), note))
    times = pd.read_csv(rules)
    write_text(rules_md, markdown(rules_page(times), rules_note(times, content["starts"])))


def draw_benchmark(report: str, pdf: str, png: str) -> Mapping[str, Any]:
    """Draw how the cost grows with size, one panel per kind of work."""
    content = read_json(report)
    groups = list(growth(content).groupby("work", sort=False))
    fig, axes = style.figure(2, 3, style.PAGE_IN, 3.6)
    for ax, (name, table) in zip(axes.flat, groups, strict=False):
        plot_growth(table, ax)
        what, _, of = name.partition(", ")
        style.letter(ax, what)
        ax.set_xlabel(f"Number of {of}, $n$" if of else "$n$")
    for ax in axes.flat[len(groups) :]:
        ax.set_axis_off()
    return style.save(fig, content, pdf, png)


def tabulate_rules(
    csv: str, *, files: Sequence[str], metadata: str = ".snakemake/metadata"
) -> None:
    """Write the time of each rule's last run, from Snakemake's records of its jobs.

    Jobs that made none of ``files``, which are those of `all`, are left out.
    """
    jobs = {}
    for path in Path(metadata).rglob("*"):
        if path.is_file() and _output_of(path, metadata) in files:
            job = read_json(path)
            jobs[tuple(job["log"])] = (job["rule"], job["endtime"] - job["starttime"])
    table = pd.DataFrame(jobs.values(), columns=["rule", "seconds"])
    summed = table.groupby("rule", as_index=False)["seconds"].agg(["count", "sum", "max"])
    summed = summed.rename(columns={"count": "jobs", "sum": "seconds", "max": "longest_s"})
    write_csv(csv, summed.sort_values("seconds", ascending=False))


def _output_of(path: Path, metadata: str) -> str:
    """Return the output that a record is about; its path is the output's name in base 64."""
    parts = path.relative_to(metadata).parts
    return urlsafe_b64decode("".join(part.removeprefix("@") for part in parts)).decode()
