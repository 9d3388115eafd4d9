"""Claims C1-C12, about the models (Secs. II to III).

Errors are those of the further seeds; execution times are those of the main run.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.stats import rankdata, spearmanr

from fprc.claims.finding import Finding, Results, Statement, over_seeds
from fprc.paper import MODELS
from fprc.registry import title_of

#: Phases as the reports name them, and as they are shown.
PHASES = {
    "train_rmse_kpa": "training",
    "validation_rmse_kpa": "validation",
    "test_rmse_kpa": "test",
}


def _errors(results: Results, trained_on: str, model: str, metric: str) -> np.ndarray:
    """Return one error per further seed."""
    return np.array(
        [
            np.mean(report[metric])
            for replicate in results.replicates
            for report in replicate["models"]
            if report["trained_on"] == trained_on and report["model"] == model
        ]
    )


def _tests(results: Results, trained_on: str) -> dict[str, np.ndarray]:
    return {model: _errors(results, trained_on, model, "test_rmse_kpa") for model in MODELS}


def _others(tests: Mapping[str, np.ndarray]) -> np.ndarray:
    return np.minimum(tests["esn"], tests["fuzzy_linear"])


def _similar_training(results: Results, published: Mapping[str, Any]) -> Finding:
    printed = {model: published["table_2_models"][model]["train_rmse_kpa"][0] for model in MODELS}
    # halfway, in logarithms, from FPRC to Fuzzy-linear, which the paper calls worse
    limit = math.sqrt(printed["fuzzy_linear"] / printed["fprc"])
    return Finding(
        f"ESN / FPRC {printed['esn'] / printed['fprc']:.2f} in training, which is FPRC / ESN "
        f"{printed['fprc'] / printed['esn']:.2f}",
        [
            Statement(
                f"ESN / FPRC in {PHASES[phase]}",
                _errors(results, "sweep", "esn", phase) / _errors(results, "sweep", "fprc", phase),
                1 / limit,
                limit,
            )
            for phase in ("train_rmse_kpa", "validation_rmse_kpa")
        ],
        over_seeds(results.replicates),
    )


def _lowest_test(results: Results, published: Mapping[str, Any]) -> Finding:
    tests = _tests(results, "sweep")
    return Finding(
        "11.0 against 16.5 and 16.7 kPa",
        [Statement("FPRC / best other model, test", tests["fprc"] / _others(tests), high=1.0)],
        over_seeds(results.replicates),
    )


def _consistent_test(results: Results, published: Mapping[str, Any]) -> Finding:
    theirs, ours = {}, {}
    for model in ("fprc", "esn"):
        printed = published["table_2_models"][model]
        theirs[model] = printed["test_rmse_kpa"] / printed["train_rmse_kpa"][0]
        test, train = (
            _errors(results, "sweep", model, p) for p in ("test_rmse_kpa", "train_rmse_kpa")
        )
        ours[model] = test / train
    limit = math.exp((abs(math.log(theirs["fprc"])) + math.log(theirs["esn"])) / 2)
    return Finding(
        f"test / training: FPRC {theirs['fprc']:.2f}, ESN {theirs['esn']:.2f}",
        [
            Statement("test / training, FPRC", ours["fprc"], 1 / limit, limit),
            Statement("test / training, ESN", ours["esn"], low=limit),
        ],
        f"{over_seeds(results.replicates)}; limit: the middle of the printed ratios",
    )


def _beats_fuzzy_linear(results: Results, published: Mapping[str, Any]) -> Finding:
    return Finding(
        "FPRC / Fuzzy-linear: 0.78, 0.79, 0.66",
        [
            Statement(
                f"FPRC / Fuzzy-linear, {shown}",
                _errors(results, "sweep", "fprc", phase)
                / _errors(results, "sweep", "fuzzy_linear", phase),
                high=1.0,
            )
            for phase, shown in PHASES.items()
        ],
        over_seeds(results.replicates),
    )


def _reservoir_contributes(results: Results, published: Mapping[str, Any]) -> Finding:
    alone = np.array([np.mean(r["filter_alone"]["test_rmse_kpa"]) for r in results.replicates])
    own = _errors(results, "sweep", "fprc", "test_rmse_kpa")
    return Finding(
        "concluded from the comparison with Fuzzy-linear",
        [Statement("FPRC / FPRC on low-passed theta_d, test", own / alone, high=1.0)],
        over_seeds(results.replicates),
    )


def _seconds(report: Mapping[str, Any], model: str, phase: str, **more: Any) -> np.ndarray:
    wanted = {"model": model, "phase": phase, **more}
    for entry in report["times"]:
        if all(entry[key] == value for key, value in wanted.items()):
            return np.array(entry["seconds"])
    raise KeyError(f"no time of {wanted}")


def _over_repeats(seconds: np.ndarray) -> str:
    return f"main run, this machine, mean and its 95 % interval over {seconds.size} repeats"


def _faster_than_esn(results: Results, published: Mapping[str, Any]) -> Finding:
    statements = []
    for mode in ("sequential", "batch"):
        train, test = (
            _seconds(results.times, "fprc", phase, mode=mode)
            / _seconds(results.times, "esn", phase, mode=mode)
            for phase in ("train", "test")
        )
        statements += [
            Statement(f"FPRC / ESN, training, {mode}", train, high=1.0),
            Statement(f"time saved in test, {mode} [%]", 100 * (1 - test), low=95.0, ratio=False),
        ]
    return Finding(
        "trains in 12.0 against 16.6 s; 97.6 % less in test", statements, _over_repeats(train)
    )


def _fuzzy_linear_faster(results: Results, published: Mapping[str, Any]) -> Finding:
    ratios = {
        f"Fuzzy-linear / FPRC, {shown}, {mode}": _seconds(
            results.times, "fuzzy_linear", phase, mode=mode
        )
        / _seconds(results.times, "fprc", phase, mode=mode)
        for phase, shown in (("train", "training"), ("test", "test"))
        for mode in ("sequential", "batch")
    }
    return Finding(
        "Fuzzy-linear / FPRC: 0.75 in training, 0.91 in test",
        [Statement(text, values, high=1.0) for text, values in ratios.items()],
        _over_repeats(next(iter(ratios.values()))),
    )


def _reversed_worse(results: Results, published: Mapping[str, Any]) -> Finding:
    forward, backward = _tests(results, "sweep"), _tests(results, "complex")
    below = backward["fprc"] / _others(backward)
    return Finding(
        "26.2 against 60.3 and 51.5 kPa",
        [
            *(
                Statement(f"reversed / forward, {title_of(m)}", backward[m] / forward[m], low=1.0)
                for m in MODELS
            ),
            Statement("FPRC / best other, reversed", below, high=1.0),
        ],
        over_seeds(results.replicates),
    )


def _equal_shares(results: Results, published: Mapping[str, Any]) -> Finding:
    printed = published["fig_portion_mean_weight_share_percent"]
    shares = {
        name: np.array([report["weights"]["mean_share"][name] for report in results.replicates])
        for name in ("p_o", "theta_d")
    }
    return Finding(
        f"P_o {printed['p_o']} %, theta_d {printed['theta_d']} %",
        [Statement("share of P_o / theta_d", shares["p_o"] / shares["theta_d"], 0.5, 2.0)],
        over_seeds(results.replicates),
    )


def _cells(results: Results, setting: str, model: str, phase: str) -> np.ndarray:
    """Return errors over a rising setting, one row per seed; folds are averaged."""
    rows = []
    for report in results.grids:
        cells = [cell for cell in report[setting] if cell["model"] == model]
        cells.sort(key=lambda cell: cell[setting])
        rows.append([np.mean(cell[phase]) for cell in cells])
    return np.array(rows)


def _sizes(results: Results, setting: str) -> list[float]:
    cells = results.grids[0][setting]
    return sorted({cell[setting] for cell in cells if cell["model"] == "fprc"})


def _lowers_training(setting: str, results: Results, published: Mapping[str, Any]) -> Finding:
    errors = _cells(results, setting, "fprc", "train_rmse_kpa")
    sizes, what = _sizes(results, setting), f"training at {setting}"
    return Finding(
        "training falls at every step",
        [
            Statement(f"{what} {upper:g} / {lower:g}", ratios, high=1.0)
            for (lower, upper), ratios in zip(
                pairwise(sizes), (errors[:, 1:] / errors[:, :-1]).T, strict=True
            )
        ],
        over_seeds(results.grids),
    )


def _halves(errors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the rows, one per seed, that choose a setting, and those that judge it.

    A seed that did both would favour the setting that is chosen. A single seed has to do both.
    """
    half = len(errors) // 2
    return errors[:half] if half else errors, errors[half:]


