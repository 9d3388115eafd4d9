import contextlib
import io
import re
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_array_equal
from threadpoolctl import threadpool_limits

from fprc.config import check
from fprc.datasets import load_hysteresis
from fprc.errors import ConfigError
from fprc.logs import read_columns

ROOT = Path(__file__).parents[2]
SETTINGS = check({}).model_dump(mode="json")


@pytest.fixture(scope="module")
def sweep():
    return load_hysteresis("sweep")


def test_data_are_those_of_the_workflow(sweep, make_data, tmp_path):
    _, path = make_data(tmp_path, "sweep", SETTINGS, 1)
    ours = read_columns(path, ("theta_deg", "p_o_kpa", "p_target_kpa")).channels
    assert_array_equal(sweep.data, np.column_stack([ours["theta_deg"], ours["p_o_kpa"]]))
    assert_array_equal(sweep.target, ours["p_target_kpa"])


@pytest.mark.parametrize(
    "wrong",
    [{"experiment": "sine"}, {"seed": -1}, {"rig": "papr"},
     {"rig": {"leek": 1}}],
)  # fmt: skip
def test_wrong_argument_is_refused(wrong):
    with pytest.raises(ConfigError, match="|".join(wrong)):
        load_hysteresis(**wrong)


@pytest.mark.slow
def test_lines_of_the_page_give_the_table_of_the_results(tmp_path, monkeypatch):
    page = (ROOT / "README.md").read_text(encoding="utf-8")
    lines, printed = (
        re.search(rf"```{kind}\n(.*?)```", page, flags=re.DOTALL)[1] for kind in ("python", "text")
    )
    assert len(list(filter(None, lines.splitlines()))) <= 10
    monkeypatch.chdir(tmp_path)
    output = io.StringIO()
    # as in the workflow: sums by more threads have other last digits
    with threadpool_limits(1), contextlib.redirect_stdout(output):
        exec(compile(lines, "README.md", "exec"), {})
    assert output.getvalue() == printed
    results = (ROOT / "docs/results.md").read_text(encoding="utf-8")
    table = re.search(r"<!-- table2: generated -->(.*?)<!-- table2: end -->", results, re.DOTALL)[1]
    ours = [re.findall(r"\| +(\d+\.\d)(?: ±| )", row) for row in re.findall(r".* RMSE .*", table)]
    ours = np.array([row[0::2] for row in ours if row])
    assert [line.split()[1:] for line in printed.splitlines()] == ours.T.tolist()
