"""Training and validation rows of each fold."""

from collections.abc import Sequence

import numpy as np
from sklearn.model_selection import GroupKFold, KFold

from fprc.errors import EvaluationError

Fold = tuple[np.ndarray, np.ndarray]


def split_rows(
    samples: int,
    folds: int,
    split: str,
    seed: int,
    purge: int = 0,
    lengths: Sequence[int] = (),
) -> list[Fold]:
    """Return (training rows, validation rows) of each fold.

    Parameters
    ----------
    split : {"shuffled", "blocked", "recordings"}
        Random rows, contiguous blocks, or whole recordings. The paper does not say
        which; shuffled rows have the validation spread that it prints, 0.05-0.15 kPa.
    purge : int
        Rows on each side of a contiguous block that do not train, because they resemble
        those that validate.
    lengths : sequence of int
        Samples of each recording. If there are fewer than ``folds``, every recording is one fold.

    Raises
    ------
    EvaluationError
        Fewer samples than folds, an unknown split, a purge that leaves no rows to train, or
        whole recordings where there is only one.
    """
    if split == "recordings":
        return _split_recordings(lengths, folds)
    if split not in ("shuffled", "blocked"):
        raise EvaluationError(f"split = {split!r}; must be 'shuffled', 'blocked' or 'recordings'")
    if not 2 <= folds <= samples:
        raise EvaluationError(
            f"{samples} samples cannot be split into {folds} folds: a fold would be empty; "
            "use 2 folds or more, or a longer log"
        )
    shuffle = split == "shuffled"
    chooser = KFold(folds, shuffle=shuffle, random_state=seed if shuffle else None)
    pairs = list(chooser.split(np.empty(samples)))
    if shuffle or purge == 0:
        return pairs
    purged = [
        (train[(train < block[0] - purge) | (train > block[-1] + purge)], block)
        for train, block in pairs
    ]
    if not all(len(train) for train, _ in purged):
        raise EvaluationError(
            f"a purge of {purge} samples on each side of a block leaves none of {samples} to "
            "train; reduce evaluation.purge_s, use fewer folds, or a longer log"
        )
    return purged


def _split_recordings(lengths: Sequence[int], folds: int) -> list[Fold]:
    if len(lengths) < 2:
        raise EvaluationError(
            "split = 'recordings' needs two training logs or more; add one, or use 'blocked'"
        )
    recording = np.repeat(np.arange(len(lengths)), lengths)
    chooser = GroupKFold(min(folds, len(lengths)))
    return list(chooser.split(recording, groups=recording))
