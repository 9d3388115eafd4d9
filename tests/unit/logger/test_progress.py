import io
import json

import pytest

from snakemake_logger_plugin_fprc.progress import Progress, read_seconds, write_seconds


class Clock:
    now = 0.0

    def __call__(self):
        return self.now


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def run(clock):
    """Return what begins a run of two judgements and a table, and its stream."""

    def begin(terminal=False, **seconds):
        progress = Progress(io.StringIO(), terminal, seconds, clock)
        progress.begin({"judge": 2, "table": 1})
        return progress

    return begin


def printed(progress):
    return progress.stream.getvalue().splitlines()


def test_each_job_is_a_line_and_the_last_ends_the_run(run, clock):
    progress = run()
    for number, rule in enumerate(("judge", "judge", "table")):
        progress.start(number, rule, "" if rule == "table" else f"Judgement {number}", None)
        clock.now += 61
        progress.finish(number)
    lines = printed(progress)
    assert lines[0].startswith("3 jobs")
    assert [line.split("  ") for line in lines if line.startswith("[")] == [
        ["[1/3] 1:01", "Judgement 0 (61 s)"],
        ["[2/3] 2:02", "Judgement 1 (61 s)"],
    ]
    assert lines[-1] == "3 of 3 jobs done in 3:03"


def test_time_left_is_that_of_earlier_jobs_of_each_rule_on_the_cores_in_use(run, clock):
    progress = run(judge=10.0, table=30.0)
    for number in (0, 1):
        progress.start(number, "judge", "Judgement", None)
    assert progress.remaining_s() is None  # nothing has ended: the cores in use are unknown
    clock.now = 20.0
    progress.finish(0)
    progress.finish(1)
    # two at a time; a table remains
    assert progress.remaining_s() == pytest.approx(30.0 / 2.0)
    progress.start(2, "table", "Table", None)
    clock.now = 25.0
    assert progress.remaining_s() == pytest.approx((30.0 - 5.0) / (40.0 / 25.0))


def test_long_job_shows_the_last_line_of_its_log_once_a_minute(run, clock, tmp_path):
    log = tmp_path / "judge.log"
    log.write_text("[judge esn] fold 1 of 5\n[judge esn] fold 2 of 5\n")
    progress = run()
    progress.start(0, "judge", "Judgement", log)
    for clock.now in range(1, 130):
        progress.show()
    assert [line for line in printed(progress) if "fold" in line] == [
        "[0/3] 1:00  Judgement: fold 2 of 5",
        "[0/3] 2:00  Judgement: fold 2 of 5",
    ]


@pytest.mark.parametrize("content", ["", "{", "[1]", '{"judge": "long"}', None])
def test_durations_that_cannot_be_read_are_none(tmp_path, content):
    path = tmp_path / "seconds.json"
    if content is not None:
        path.write_text(content)
    assert read_seconds(path) == {}


def test_durations_are_kept_and_the_last_ones_count(tmp_path):
    path = tmp_path / "seconds.json"
    write_seconds(path, {"judge": 1.0, "table": 2.0}, {"judge": 3.0})
    assert read_seconds(path) == {"judge": 3.0, "table": 2.0} == json.loads(path.read_text())
    write_seconds(tmp_path / "nowhere" / "seconds.json", {})
