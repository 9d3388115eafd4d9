"""From a file of the field to channels, with the map that is drafted for it."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
import yaml

from fprc.recordings.clock import rate_of
from fprc.recordings.import_recording import draft_map
from fprc.recordings.importing import gather, read_map
from fprc.recordings.table import read_table

spec = importlib.util.spec_from_file_location("ff", Path(__file__).with_name("field_files.py"))
field = importlib.util.module_from_spec(spec)
spec.loader.exec_module(field)


#: Packages of the extra ``formats``, by ending.
NEEDED = {
    ".tdms": ["nptdms"],
    ".parquet": ["pyarrow"],
    ".mcap": ["mcap", "mcap_ros2"],
    ".bag": ["rosbags"],
}


@pytest.mark.parametrize("name", field.CASES)
def test_draft_of_a_file_leads_to_the_motion_that_was_recorded(name, tmp_path):
    case = field.CASES[name]
    path = tmp_path / case.file
    for package in NEEDED.get(path.suffix, ()):
        pytest.importorskip(package, reason="of the extra `formats`")
    if callable(case.content):
        case.content(path)
    else:
        content = case.content
        path.write_bytes(content.encode() if isinstance(content, str) else content)
    text = draft_map(read_table(path))
    assert case.doubt in text
    mapping = yaml.safe_load(text)
    for place, value in case.edits.items():
        section, _, key = place.rpartition(".")
        (mapping[section] if section else mapping)[key] = value
    (tmp_path / "map.yaml").write_text(yaml.safe_dump(mapping))
    recording = gather(read_table(path), read_map(tmp_path / "map.yaml"))
    assert rate_of(recording.time_s) == pytest.approx(case.rate_hz, rel=1e-3)
    assert recording.time_s == pytest.approx(case.time_s, abs=6e-4)
    expected = (field.ANGLE, field.PRESSURE, field.P_O)
    for channel, values in zip(field.CHANNELS, expected, strict=True):
        found = recording.channels[channel]
        # a channel with a clock of its own, of half the rate, is interpolated
        atol = 3.0 if "time" in mapping["channels"][channel] else 1e-3
        np.testing.assert_allclose(found, values[case.kept], atol=atol)
