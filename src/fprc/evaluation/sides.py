"""What a second sensor is worth: the best model without P_o against the best with it.

The limits below were written down before they were run on any recording.
"""

import math
from collections.abc import Mapping, Sequence
from itertools import chain
from typing import Any, NamedTuple

import numpy as np
from scipy.stats import gmean

from fprc.evaluation.crossval import refusals_of
from fprc.evaluation.folds import Fold, split_blocks
from fprc.models import TakagiSugenoReadout
from fprc.models.fcm import fuzzy_c_means
from fprc.models.fprc import gaussian_memberships
from fprc.registry import SIDES, Settings, build, entry_of

#: Sample rate for which the settings of the paper and of the competitors were chosen, Hz.
PAPER_HZ = 200.0
#: Settings on either side: ridge parameters, shares of the weight of the training samples.
ALPHAS = (1e-6, 1e-4, 1e-2)
#: Errors inside that differ by less than this factor count as equal.
EQUAL = 1.05
#: Inputs get this mean and standard deviation, those of theta on the paper's rig in deg: widths of
#: rules and scales of networks then mean the same on every recording.
_MEAN, _SPREAD = 30.0, 18.0
#: Samples are averaged in groups to a rate of this or less than twice this, Hz: the motion is
#: slower, and the answer then hardly depends on the rate of the recording.
RATE_HZ = 50.0

#: Number of blocks, if the recordings are long enough.
BLOCKS = 20
#: Samples this near to a block do not train, s; a block is at least three times as long.
PURGE_S, PURGES = 2.0, 3
#: Samples of this time at the beginning of a recording, s, neither train nor test: low-passes and
#: networks do not know yet what was before. Three time constants of the slowest low-pass.
WARM_UP_S = 5.0
#: A block may be shorter by this share: the last sample of a part lies up to one period before its
#: end, and clocks have errors.
_ROUNDING = 0.01

#: Number of shifts of P_o in time; P_o must beat 95 % of them, so each of 19.
SHIFTS = 19
#: No shift is within this time of none, s, at most a quarter of the recording; nor within as much,
#: at most a quarter of a period, of a multiple of the period of a motion that repeats.
MEMORY_S, MEMORY_SHARE = 10.0, 0.25

#: A motion repeats if theta comes back to itself within this share of its variance (mean square
#: distance over twice the variance), after it went away by at least the other share. P_o repeats
#: with it if it comes back within the other share: then it can only tell where in the motion it is.
REPEATS, AWAY = 0.05, 0.5
#: An error below this share of the target's standard deviation counts as this share.
FLOOR = 1e-6
#: Keeps the equations of collinear features solvable; a share of the weight of all samples.
_TINY = 1e-11


def seconds_of(blocks: int) -> float:
    """Return how long a recording must be to have so many blocks, s."""
    return WARM_UP_S + blocks * PURGES * PURGE_S


