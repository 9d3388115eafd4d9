"""The model in docs/extending.md, from outside the package, through the workflow."""

import os
import re
from pathlib import Path

import h5py
import numpy as np
import pandas as pd
import pytest

from fprc.models import load_model

pytestmark = pytest.mark.slow

PAGE = (Path(__file__).parents[2] / "docs/extending.md").read_text(encoding="utf-8")
TARGETS = ["table2", "table4"]


def block(language):
    """The first block of the page in a language."""
    return re.search(rf"```{language}\n(.*?)```", PAGE, flags=re.DOTALL)[1]


@pytest.fixture(scope="module")
def extended(smoked, tmp_path_factory):
    """Results of a smoke run to which a fourth model was added."""
    folder = tmp_path_factory.mktemp("extended") / "project"
    project = smoked.copy(folder)
    (folder / "my_models.py").write_text(block("python"), encoding="utf-8")
    mine = re.sub(r"folders: .*\n", "", block("yaml"))
    (folder / "mine.yaml").write_text(mine, encoding="utf-8")
    path = os.pathsep.join(filter(None, [str(folder), os.environ.get("PYTHONPATH")]))
    asked = ["--configfile", "config/smoke.yaml", "mine.yaml", "--", *TARGETS]
    done = project.snakemake(*asked, PYTHONPATH=path)
    assert done.returncode == 0, done.stdout
    assert re.search(r"^judge +1$", done.stdout, re.MULTILINE)
    return folder / "results/smoke"


def test_model_is_in_the_tables_with_nothing_printed(extended):
    table = pd.read_csv(extended / "tables/table2.csv").set_index("model")
    assert list(dict.fromkeys(table.index)) == ["esn", "fprc", "fuzzy_linear", "ridge_on_taps"]
    ours = table.loc["ridge_on_taps"]
    assert np.isfinite(ours["mean"]).all()
    assert ours["published_mean"].isna().all()
    page = (extended / "tables/table2.md").read_text(encoding="utf-8")
    cells = [row.split("|")[-2].strip() for row in page.splitlines() if row.startswith("| T")]
    assert cells == ["-", "-"]
    loops = pd.read_csv(extended / "tables/table4.csv").set_index("controller")["rmse_deg"]
    assert np.isfinite(loops.loc[["ridge_on_taps", "ridge_on_taps_pd"]]).all()


def test_model_is_ridge_regression_on_taps_and_drives_closed_loops(extended):
    namespace = {"__name__": __name__}
    exec((extended.parents[1] / "my_models.py").read_text(encoding="utf-8"), namespace)
    model = load_model(extended / "models/sweep_ridge_on_taps.h5", [namespace["RidgeOnTaps"]])
    X = np.random.default_rng(1).uniform(0, 60, (40, 1))
    held = np.concatenate([np.full(9, X[0, 0]), X[:, 0]])
    rows = np.array([held[k : k + 10][::-1] for k in range(len(X))])
    w = model.readout_.w_out_
    assert np.allclose(model.predict(X), w[0] + rows @ w[1:])
    with h5py.File(extended / "raw/track_sine_0p2_ridge_on_taps.h5") as log:
        assert np.allclose(log["p_ff_kpa"], model.predict(log["theta_d_deg"][:][:, None]))


def test_class_that_is_not_there_is_refused_by_its_key(smoked, tmp_path):
    mine = tmp_path / "mine.yaml"
    mine.write_text("models: {others: {gone: {estimator: nowhere.Gone}}}", encoding="utf-8")
    done = smoked.snakemake("--nolock", "-n", "--configfile", str(mine), "--", "table2")
    assert done.returncode == 1
    assert "models.others.gone.estimator" in done.stdout
    assert "Traceback" not in done.stdout
