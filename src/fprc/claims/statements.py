"""What the paper's claims compare: numbers of results, each with its limits."""

import math
from itertools import pairwise

import numpy as np
from scipy.stats import spearmanr

from fprc.claims import numbers as n
from fprc.claims.claim import Printed, Results, Statement
from fprc.paper import LOOPS, MODELS, PRINTED, REFERENCE_NAMES, REFERENCES
from fprc.registry import controller_title, title_of

_TABLES = {"Table II": "sweep", "Table III": "complex"}


def similar_training(r: Results, p: Printed) -> list[Statement]:
    """Compare the errors of ESN and FPRC in training and validation."""
    printed = {model: p["table_2_models"][model]["train_rmse_kpa"][0] for model in MODELS}
    # halfway, in logarithms, from FPRC to Fuzzy-linear, which the paper calls worse
    limit = math.sqrt(printed["fuzzy_linear"] / printed["fprc"])
    ratios = {
        phase: n.ratio(r, "sweep", "esn", "fprc", phase) for phase in ("training", "validation")
    }
    return [
        Statement(f"ESN / FPRC in {phase}", ratio, 1 / limit, limit)
        for phase, ratio in ratios.items()
    ]


def consistent_test(r: Results, p: Printed) -> list[Statement]:
    """Compare each model's test error with its training error."""
    ours, printed = {}, {}
    for model in ("fprc", "esn"):
        row = p["table_2_models"][model]
        printed[model] = row["test_rmse_kpa"] / row["train_rmse_kpa"][0]
        ours[model] = n.error(r, "sweep", model, "test") / n.error(r, "sweep", model, "training")
    limit = math.exp((abs(math.log(printed["fprc"])) + math.log(printed["esn"])) / 2)
    return [
        Statement("test / training, FPRC", ours["fprc"], 1 / limit, limit),
        Statement("test / training, ESN", ours["esn"], low=limit),
    ]


def validation_equals_training(r: Results, p: Printed) -> list[Statement]:
    """Ask for validation errors like the training errors; in print they differ by 1 % at most."""
    return [
        Statement(
            f"validation / training, {title_of(model)}, {table}",
            n.error(r, log, model, "validation") / n.error(r, log, model, "training"),
            1 / 1.02, 1.02,
        )
        for table, log in _TABLES.items()
        for model in MODELS
    ]  # fmt: skip


def printed_spreads(r: Results, p: Printed) -> list[Statement]:
    """Compare the spreads over the folds with the twelve that the paper prints."""
    return [
        Statement(
            f"spread of {title_of(model)} in {phase} over print, {table}",
            n.spread_over_folds(r, log, model, phase) / p[PRINTED[log]][model][n.PHASES[phase]][1],
            1 / 3.0, 3.0,
        )
        for table, log in _TABLES.items()
        for model in MODELS
        for phase in ("training", "validation")
    ]  # fmt: skip


def order_of_references(r: Results, p: Printed) -> list[Statement]:
    """Ask for the errors of Table IV to rise from reference to reference as in print."""
    table, statements = p["table_4_tracking_rmse_deg"], []
    for controller in ("fprc", "fprc_pd"):
        order = sorted(REFERENCES, key=table[controller].__getitem__)
        title = controller_title(controller)
        statements += [
            Statement(
                f"{title}, {REFERENCE_NAMES[more]} / {REFERENCE_NAMES[less]}",
                n.tracking_error(r, more, controller) / n.tracking_error(r, less, controller),
                low=1.0,
            )
            for less, more in pairwise(order)
        ]
    return statements


def below_fuzzy_linear_over_epsilon(r: Results, p: Printed) -> list[Statement]:
    """Compare FPRC at every epsilon with Fuzzy-linear, which has none."""
    return [
        Statement(f"FPRC / Fuzzy-linear at epsilon {epsilon:g}, {phase}", column / other, high=1.0)
        for phase in n.PHASES
        for other in [n.error(r, "sweep", "fuzzy_linear", phase)]
        for epsilon, column in zip(
            n.sizes(r, "epsilon"), n.grid(r, "epsilon", "fprc", phase).T, strict=True
        )
    ]


def lowest(r: Results, trained_on: str, model: str, *phases: str) -> list[Statement]:
    """Ask for an error that is below those of the paper's two other models."""
    direction = "reversed " if trained_on == "complex" else ""
    statements = []
    for phase in phases:
        others = [n.error(r, trained_on, name, phase) for name in MODELS if name != model]
        ratio = n.error(r, trained_on, model, phase) / np.minimum(*others)
        text = f"{title_of(model)} / best other model, {direction}{phase}"
        statements.append(Statement(text, ratio, high=1.0))
    return statements


def work_ratios(r: Results, model: str, other: str, *phases: str) -> dict[str, np.ndarray]:
    """Return the multiplications of a model over another one's, by what is compared."""
    ratios = {}
    for phase in phases:
        ours, theirs = (n.multiplications(r.times, name, phase) for name in (model, other))
        ratios[f"{title_of(model)} / {title_of(other)}, {phase}"] = ours / theirs
    return ratios


def printed_time_ratio(p: Printed) -> float:
    """Return FPRC's printed training time over the ESN's."""
    ours, theirs = (p["table_2_models"][name]["train_time_s"][0] for name in ("fprc", "esn"))
    return ours / theirs


