"""Everything that knows the channels of a log is made from one table."""

from pathlib import Path

from fprc.channels import CHANNELS, LEARNING_CHANNELS, RAW_CHANNELS, needed_by, unit_of
from fprc.rig.simulator import SAMPLE

README = Path(__file__).parents[2] / "data/raw/README.md"


def test_readme_of_raw_logs_lists_every_channel():
    page = README.read_text(encoding="utf-8").splitlines()
    begin = page.index("|---|---|---|") + 1
    rows = [
        f"| `{channel.name}` | {unit_of(channel.name)} | {channel.meaning} |"
        for channel in CHANNELS
    ]
    assert page[begin : begin + len(RAW_CHANNELS)] == rows[: len(RAW_CHANNELS)]


def test_simulated_rig_gives_every_channel_that_its_logs_need():
    assert {*needed_by("sim", tracking=True), *LEARNING_CHANNELS} == set(SAMPLE.names)