def _over_halves(results: Results, what: str) -> str:
    half = len(results.grids) // 2
    chooses = f"the first {half}" if half else "the same one"
    return f"{over_seeds(results.grids[half:])}; {what} is chosen on {chooses}"


def _not_monotonic(results: Results, published: Mapping[str, Any]) -> Finding:
    statements = []
    for setting in ("epsilon", "n_c"):
        errors = _cells(results, setting, "fprc", "test_rmse_kpa")
        steps, sizes = np.diff(np.log(errors), axis=1), _sizes(results, setting)
        choosing, judging = _halves(steps)
        mean = choosing.mean(axis=0)
        for i, low, high in (
            (int(mean.argmax()), 1.0, math.inf),
            (int(mean.argmin()), -math.inf, 1.0),
        ):
            text = f"test at {setting} {sizes[i + 1]:g} / {sizes[i]:g}"
            statements.append(Statement(text, np.exp(judging[:, i]), low, high))
    return Finding("test is not monotonic", statements, _over_halves(results, "the step"))


def _times_over_rules(results: Results, published: Mapping[str, Any]) -> Finding:
    counts = sorted({entry["n_c"] for entry in results.times_over_n_c["times"]})
    train, test = (
        np.array([_seconds(results.times_over_n_c, "fprc", phase, n_c=n) for n in counts])
        for phase in ("train", "test")
    )
    trends = np.array([spearmanr(counts, repeat).statistic for repeat in train.T])
    return Finding(
        "training lengthens, test hardly changes",
        [
            Statement("rank correlation of training time with n_c", trends, low=0.85, ratio=False),
            Statement(f"test time, n_c {counts[-1]} / {counts[0]}", test[-1] / test[0], 1 / 2, 2.0),
        ],
        f"{_over_repeats(train[0])}, batch",
    )


