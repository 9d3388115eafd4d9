"""The option ``--workers``."""

from joblib import cpu_count

from fprc.errors import ConfigError

_MOST = 1000


def processes(workers: int | None) -> int:
    """Return the number of processes: that of ``--workers``, or one per processor.

    Raises
    ------
    ConfigError
        The number is below 1 or above 1000.
    """
    if workers is not None and not 1 <= workers <= _MOST:
        raise ConfigError(
            f"--workers {workers}: must be from 1 to {_MOST}; omit it to use all processors"
        )
    return workers or cpu_count()
