import h5py
import numpy as np
import pandas as pd
import pytest

from fprc.config import PUBLISHED, Settings
from fprc.errors import LogError
from fprc.stages.tabulate import tabulate_tracking

LIMITS = Settings().quality.model_dump()


@pytest.fixture
def table_of(tmp_path):
    """Make Table IV of closed-loop logs."""

    def make(*runs):
        files = [str(tmp_path / f"table4.{kind}") for kind in ("csv", "md")]
        more = {"left_out": [], "limits": LIMITS, "feedback": "As configured."}
        tabulate_tracking(PUBLISHED, list(map(str, runs)), files, **more)
        return pd.read_csv(files[0])

    return make


def test_error_is_that_after_the_settling_time(table_of, write_run, channels, tmp_path):
    error = np.where(channels["time_s"] < 1.0, 20.0, 2.0)
    theta_d = channels["theta_deg"] + np.where(np.arange(400) % 2, error, -error)
    table = table_of(write_run(changed={"theta_d_deg": theta_d}))
    assert table["rmse_deg"].tolist() == pytest.approx([2.0])
    assert "Failed" not in (tmp_path / "table4.md").read_text(encoding="utf-8")


def test_failed_checks_of_runs_stand_below_the_table(table_of, write_run, changed, tmp_path):
    spoiled = changed("p_o_kpa", slice(7, 9), 5000.0) | {"p_fb_kpa": np.full(400, -2e3)}
    cut = {"complete": False, "incomplete_reason": "the computer went off"}
    assert len(table_of(write_run(changed=spoiled, **cut))) == 1
    note = (tmp_path / "table4.md").read_text(encoding="utf-8")
    assert "p_o_kpa: sample 7" in note
    assert "p_fb_kpa: sample 0" in note
    assert "complete: the computer went off" in note


def test_all_logs_that_are_not_whole_are_named_at_once(table_of, write_run, tmp_path):
    paths = [write_run("a.h5"), write_run("b.h5"), write_run("c.h5")]
    for path in paths[::2]:
        with h5py.File(path, "r+") as file:
            del file["p_ff_kpa"]
    with pytest.raises(LogError) as caught:
        table_of(*paths)
    lines = str(caught.value).splitlines()
    assert [line.split(";")[0] for line in lines] == [
        f"{path}: channel p_ff_kpa: missing" for path in paths[::2]
    ]
    assert not (tmp_path / "table4.csv").exists()
