"""Settings and limits that pages of the documentation give as numbers are those of the code."""

from pathlib import Path

import pytest

from fprc import given
from fprc.apparatus import check as rig_check
from fprc.apparatus import guardian, pneumatics, recovery
from fprc.config import Settings
from fprc.evaluation import paired, sides
from fprc.logs import sealed_chamber
from fprc.recordings import diagnosis, gather, paper_models, resample, stops, text
from fprc.studies.stages import check as checked

ROOT = Path(__file__).parents[2]
WORDS = {8: "eight"}


def quoted():
    """Return the settings and limits that pages give as numbers, in the words of each page."""
    settings = Settings()
    seeds, valves = settings.beyond, settings.hardware.valves
    times = f"{settings.control.sample_rate_hz:g} Hz"
    filter_s = 1 / settings.models.fprc.epsilon / settings.control.sample_rate_hz
    states = paper_models.MOST_BYTES // (8 * (settings.models.esn.r + settings.models.n_y))
    return {
        "docs/benchmark.md": [
            f"seeds {seeds.first_seed} to {seeds.first_seed + seeds.units - 1}, "
        ],
        "docs/beyond-details.md": [
            f"*ensemble* on {seeds.units} rigs.",
        ],
        "docs/decisions.md": [
            f"up to {checked._PIXELS} pixels differ by more than {checked._LEVELS} levels"
        ],
        "docs/hardware.md": [
            f"about every {1e3 * guardian.BEAT_S:g} ms",
            f"set to vent {1 / pneumatics._POLL_S:g} times a second",
            f"or less {pneumatics._IN_A_ROW} times in a row",
            f"tries to vent {1 / guardian._RETRY_S:g} times a second",
            f"fills the actuator to {rig_check.TEST_KPA:g} kPa",
            f"{valves.neutral_v:g} V closes a valve, {valves.vent_v:g} V opens",
            f"The loop runs at {times}",
        ],
        "docs/chamber.md": [
            f"cut into {sides.BLOCKS} blocks",
            f"{sides.PURGES * sides.PURGE_S:g} s at least; the first {sides.WARM_UP_S:g} s",
            f"to it than {sides.PURGE_S:g} s",
            f"by {sides.SHIFTS} amounts, none within {sides.MEMORY_S:g} s",
            f"Fewer than {WORDS[paired.LEAST_UNITS]} blocks decide nothing",
            f"P_exp spans less than {stops.LEAST_SPAN['kPa']:g} kPa",
            f"{stops.LEAST_SPAN['deg']:g} deg, which is another unit",
            f"An ESN of {settings.models.esn.r} states is left out of logs of more than "
            f"{states // 1000 * 1000:,} samples",
        ],
        "docs/own-data.md": [
            f"| text | {text.LARGEST_TEXT_BYTES >> 20} MB |",
            f"| any other file; a journal | {given.MOST_BYTES >> 30} GB; "
            f"{recovery.LARGEST_JOURNAL_BYTES >> 30} GB |",
            f"| {gather.MOST_POINTS / 1e6:g} million samples at the new rate",
            f"to {resample.PASS:g} of the new Nyquist frequency and at -{resample.STOP_DB:g} dB",
            f"a step longer than {settings.quality.gap_periods:g} median steps",
            f"constant for more than {settings.quality.stuck_s:g} s",
            f"occurs {diagnosis.CLIPPED_RATIO:g} times as often",
            f"less than {100 * sealed_chamber._EXPLAINED:g} % of P_o",
            f"counts from {diagnosis.LEAK_KPA_PER_MIN:g} kPa per minute on",
        ],
        "docs/results.md": [f"a time constant of {filter_s:g} s"],
        "docs/elsewhere.md": [
            f"Each of the {len(settings.evaluation.replicate_seeds)} `evaluation.replicate_seeds`"
        ],
    }


QUOTED = [(page, text) for page, texts in quoted().items() for text in texts]


@pytest.mark.parametrize(("page", "text"), QUOTED, ids=[": ".join(quoted) for quoted in QUOTED])
def test_number_of_a_setting_is_that_of_the_code(page, text):
    words = " ".join((ROOT / page).read_text("utf-8").split())
    assert text in words