def work_over_n_c(r: Results, p: Printed) -> list[Statement]:
    """Ask for more work with a larger n_c in training, and for as much in the test."""
    counts = n.rule_counts(r)
    training, test = (
        np.array([n.multiplications(r.times_over_n_c, "fprc", phase, n_c=k) for k in counts])
        for phase in ("training", "test")
    )
    return [
        Statement("rank correlation of training with n_c",
                  np.array([spearmanr(counts, training[:, 0]).statistic]), low=0.85, ratio=False),
        Statement(f"test, n_c {counts[-1]} / {counts[0]}", test[-1] / test[0], 1 / 1.25, 1.25),
    ]  # fmt: skip


def more_work_at_every_n_c(r: Results, p: Printed) -> list[Statement]:
    """Ask for less work of Fuzzy-linear than of FPRC at every n_c."""
    return [
        Statement(
            f"Fuzzy-linear / FPRC at n_c {n_c}, {phase}",
            n.multiplications(r.times_over_n_c, "fuzzy_linear", phase, n_c=n_c)
            / n.multiplications(r.times_over_n_c, "fprc", phase, n_c=n_c),
            high=1.0,
        )
        for phase in ("training", "test")
        for n_c in n.rule_counts(r)
    ]


def falls_at_every_step(r: Results, setting: str) -> list[Statement]:
    """Ask for a training error that falls from each value of a setting to the next."""
    errors, sizes = n.grid(r, setting, "fprc", "training"), n.sizes(r, setting)
    return [
        Statement(f"training at {setting} {upper:g} / {lower:g}", column, high=1.0)
        for (lower, upper), column in zip(
            pairwise(sizes), (errors[:, 1:] / errors[:, :-1]).T, strict=True
        )
    ]


def not_monotonic(r: Results, p: Printed) -> list[Statement]:
    """Ask for a step up and a step down of the test error over epsilon and over n_c."""
    statements = []
    for setting in ("epsilon", "n_c"):
        errors, sizes = n.grid(r, setting, "fprc", "test"), n.sizes(r, setting)
        steps = np.diff(np.log(errors), axis=1)
        # a seed that chose a step and judged it would favour it; a single seed has to do both
        half = len(steps) // 2
        mean, judging = steps[: half or None].mean(axis=0), steps[half:]
        for i, low, high in (
            (int(mean.argmax()), 1.0, math.inf),
            (int(mean.argmin()), -math.inf, 1.0),
        ):
            text = f"test at {setting} {sizes[i + 1]:g} / {sizes[i]:g}"
            statements.append(Statement(text, np.exp(judging[:, i]), low, high))
    return statements


def fewer_or_more(r: Results, tap: str, best: str) -> list[Statement]:
    """Ask for an error that falls with fewer (best "few") or with more (best "many") taps."""
    low, high = (0.5, math.inf) if best == "few" else (-math.inf, -0.5)
    statements = []
    for phase in ("training", "validation"):
        text = f"rank correlation of {phase} error with {tap}"
        statements.append(Statement(text, n.tap_trend(r, tap, phase), low, high, ratio=False))
        few, medium, many = n.thirds_of_taps(r, tap, phase)
        ratio = (few if best == "few" else many) / medium
        statements.append(Statement(f"{phase}, {best} {tap} / medium", ratio, high=1.0))
    return statements


def medium_n_u(r: Results, p: Printed) -> list[Statement]:
    """Compare the test error with a medium n_u to that with few and with many."""
    few, medium, many = n.thirds_of_taps(r, "n_u", "test")
    return [
        Statement("test, medium n_u / few", medium / few, high=1.0),
        Statement("test, medium n_u / many", medium / many, high=1.0),
    ]


def cuts(r: Results) -> dict[str, np.ndarray]:
    """Return the tracking error with feedback over that without, by reference."""
    return {
        name: n.tracking_error(r, name, "fprc_pd") / n.tracking_error(r, name, "fprc")
        for name in REFERENCES
    }


def printed_cuts(p: Printed) -> dict[str, float]:
    """Return the same ratios of the printed errors."""
    table = p["table_4_tracking_rmse_deg"]
    return {name: table["fprc_pd"][name] / table["fprc"][name] for name in REFERENCES}


def loops_removed(r: Results, p: Printed) -> list[Statement]:
    """Compare the loops of PD alone, and its errors, with those of FPRC+PD."""
    statements = []
    for reference in LOOPS:
        name = REFERENCE_NAMES[reference]
        pd, both = (
            n.measured(r, "loops", f"{reference}/{controller}", "width_over_span")
            for controller in ("pd", "fprc_pd")
        )
        statements += [
            Statement(f"width of the loop of PD, {name} [% of its span]", 100 * pd, 5, ratio=False),
            Statement(f"width of the loop, FPRC+PD / PD, {name}", both / pd, high=0.5, ratio=False),
            Statement(
                f"RMSE, FPRC+PD / PD, {name}",
                n.tracking_error(r, reference, "fprc_pd") / n.tracking_error(r, reference, "pd"),
                high=1.0,
            ),
        ]
    return statements


#: Most by which a measure of a loop may grow or shrink over the sweep.
_SAME = 1.2

_OF_LOOPS = {
    "swing": "swing", "width_quarter": "width / swing at a quarter of the angle",
    "width_half": "width / swing at half the angle",
    "width_three_quarters": "width / swing at three quarters of the angle", "slope": "slope",
}  # fmt: skip


def frequency_independent(r: Results, p: Printed) -> list[Statement]:
    """Ask for loops of actuator and reservoir that are the same at both ends of the sweep."""
    return [
        Statement(f"{words}, {loop}", n.measured(r, "hysteresis", loop, key), 1 / _SAME, _SAME)
        for loop in ("actuator", "reservoir")
        for key, words in _OF_LOOPS.items()
    ]