class Recordings(NamedTuple):
    """Recordings one after the other, at one rate."""

    theta: np.ndarray
    p_o: np.ndarray
    target: np.ndarray  #: P_exp, in its unit
    lengths: Sequence[int]  #: samples of each recording
    rate_hz: float

    def parts(self, values: np.ndarray) -> list[np.ndarray]:
        """Return those of all samples recording by recording."""
        return np.split(values, np.cumsum(self.lengths)[:-1])

    def thinned(self) -> "Recordings":
        """Return the means of groups of samples, at least ``RATE_HZ`` of them a second."""
        size = max(1, int(self.rate_hz / RATE_HZ * (1.0 + _ROUNDING)))

        def means(values: np.ndarray) -> np.ndarray:
            wholes = [part[: len(part) // size * size] for part in self.parts(values)]
            return np.concatenate(wholes).reshape(-1, size).mean(axis=1)

        theta, p_o, target = map(means, (self.theta, self.p_o, self.target))
        lengths = [length // size for length in self.lengths]
        return Recordings(theta, p_o, target, lengths, self.rate_hz / size)

    def folds(self) -> list[Fold]:
        """Return training rows and rows of each block; the first seconds are in none of them."""
        purge, warm = (round(seconds * self.rate_hz) for seconds in (PURGE_S, WARM_UP_S))
        shortest = math.ceil((1.0 - _ROUNDING) * PURGES * purge)
        parts = self.parts(np.arange(len(self.theta)))
        kept = [part[min(warm, len(part) // 2) :] for part in parts]
        rows = np.concatenate(kept)
        folds = split_blocks(list(map(len, kept)), BLOCKS, shortest, purge)
        return [(rows[train], rows[block]) for train, block in folds]


class BlockReadouts:
    """Ridge or Takagi-Sugeno readouts of a model, each fitted without some blocks of a log.

    The blocks and their purged neighbours cut the log into cells. The moments of each cell are
    computed once, so a fit without any blocks costs one sum and one solution. The rules of a
    Takagi-Sugeno readout are placed once, by the inputs of the whole log; no target takes part in
    that. Predictions are clipped to the range of the training targets.

    ``models`` are settings for ``PAPER_HZ``. A model of ``SIDES`` has standardised inputs and
    features, ``ALPHAS``, and no penalty on the bias; ``as_is`` leaves it as it fits.
    """

    def __init__(
        self, recordings: Recordings, name: str, models: Settings, seed: int, as_is: bool = False
    ):
        inputs = {"theta_deg": recordings.theta, "p_o_kpa": recordings.p_o}
        columns = [inputs[channel] for channel in entry_of(name).inputs]
        if not as_is:
            columns = [_MEAN + _SPREAD * (x - x.mean()) / (x.std() or 1.0) for x in columns]
        X, ratio = np.column_stack(columns), recordings.rate_hz / PAPER_HZ
        changed = scaled(entry_of(name).fixed, ratio)
        if name in ("echo", "echo_p_o"):  # one network on both sides
            changed["random_state"] = seed
        model = build(name, models_at(models, ratio), seed, **changed)
        readout: Any = model.make_readout()
        y, folds = recordings.target, recordings.folds()
        fit = self._blend = np.ones((len(y), 1))
        with refusals_of(model):
            features = model.make_features().fit(X).map_log(X, recordings.lengths)
            if isinstance(readout, TakagiSugenoReadout):
                how: Any = {"random_state": readout.random_state, "restarts": readout.restarts}
                clusters = fuzzy_c_means(features, readout.n_c, **how)
                fit = clusters.memberships**2
                self._blend = gaussian_memberships(features, clusters.centers, readout.sigma)
        eye, self._as_is = np.eye(1 + features.shape[1]), as_is
        self._penalties = [readout.alpha * eye]
        if not as_is:
            slopes = np.diag(np.arange(len(eye)) > 0).astype(float)
            self._penalties = [alpha * slopes + _TINY * eye for alpha in ALPHAS]
            spread = features.std(axis=0)
            moving = spread > 1e-9 * np.maximum(np.abs(features).max(axis=0), 1e-30)
            features = (features - features.mean(axis=0)) / np.where(moving, spread, 1.0)
        self._rows = np.column_stack([np.ones(len(y)), features])
        self._y, self.blocks = y, [block for _, block in folds]
        self._least = FLOOR * (float(y.std()) or 1.0)
        out = np.array([~np.isin(np.arange(len(y)), train) for train, _ in folds])
        begins = np.flatnonzero(np.any(out[:, 1:] != out[:, :-1], axis=0)) + 1
        cells = np.split(np.arange(len(y)), begins)
        self._without = out[:, [cell[0] for cell in cells]]
        self._ends = np.array([[y[cell].min(), y[cell].max()] for cell in cells])
        both = np.column_stack([self._rows, y])
        self._moments = np.array(
            [[(self._rows[k] * u[k, None]).T @ both[k] for u in fit.T] for k in cells]
        )
        self._all = self._moments.sum(axis=0)

    def errors(self, block: int, without: Sequence[int] = ()) -> np.ndarray:
        """Return the RMSE on a block for each alpha, fitted without it and further blocks.

        The samples that are purged around all these blocks do not train either.
        """
        gone = self._without[[block, *without]].any(axis=0)
        moments = self._all - self._moments[gone].sum(axis=0)
        gram, target = moments[..., :-1], moments[..., -1:]
        weight = 1.0 if self._as_is else gram[:, :1, :1]
        own, ends, outputs = self.blocks[block], self._ends[~gone], []
        for penalty in self._penalties:
            weights = np.linalg.solve(gram + weight * penalty, target)[..., 0]
            outputs.append((self._blend[own] * (self._rows[own] @ weights.T)).sum(axis=1))
        misses = np.clip(outputs, ends[:, 0].min(), ends[:, 1].max()) - self._y[own]
        return np.maximum(np.sqrt(np.mean(misses**2, axis=1)), self._least)


class Side(NamedTuple):
    """The best of one side, chosen inside the training part of each block."""

    errors: np.ndarray  #: RMSE on each block
    chosen: Sequence[tuple[str, int]]  #: family and number of the setting, of each block
    each: Mapping[str, np.ndarray]  #: RMSE on each block of every family, its setting chosen inside


def best_of_side(recordings: Recordings, with_p_o: bool, models: Settings, seed: int) -> Side:
    """Choose the best family inside, and test it on every block.

    For each block, every family and setting is tried on the others, each predicted without itself
    and without the block, by the mean logarithm of the errors. Of those within ``EQUAL`` of the
    lowest, the plainest with its largest ridge is chosen: what hardly differs should not differ
    between the sides by chance.
    """
    settings, inside, each = {}, {}, {}
    for family, names in SIDES.items():
        fits = BlockReadouts(recordings, names[with_p_o], models, seed)
        blocks = range(len(fits.blocks))
        tried = np.array([[np.log(fits.errors(i, [out])) for i in blocks if i != out]
                          for out in blocks]).mean(axis=1)  # fmt: skip
        equal = tried <= tried.min(axis=1, keepdims=True) + math.log(EQUAL)
        settings[family] = [int(np.flatnonzero(of_block)[-1]) for of_block in equal]
        inside[family] = tried[blocks, settings[family]]
        each[family] = np.array([fits.errors(k)[at] for k, at in enumerate(settings[family])])
    lowest = np.min([*inside.values()], axis=0) + math.log(EQUAL)
    families = [next(name for name in SIDES if inside[name][k] <= lowest[k]) for k in blocks]
    errors = np.array([each[name][k] for k, name in enumerate(families)])
    return Side(errors, [(name, settings[name][k]) for k, name in enumerate(families)], each)


def error_when_shifted(
    recordings: Recordings, share: float, chosen: Side, models: Settings, seed: int
) -> float:
    """Return the mean error of what was chosen, refitted with P_o rotated by a share."""
    p_o = np.roll(recordings.p_o, round(share * len(recordings.p_o)))
    moved, families = recordings._replace(p_o=p_o), sorted({name for name, _ in chosen.chosen})
    fits = {name: BlockReadouts(moved, SIDES[name][True], models, seed) for name in families}
    return float(gmean([fits[name].errors(i)[k] for i, (name, k) in enumerate(chosen.chosen)]))


def block_errors(recordings: Recordings, models: Settings, seed: int) -> dict[str, float]:
    """Return the error of each model of ``SIDES`` on all blocks, geometric mean, best ridge."""
    errors = {}
    for name in chain(*SIDES.values()):
        fits = BlockReadouts(recordings, name, models, seed)
        errors[name] = float(gmean([fits.errors(k) for k in range(len(fits.blocks))]).min())
    return errors


def models_at(models: Settings, ratio: float) -> dict[str, Any]:
    """Return the section ``models`` for another sample rate, see ``scaled``."""
    changed = {name: models[name] | scaled(models[name], ratio) for name in ("esn", "fprc")}
    return {**models, **changed}


def scaled(parameters: Settings, ratio: float) -> dict[str, Any]:
    """Return those of a model's parameters that count samples, for another sample rate.

    Low-pass factors, leak rates, the washout and the spacing of taps then mean the same time. The
    number of taps is not among them: fewer than one tap there cannot be. ``ratio`` is the new rate
    over the one that the parameters are for.
    """
    found: dict[str, Any] = {}
    for name, value in parameters.items() if ratio != 1.0 else ():  # powers change the last digits
        if name in ("epsilon", "epsilons", "epsilons_p_o"):
            # their step responses are the same at the times of both rates
            found[name] = (1.0 - (1.0 - np.asarray(value)) ** (1.0 / ratio)).tolist()
        elif name == "gamma":
            found[name] = float(value ** (1.0 / ratio))
        elif name in ("washout", "spacing"):
            found[name] = max(round(value * ratio), min(value, 1))
    return found


def shifts_of(duration_s: float, period_s: float | None) -> list[float]:
    """Return the shifts of P_o, as shares of the recording; none if a period leaves too few."""
    memory_s = min(MEMORY_S, MEMORY_SHARE * duration_s)
    shares = np.linspace(memory_s / duration_s, 1.0 - memory_s / duration_s, 2000)
    if period_s:
        away, past = min(memory_s, MEMORY_SHARE * period_s), shares * duration_s % period_s
        shares = shares[(past >= away) & (past <= period_s - away)]
    if len(shares) < SHIFTS:
        return []
    return shares[np.linspace(0, len(shares) - 1, SHIFTS).round().astype(int)].tolist()


def period_of(theta: np.ndarray) -> int | None:
    """Return after how many samples theta repeats itself; None if it does not."""
    away = distances(theta)
    left = np.flatnonzero(away > AWAY)
    back = left[0] + np.flatnonzero(away[left[0] :] < REPEATS) if left.size else left
    if not back.size:
        return None
    dip = back[: np.flatnonzero(np.diff(np.append(back, len(theta))) > 1)[0] + 1]
    return int(dip[away[dip].argmin()])


def distances(signal: np.ndarray) -> np.ndarray:
    """Return how far a signal is from itself some samples later, for lags up to half its length.

    0 is a signal that repeats, about 1 one that does not; the variance is that of the samples that
    have a partner.
    """
    size, lags = len(signal), np.arange(len(signal) // 2 + 1)
    centred = signal - signal.mean()
    products = np.fft.irfft(np.abs(np.fft.rfft(centred, 2 * size)) ** 2)[: len(lags)]
    sums = np.append(0.0, np.cumsum(centred**2))
    both = sums[size - lags] + sums[-1] - sums[lags]
    return 1.0 - 2.0 * products / np.maximum(both, 1e-300)
