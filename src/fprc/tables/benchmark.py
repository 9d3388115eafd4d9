"""Speed compared with other libraries."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from fprc.tables.text import three_digits


def benchmark(report: Mapping[str, Any]) -> pd.DataFrame:
    """Return each comparison, tidy: median times, and the ratio with its range over rounds.

    If the two results differ by more than the limit, the ratio is missing.

    Parameters
    ----------
    report : Mapping
        ``comparisons`` and ``real_time``; ``all`` if the whole workflow was measured.
    """
    rows = []
    whole = [_whole(report["all"])] if "all" in report else []
    for each in [*report["comparisons"], *whole]:
        ours, theirs = (np.array(each["seconds"][who]) for who in ("ours", "theirs"))
        ratios = theirs / ours if each["agrees"] else np.array([np.nan])
        rows.append(
            {
                **{key: each[key] for key in ("work", "against", "aim", "samples")},
                "ours_s": np.median(ours) if ours.size else np.nan,
                "theirs_s": np.median(theirs) if theirs.size else np.nan,
                "ratio": np.median(ratios),
                "ratio_low": ratios.min(),
                "ratio_high": ratios.max(),
                "difference": each["difference"],
                "limit": each["limit"],
            }
        )
    for each in report["real_time"]:
        times = each["simulated_s"] / np.array(each["seconds"])
        rows.append(
            {
                "work": f"Simulated rig, {each['simulated_s']:g} s, {each['loop']}",
                "against": "real time",
                "aim": each["aim"],
                "samples": 0,
                "ours_s": np.median(each["seconds"]),
                "theirs_s": each["simulated_s"],
                "ratio": np.median(times),
                "ratio_low": times.min(),
                "ratio_high": times.max(),
            }
        )
    return pd.DataFrame(rows)


def _whole(whole: Mapping[str, Any]) -> dict[str, Any]:
    return {
        "work": f"all, cold, {whole['cores']} cores",
        "against": "the same rules, not compiled",
        "aim": 10,
        "samples": 0,
        "agrees": whole["difference"] <= whole["limit"],
        "seconds": {who: [whole[who]["seconds"]] for who in ("ours", "theirs")},
        "difference": whole["difference"],
        "limit": whole["limit"],
    }


def benchmark_page(table: pd.DataFrame) -> pd.DataFrame:
    """Return the comparisons as a page."""
    rows = []
    for row in table.itertuples():
        scale, unit = (1e6 / row.samples, "us") if row.samples else (1.0, "s")
        disagree = np.isnan(row.ratio)
        rows.append(
            (
                row.work,
                row.against,
                "" if disagree else f"{three_digits(row.ours_s * scale)} {unit}",
                "" if disagree else f"{three_digits(row.theirs_s * scale)} {unit}",
                "results differ" if disagree else _ratio(row),
                f"{row.aim:g}",
                "" if np.isnan(row.difference) else f"{row.difference:.0e}",
            )
        )
    columns = ["Work", "Against", "Ours", "Theirs", "Times faster", "Aim", "Results differ by"]
    return pd.DataFrame(rows, columns=columns)


def _ratio(row: Any) -> str:
    if row.ratio_low == row.ratio_high:
        return f"{three_digits(row.ratio)} (once)"
    low, high = three_digits(row.ratio_low), three_digits(row.ratio_high)
    return f"{three_digits(row.ratio)} ({low} to {high})"


def bound_note(report: Mapping[str, Any]) -> str:
    """Return a note that compares a step of the ESN with the limit set by memory bandwidth."""
    bound = report["bound"]
    steps = next(each for each in report["comparisons"] if each["work"].startswith("ESN step"))
    note = (
        f"W_r x alone, by BLAS, takes {bound['bytes_8_us']:.3g} us in float64, which is "
        f"{bound['gb_per_s']:.3g} GB/s, and {bound['bytes_4_us']:.3g} us in float32"
    )
    if not steps["agrees"]:
        return f"{note}."
    step_us = 1e6 * np.median(steps["seconds"]["ours"]) / steps["samples"]
    share = 100 * bound["bytes_4_us"] / step_us
    return f"{note}: {share:.0f} % of our step, which reads weights of 4 bytes and sums in float64."


def step_note(step: Mapping[str, Any]) -> str:
    """Return a note on the time of single steps of the FPRC, with aims for a control loop."""
    return (
        f"The median of {step['samples']} single steps of the FPRC is {step['median_us']:.3g} us "
        f"(aim: 5), and 99.9 % take less than {step['p99_9_us']:.3g} us (aim: 50); at most "
        f"{step['peak_bytes']} bytes are allocated at a time; the centres of its rules alone have "
        f"{step['array_bytes']}."
    )


def rules_page(rules: pd.DataFrame, least: float = 0.02) -> pd.DataFrame:
    """Return the rules with a share of at least ``least`` of the time; the others as one row."""
    large = rules["seconds"] >= least * rules["seconds"].sum()
    rows, others = list(rules[large].itertuples(index=False)), rules[~large]
    if len(others):
        sums = others["jobs"].sum(), others["seconds"].sum(), others["longest_s"].max()
        rows.append((f"{len(others)} other rules", *sums))
    columns = ["Rule", "Jobs", "All jobs [s]", "Longest job [s]"]
    texts = [(r, str(n), three_digits(all_s), three_digits(one_s)) for r, n, all_s, one_s in rows]
    return pd.DataFrame(texts, columns=columns)


def rules_note(rules: pd.DataFrame, starts: Mapping[str, Any]) -> str:
    """Return a note on the total time of the jobs, and on the time to start a process."""
    begun = [f"{three_digits(np.median(each))} s if it {job}" for job, each in starts.items()]
    jobs, seconds = rules["jobs"].sum(), three_digits(rules["seconds"].sum())
    return (
        f"The {jobs} jobs took {seconds} s in all. Starting a process with its imports takes "
        f"{', '.join(begun)}."
    )


def growth(report: Mapping[str, Any]) -> pd.DataFrame:
    """Return the cost over size: median seconds and peak memory, tidy."""
    table = pd.DataFrame(report["growth"])
    return table.assign(seconds=[np.median(each) for each in table["seconds"]])
