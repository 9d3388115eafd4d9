"""Training and validation rows of each fold."""

import numpy as np
from sklearn.model_selection import KFold

from fprc.errors import EvaluationError

Fold = tuple[np.ndarray, np.ndarray]


def split_rows(samples: int, folds: int, split: str, seed: int) -> list[Fold]:
    """Return (training rows, validation rows) of each fold.

    Parameters
    ----------
    split : {"shuffled", "blocked"}
        Rows drawn at random, or contiguous blocks. The paper does not say;
        its validation spread of 0.05-0.15 kPa is that of shuffled rows.

    Raises
    ------
    EvaluationError
        Fewer samples than folds, or an unknown split.
    """
    if split not in ("shuffled", "blocked"):
        raise EvaluationError(f"split = {split!r}; must be 'shuffled' or 'blocked'")
    if not 2 <= folds <= samples:
        raise EvaluationError(
            f"{samples} samples cannot be split into {folds} folds: a fold would be empty; "
            "use 2 folds or more, or a longer log"
        )
    shuffle = split == "shuffled"
    chooser = KFold(folds, shuffle=shuffle, random_state=seed if shuffle else None)
    return list(chooser.split(np.empty(samples)))
