"""Training and validation rows of each fold, for our cross-validation and for scikit-learn's."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike
from sklearn.metrics import make_scorer
from sklearn.model_selection import KFold

from fprc.errors import EvaluationError
from fprc.signals import rms

Fold = tuple[np.ndarray, np.ndarray]


def split_rows(samples: int, folds: int, split: str, seed: int, purge: int = 0) -> list[Fold]:
    """Return (training rows, validation rows) of each fold.

    Parameters
    ----------
    split : {"shuffled", "blocked"}
        Random rows, or contiguous blocks. The paper does not say which; shuffled rows have the
        validation spread that it prints, 0.05-0.15 kPa.
    purge : int
        Rows on each side of a block that do not train: they resemble those that validate.

    Raises
    ------
    EvaluationError
        Fewer samples than folds, an unknown split, or a purge that leaves no rows to train.
    """
    if split not in ("shuffled", "blocked"):
        raise EvaluationError(f"split = {split!r}; must be 'shuffled' or 'blocked'")
    if not 2 <= folds <= samples:
        raise EvaluationError(f"{samples} samples in {folds} folds; must be 2 folds to one each")
    if split == "blocked":
        return split_blocks([samples], folds, 1, purge)
    return list(KFold(folds, shuffle=True, random_state=seed).split(np.empty(samples)))


def split_blocks(lengths: Sequence[int], blocks: int, shortest: int, purge: int) -> list[Fold]:
    """Return (training rows, validation rows) of blocks, each inside one recording.

    If there are ``blocks`` recordings or more, every recording is one block. Otherwise recordings
    are cut into equal blocks, at least ``blocks`` in all unless these would be shorter than
    ``shortest`` samples; a recording that is shorter itself is one block, or two if it is the only
    recording. On each side of a block ``purge`` rows of the same recording do not train.
    """
    total, fewest = sum(lengths), 1 if len(lengths) > 1 else 2
    folds = []
    for rows in np.split(np.arange(total), np.cumsum(lengths)[:-1]):
        wanted = 1 if len(lengths) >= blocks else -(-blocks * len(rows) // total)
        for block in np.array_split(rows, max(fewest, min(wanted, len(rows) // shortest))):
            first, last = max(rows[0], block[0] - purge), min(rows[-1], block[-1] + purge)
            train = np.concatenate([np.arange(first), np.arange(last + 1, total)])
            if not train.size:
                raise EvaluationError(
                    f"a block of {len(block)} samples and {purge} on each side leave none of "
                    f"{total} to train; reduce evaluation.purge_s, or use a longer log"
                )
            folds.append((train, block))
    return folds


def settled_rmse(settle: int) -> Callable[..., float]:
    """Return a scorer: minus the RMSE, kPa, without the first ``settle`` samples of a test.

    Before the first sample of a test, a model takes its inputs as constant; in the first samples
    its filters and states are still affected.
    """

    def error(y: ArrayLike, predicted: np.ndarray) -> float:
        return rms(predicted[settle:] - np.ravel(y)[settle:])

    return make_scorer(error, greater_is_better=False)
