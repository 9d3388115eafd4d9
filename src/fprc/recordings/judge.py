"""What is doubtful in a recording, and what stops `fprc readout`: the one judge of it.

The limits below were written down before they were run on any recording.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import pandas as pd

from fprc.channels import TARGETS, unit_of
from fprc.config.settings import Quality
from fprc.escape import in_words
from fprc.logs import assess
from fprc.logs.columns import Columns
from fprc.logs.quality import runs
from fprc.recordings.clock import rate_of
from fprc.recordings.importing import USUAL, ImportMap, Recording
from fprc.recordings.names import factor_of, stated_unit
from fprc.recordings.table import Table

#: Range of plausible sample rates, Hz.
LIKELY_HZ = (1.0, 50000.0)
#: Plausible largest magnitude of a channel, by its unit: outside, another unit may be meant.
PLAUSIBLE = {"kPa": (5.0, 1500.0), "deg": (3.3, 400.0)}
#: Smallest span that is possible in the unit of the channel: less is another unit.
LEAST_SPAN = {"kPa": 5.0, "deg": 2.0}
#: Largest share of samples outside the possible range of their channel.
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
#: Rate at which copies and what theta explains are looked for, Hz, at most that of the recording.
_RATE_HZ = 50.0


class Judgement(NamedTuple):
    """What was found in a recording, in words."""

    words: list[str]  #: rate and ranges
    doubts: list[str]  #: what a person should look at
    stops: list[str]  #: why no answer from it can be right


def judge(
    recording: Recording, mapping: ImportMap, table: Table, limits: Quality, target: str
) -> Judgement:
    """Judge a recording before it is resampled; ``target`` is the P_exp that models would learn."""
    time_s, channels = recording.time_s, recording.channels
    rate_hz = rate_of(time_s)
    words = [
        f"{len(time_s)} samples over {time_s[-1]:.6g} s at {rate_hz:.6g} Hz, 98 % of the steps "
        "from {:.4g} to {:.4g} ms".format(*np.percentile(1e3 * np.diff(time_s), (1, 99)))
    ]
    about = {"experiment": mapping.experiment, "source": "import", "notes": mapping.notes}
    limits = limits.changed(stuck_s=max(limits.stuck_s, 20.0 / rate_hz))  # slow logs repeat values
    log = Columns(table.path, {"time_s": time_s, **channels}, about)
    checks = assess(log, limits, rate_hz)["checks"]
    del checks["gaps"]  # they are in the notes of the recording
    doubts = [f"{n}: {check['finding']}" for n, check in checks.items() if not check["passed"]]
    stops = []
    for name, spec in mapping.columns.items():
        column, quantity, unit = spec["column"], unit_of(name), spec["unit"]
        given, factor = table.pick(column), factor_of(unit, quantity) or 1.0
        low, high = channels[name].min(), channels[name].max()
        shown = "" if unit == "1" else quantity
        words.append(f"{name} from {column}: {low:.4g} to {high:.4g} {shown}".rstrip())
        stated = stated_unit(column, given.label, given.unit)
        # a scale, or a note, says that the map is meant as it is
        meant = spec["scale"] != 1.0 or spec["note"] or unit == "1"
        others = other_units(name, unit, channels[name] / factor)
        if stated and not meant and (stated.quantity, stated.factor) != (quantity, factor):
            both = f"the file says {stated.text} of {column}, the map {unit}"
            stops.append(f"channels.{name}: {both}: correct unit, or say in note why it is right")
        elif others and spec["scale"] == 1.0:
            doubts.append(f"{name}: its size is unusual; is {column} in {in_words(others, 'or')}?")
        if (outside := checks["range"]["samples"].get(name, 0)) > MOST_OUTSIDE * len(time_s):
            stops.append(
                f"{name}: {outside} samples are out of range: correct unit, scale or offset"
            )
    if mapping.sample_rate_hz is None and not LIKELY_HZ[0] <= rate_hz <= LIKELY_HZ[1]:
        stops.append(
            f"time: {rate_hz:.4g} Hz are unusual: correct time.unit, or give sample_rate_hz"
        )
    return Judgement(words, doubts, [*stops, *_unfit(recording, mapping, target)])


def other_units(channel: str, unit: str, values: np.ndarray) -> list[str]:
    """Return units in which the values are plausible; none if they are in the one given."""
    target = unit_of(channel)
    factor, top = factor_of(unit, target), float(np.nanmax(np.abs(values), initial=0.0))
    if target not in PLAUSIBLE or unit == "1" or factor is None or not 0.0 < top < np.inf:
        return []
    low, high = PLAUSIBLE[target]
    fit = [name for name in USUAL[target] if low <= top * (factor_of(name, target) or 1.0) <= high]
    return [] if low <= top * factor <= high else fit


def _unfit(recording: Recording, mapping: ImportMap, target: str) -> Iterator[str]:
    """Yield why no answer can be right: a channel stands still, spans too little, or is a copy."""
    names = {"theta": "theta_deg", "P_exp": TARGETS[target], "P_o": "p_o_kpa"}
    names = {word: name for word, name in names.items() if name in recording.channels}
    still = False
    for word, name in names.items():
        values, unit = recording.channels[name], unit_of(name)
        begins, lengths = runs(values)
        longest, span = int(lengths.argmax()), float(np.ptp(values))
        if lengths[longest] >= STUCK * len(values):
            still = True
            stays = f"{word} stays at {values[begins[longest]]:.4g} for half of the recording"
            yield f"{stays}: check the sensor, or select the rest by start_s and end_s"
        # P_o may span little
        elif word != "P_o" and mapping.columns[name]["unit"] != "1" and span < LEAST_SPAN[unit]:
            less = f"{word} spans {span:.3g} {unit}, less than {LEAST_SPAN[unit]:g}"
            yield f"{less}: correct its unit or scale, or give unit: 1 and a note"
    even, hz = _evenly(recording)
    lag = int(COPY_LAG_S * hz)
    if still or len(even) < 10 * lag:
        return
    for (one, other), most in COPIES.items():
        if {one, other} <= names.keys():
            late = {k: even[names[other]].shift(k) for k in range(-lag, lag + 1)}
            if (pd.DataFrame(late).corrwith(even[names[one]]) ** 2).max() > most:
                yield f"{one} and {other} are one signal, by a straight line: check the columns"


def unexplained(recording: Recording, target: str) -> list[str]:
    """Return a line that stops an answer if theta and its past explain next to nothing of P_exp."""
    from fprc.models import LowpassBank, PlayOperators  # slow to import, and an import needs none

    even, hz = _evenly(recording)
    X, p_exp = even[["theta_deg"]].to_numpy(), even[TARGETS[target]].to_numpy()
    epsilons = [1.0 - np.exp(-1.0 / (s * hz)) for s in (0.15, 0.5, 1.7)]
    past = [part.fit(X).map_log(X) for part in (LowpassBank(epsilons), PlayOperators())]
    rows = np.hstack([np.ones_like(X), X, X**2, *past])
    left, spread = np.var(p_exp - rows @ np.linalg.lstsq(rows, p_exp)[0]), np.var(p_exp)
    share = max(0.0, 1.0 - left / spread) if spread else 0.0
    line = f"theta explains {100 * share:.1f} % of P_exp, next to nothing: check columns and clock"
    return [line] if share < NEXT_TO_NOTHING else []


def _evenly(recording: Recording) -> tuple[pd.DataFrame, float]:
    """Return the channels at a rate that is low enough for the checks, and that rate, Hz."""
    time_s = recording.time_s
    hz = min(rate_of(time_s), _RATE_HZ)
    grid_s = np.arange(0.0, time_s[-1], 1.0 / hz)
    channels = {name: np.interp(grid_s, time_s, v) for name, v in recording.channels.items()}
    return pd.DataFrame(channels), hz
