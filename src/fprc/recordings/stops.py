"""What cannot give a right answer stops `fprc readout` before any training."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from fprc.errors import LogError
from fprc.evaluation.sides import PURGE_S, PURGES, WARM_UP_S, Recordings
from fprc.logs.quality import runs
from fprc.models import LowpassBank, PlayOperators
from fprc.recordings.draft import contradictions
from fprc.recordings.importing import ImportMap
from fprc.recordings.table import Table

#: Fewest blocks that can be predicted: one is left to train when two are out.
LEAST_BLOCKS = 3
#: Smallest span that is possible in the unit of the channel: less is another unit.
LEAST_SPAN = {"kPa": 5.0, "deg": 2.0}
#: Largest share of samples outside the plausible range of their channel.
MOST_OUTSIDE = 0.01
#: A channel that does not change for this share of the recording is stuck.
STUCK = 0.5
#: A channel is a copy of another one if a straight line of it, up to half a second late or early,
#: explains more than this share of the variance. A sealed chamber explains less of P_exp; the
#: actuator's own pressure follows its command to 0.999.
COPIES = {("theta", "P_exp"): 0.9999, ("theta", "P_o"): 0.9999, ("P_o", "P_exp"): 0.99}
COPY_LAG_S = 0.5
#: theta explains next to nothing of P_exp: less than this share, with the best of a constant,
#: theta, its square, low-passes and plays.
NEXT_TO_NOTHING = 0.05


def refuse_units(mapping: ImportMap, table: Table) -> None:
    """Refuse a map whose unit contradicts what the file states; a note says that it is meant.

    Raises
    ------
    LogError
        Lists all channels.
    """
    found = contradictions(mapping, table).values()
    _refuse([f"channels.{line}: correct unit, or say in note why it is right" for line in found])


def refuse_channels(
    recordings: Recordings, units: Mapping[str, str], quality: list[Mapping[str, Any]]
) -> None:
    """Refuse channels that are stuck, copies, impossible in their unit, or without relation.

    Parameters
    ----------
    units : Mapping
        Unit of ``theta``, ``P_o`` and ``P_exp``.
    quality : list of Mapping
        Quality record of each recording.

    Raises
    ------
    LogError
        Lists all problems.
    """
    channels = {"theta": recordings.theta, "P_o": recordings.p_o, "P_exp": recordings.target}
    if len(recordings.folds()) < LEAST_BLOCKS:
        least_s = WARM_UP_S + LEAST_BLOCKS * PURGES * PURGE_S
        _refuse(
            [
                f"{len(recordings.theta) / recordings.rate_hz:.3g} s are too short to judge "
                f"anything; at least {least_s:g} s are needed"
            ]
        )
    problems = [*_stuck(channels)]
    if not problems:
        problems = [*_impossible(channels, units, quality), *_copies(channels, recordings.rate_hz)]
    if not problems and (explained := explained_by(recordings)) < NEXT_TO_NOTHING:
        problems = [
            f"theta explains {100.0 * max(explained, 0.0):.1f} % of P_exp, next to nothing: check "
            "the columns and the clock"
        ]
    _refuse(problems)


def _refuse(problems: list[str]) -> None:
    if problems:
        raise LogError("\n".join(problems))


def _stuck(channels: Mapping[str, np.ndarray]) -> Iterator[str]:
    for name, values in channels.items():
        begins, lengths = runs(values)
        longest = int(lengths.argmax())
        if lengths[longest] >= STUCK * len(values):
            yield (
                f"{name} stays at {values[begins[longest]]:.4g} for "
                f"{100.0 * lengths[longest] / len(values):.0f} % of the recording: check the "
                "sensor, or select the rest by start_s and end_s"
            )


def _impossible(
    channels: Mapping[str, np.ndarray],
    units: Mapping[str, str],
    quality: list[Mapping[str, Any]],
) -> Iterator[str]:
    for name in ("theta", "P_exp"):
        span, least = float(np.ptp(channels[name])), LEAST_SPAN.get(units[name], 0.0)
        if span < least:
            yield (
                f"{name} spans {span:.3g} {units[name]}, less than {least:g}: is it in another "
                "unit? Correct unit or scale in the map; unit: 1 with a note takes any quantity"
            )
    outside = [(record, record["checks"]["range"]["samples"]) for record in quality]
    for name in ("theta_deg", "p_exp_command_kpa", "p_exp_kpa", "p_o_kpa"):
        count = sum(samples.get(name, 0) for _, samples in outside)
        if count > MOST_OUTSIDE * sum(record["samples"] for record, _ in outside):
            yield (
                f"{name}: {count} samples are outside its possible range: correct unit, scale or "
                "offset in the map"
            )


def _copies(channels: Mapping[str, np.ndarray], rate_hz: float) -> Iterator[str]:
    lag = int(COPY_LAG_S * rate_hz)
    for pair, most in COPIES.items():
        one, other = (channels[name] - channels[name].mean() for name in pair)
        middle = one[lag : len(one) - lag]
        for shift in range(2 * lag + 1):
            late = other[shift : shift + len(middle)]
            explained = (middle @ late) ** 2 / ((middle @ middle) * (late @ late))
            if explained > most:
                yield (
                    f"a straight line of {pair[0]} explains {100.0 * explained:.4g} % of "
                    f"{pair[1]}: they are one signal; give the column of the sealed chamber"
                    f"{'' if 'P_o' in pair else ', of the angle and of the pressure'}"
                )
                break


def explained_by(recordings: Recordings) -> float:
    """Return the share of P_exp's variance that theta and its past explain, fitted."""
    theta = recordings.theta[:, None]
    epsilons = [1.0 - np.exp(-1.0 / (s * recordings.rate_hz)) for s in (0.15, 0.5, 1.7)]
    maps = (LowpassBank(epsilons), PlayOperators())
    past = [part.fit(theta).map_log(theta) for part in maps]
    rows = np.hstack([np.ones_like(theta), theta, theta**2, *past])
    left = recordings.target - rows @ np.linalg.lstsq(rows, recordings.target)[0]
    return 1.0 - float(np.var(left) / np.var(recordings.target))
