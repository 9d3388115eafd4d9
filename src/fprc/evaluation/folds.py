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
    if split == "blocked":
        return split_blocks([samples], folds, 1, purge)
    return list(KFold(folds, shuffle=True, random_state=seed).split(np.empty(samples)))


def _split_recordings(lengths: Sequence[int], folds: int) -> list[Fold]:
    if len(lengths) < 2:
        raise EvaluationError(
            "split = 'recordings' needs two training logs or more; add one, or use 'blocked'"
        )
    recording = np.repeat(np.arange(len(lengths)), lengths)
    chooser = GroupKFold(min(folds, len(lengths)))
    return list(chooser.split(recording, groups=recording))


def split_blocks(lengths: Sequence[int], blocks: int, shortest: int, purge: int) -> list[Fold]:
    """Return (training rows, validation rows) of blocks, each inside one recording.

    If there are ``blocks`` recordings or more, every recording is one block. Otherwise recordings
    are cut into equal blocks, at least ``blocks`` in all unless these would be shorter than
    ``shortest``; a recording that is shorter itself is one block, or two if it is the only
    recording.

    Parameters
    ----------
    lengths : sequence of int
        Samples of each recording.
    shortest : int
        Samples of the shortest block that a recording is cut into, 1 or more.
    purge : int
        Rows of the same recording on each side of a block that do not train.

    Raises
    ------
    EvaluationError
        The purge leaves a block no rows to train.
    """
    total, fewest = sum(lengths), 1 if len(lengths) > 1 else 2
    folds = []
    for rows in np.split(np.arange(total), np.cumsum(lengths)[:-1]):
        wanted = 1 if len(lengths) >= blocks else -(-blocks * len(rows) // total)
        count = max(fewest, min(wanted, len(rows) // shortest))
        for block in np.array_split(rows, count):
            first, last = max(rows[0], block[0] - purge), min(rows[-1], block[-1] + purge)
            train = np.concatenate([np.arange(first), np.arange(last + 1, total)])
            if not train.size:
                raise EvaluationError(
                    f"a block of {len(block)} samples, and {purge} samples on each side of it, "
                    f"leave none of {total} to train; reduce evaluation.purge_s, or use a longer "
                    "log"
                )
            folds.append((train, block))
    return folds