def _below_at_every_n_c(results: Results, published: Mapping[str, Any]) -> Finding:
    statements = []
    for phase, shown in PHASES.items():
        ours, theirs = (_cells(results, "n_c", model, phase) for model in ("fprc", "fuzzy_linear"))
        statements += [
            Statement(f"FPRC / Fuzzy-linear at n_c {n_c:g}, {shown}", column, high=1.0)
            for n_c, column in zip(_sizes(results, "n_c"), (ours / theirs).T, strict=True)
        ]
    return Finding("at every n_c", statements, over_seeds(results.grids))


def _tap_trend(own: str, helps: str, results: Results, published: Mapping[str, Any]) -> Finding:
    grids = [_tap_grid(report["taps"]) for report in results.grids]
    low, high = (0.0, math.inf) if helps == "fewer" else (-math.inf, 0.0)
    statements = []
    for phase in ("train_rmse_kpa", "validation_rmse_kpa"):
        trends = np.array([_partial(sizes, own, errors[phase]) for sizes, errors in grids])
        text = f"rank correlation of {PHASES[phase]} error with {own}"
        statements.append(Statement(text, trends, low, high, ratio=False))
    return Finding(f"{helps} {own}", statements, over_seeds(results.grids))


def _medium_n_u(results: Results, published: Mapping[str, Any]) -> Finding:
    grids = [_tap_grid(report["taps"]) for report in results.grids]
    sizes = np.unique(grids[0][0]["n_u"]).tolist()
    errors = np.array(
        [
            [each["test_rmse_kpa"][found["n_u"] == size].mean() for size in sizes]
            for found, each in grids
        ]
    )
    choosing, judging = _halves(errors)
    best = 1 + int(choosing.mean(axis=0)[1:-1].argmin())
    return Finding(
        "a medium n_u",
        [
            Statement(
                f"test at n_u {sizes[best]:g} / {sizes[end]:g}",
                judging[:, best] / judging[:, end],
                high=1.0,
            )
            for end in (0, -1)
        ],
        f"{_over_halves(results, 'n_u')}, means over n_y",
    )


def _tap_grid(
    cells: Sequence[Mapping[str, Any]],
) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Return tap sizes and errors, one number per cell."""
    cells = sorted(cells, key=lambda cell: (cell["n_u"], cell["n_y"]))
    sizes = {key: np.array([cell[key] for cell in cells]) for key in ("n_u", "n_y")}
    return sizes, {p: np.array([np.mean(cell[p]) for cell in cells]) for p in PHASES}


def _partial(sizes: Mapping[str, np.ndarray], own: str, values: np.ndarray) -> float:
    """Return the rank correlation with one tap size, averaged over fixed values of the other."""
    # cells of the whole grid, sorted by n_u and then n_y
    errors = values.reshape([np.unique(each).size for each in sizes.values()])
    columns = errors if own == "n_u" else errors.T
    ranks = rankdata(np.column_stack([np.unique(sizes[own]), columns]), axis=0)
    return float(np.corrcoef(ranks, rowvar=False)[0, 1:].mean())


MODEL_TESTS: dict[str, Callable[..., Finding]] = {
    "C1": _similar_training,
    "C2": _lowest_test,
    "C3": _consistent_test,
    "C4a": _beats_fuzzy_linear,
    "C4b": _reservoir_contributes,
    "C5": _faster_than_esn,
    "C6": _fuzzy_linear_faster,
    "C7": _reversed_worse,
    "C8": _equal_shares,
    "C9a": partial(_lowers_training, "epsilon"),
    "C9b": partial(_lowers_training, "n_c"),
    "C9c": _not_monotonic,
    "C10": _times_over_rules,
    "C11": _below_at_every_n_c,
    "C12a": partial(_tap_trend, "n_u", "fewer"),
    "C12b": partial(_tap_trend, "n_y", "more"),
    "C12c": _medium_n_u,
}
