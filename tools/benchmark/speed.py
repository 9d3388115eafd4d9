"""Speed compared with the libraries that a user would otherwise use."""

import itertools
import logging
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from fprc.benchmark import peers
from fprc.evaluation import split_rows
from fprc.evaluation.crossval import fit_folds
from fprc.evaluation.timing import interleaved, stepped
from fprc.experiments.data import Data
from fprc.models import EchoStates
from fprc.models.echo import echo_states
from fprc.models.fcm import fuzzy_c_means
from fprc.registry import build

log = logging.getLogger(__name__)

#: ``tolerance`` at which scikit-fuzzy's objective agrees with ours to 1e-8. It bounds the root mean
#: square change of the memberships, see ``fuzzy_c_means``.
TIGHT = 3e-6


class Comparison(NamedTuple):
    """One piece of work, done by this package and by another library."""

    work: str
    against: str
    aim: float  #: target speed-up
    ours: Callable[[], Any]
    theirs: Callable[[], Any]
    difference: Callable[[Any, Any], float]
    limit: float  #: largest difference of results whose times are compared
    samples: int = 0  #: samples of the work, to report the time per sample; 0: report the total


def compare(comparison: Comparison, rounds: int) -> dict[str, Any]:
    """Time both sides alternately, in s; if their results disagree, give no times."""
    work, against, _, ours, theirs, difference_of, limit, _ = comparison
    difference = float(difference_of(ours(), theirs()))
    agrees = difference <= limit
    sides = {"ours": ours, "theirs": theirs}
    seconds = interleaved(sides, rounds) if agrees else {"ours": [], "theirs": []}
    log.info("%s, against %s: differ by %.1e", work, against, difference)
    fields = ("work", "against", "aim", "limit", "samples")
    named = {field: getattr(comparison, field) for field in fields}
    return {**named, "difference": difference, "agrees": agrees, "seconds": seconds}


def network_comparisons(
    models: Mapping[str, Any], data: Sequence[Data], seed: int
) -> list[Comparison]:
    """Return comparisons of the ESN: states of both logs, a step, and cross-validation."""
    logs = [each.pair("esn")[0] for each in data]
    y = data[0].pair("esn")[1]
    model = build("esn", models, seed).set_params(washout=0)
    features = model.make_features().fit(logs[0])
    few = logs[0][:2000]
    folds = split_rows(len(y), 5, "shuffled", seed)

    def of_both(states: Callable[[EchoStates, np.ndarray], np.ndarray]) -> Callable[[], Any]:
        return lambda: [states(features, X) for X in logs]

    def our_states(features: EchoStates, X: np.ndarray, dtype: Any = np.float64) -> np.ndarray:
        x, w_in, W_r = (a.astype(dtype, copy=False) for a in (X, features.w_in_, features.W_r_))
        return echo_states(x, w_in, W_r, features.gamma)

    def our_steps() -> np.ndarray:
        features.reset(few[0])
        for theta in few:
            features.advance(theta)
        return features.step(few[-1])[features.n_y :]

    name = f"ESN states, r = {model.r}, {len(logs[0])} + {len(logs[1])} steps"
    ours = of_both(our_states)
    return [
        Comparison(
            name, "ReservoirPy", 5, ours, of_both(peers.reservoirpy_states), _lagged, 1e-12
        ),
        Comparison(name, "NumPy loop", 5, ours, of_both(peers.numpy_states), _absolute, 1e-12),
        Comparison(
            f"{name}, float32", "ReservoirPy, float32", 5,
            of_both(partial(our_states, dtype=np.float32)),
            of_both(partial(peers.reservoirpy_states, dtype=np.float32)),
            _lagged, 1e-4,
        ),
        Comparison(
            "ESN step in a control loop", "ReservoirPy's step", 2,
            our_steps, lambda: peers.reservoirpy_steps(features, few), _absolute, 1e-12,
            len(few),
        ),
        Comparison(
            f"Cross-validation of the ESN, {len(y)} samples, 5 folds",
            "five fits that recompute states", 5,
            lambda: fit_folds(
                model.make_readout(), features.transform(logs[0]), y, folds
            ).validation_rmse,
            lambda: peers.recomputed_folds(features, logs[0], y, folds, model.alpha),
            _relative, 1e-6,
        ),
    ]  # fmt: skip


def fuzzy_comparisons(
    models: Mapping[str, Any], data: Data, taps: Sequence[int], seed: int
) -> list[Comparison]:
    """Return comparisons of the FPRC: a step, the clustering, and a few cells of the tap grid."""
    X, y = data.pair("fprc")
    model = build("fprc", models, seed).fit(X, y)
    rows = model.features_.transform(X)
    few = X[:4000]
    folds = split_rows(len(y), 5, "shuffled", seed)
    cells = list(itertools.product(taps, taps))

    def clusters(**options: Any) -> float:
        return fuzzy_c_means(rows, model.n_c, random_state=seed, **options).objective

    def grid(clustering: str) -> list[float]:
        errors = []
        for n_u, n_y in cells:
            cell = build("fprc", models, seed)
            cell.set_params(n_u=n_u, n_y=n_y, clustering=clustering)
            cell_rows = cell.make_features().fit(X).transform(X)
            folded = fit_folds(cell.make_readout(), cell_rows, y, folds)
            errors.append(float(np.mean(folded.validation_rmse)))
        return errors

    return [
        Comparison(
            "FPRC step in a control loop", "vectorised NumPy on one row", 2,
            lambda: stepped(model, few), lambda: peers.numpy_fprc_steps(model, few),
            _relative, 1e-9, len(few),
        ),
        Comparison(
            f"Fuzzy c-means, {len(rows)} x {rows.shape[1]}, {model.n_c} clusters",
            "skfuzzy.cmeans, same start", 10, clusters,
            lambda: clusters(clustering="scikit-fuzzy", tolerance=TIGHT), _relative, 1e-8,
        ),
        Comparison(
            f"Tap grid, by {len(cells)} of its cells, 5 folds",
            "the same with skfuzzy.cmeans", 20,
            lambda: grid("fprc"), lambda: grid("scikit-fuzzy"), _relative, 1e-3,
        ),
    ]  # fmt: skip


def _absolute(ours: Any, theirs: Any) -> float:
    return max(np.abs(a - b).max() for a, b in zip(_as_list(ours), _as_list(theirs), strict=True))


def _lagged(ours: list[np.ndarray], theirs: list[np.ndarray]) -> float:
    """Compare x(k+1): our row k + 1, and ReservoirPy's output for sample k."""
    return _absolute([states[1:] for states in ours], [states[:-1] for states in theirs])


def _as_list(result: Any) -> list[np.ndarray]:
    return result if isinstance(result, list) else [np.ravel(result)]


def _relative(ours: Any, theirs: Any) -> float:
    return float(np.abs(np.divide(ours, theirs) - 1.0).max())
