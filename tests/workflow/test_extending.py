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


def block(language):
    """The first block of the page in a language."""
    return re.search(rf"```{language}\n(.*?)```", PAGE, flags=re.DOTALL)[1]


def test_model_from_outside_is_in_the_tables_and_drives_closed_loops(smoked_copy):
    folder = smoked_copy.folder
    (folder / "my_models.py").write_text(block("python"), encoding="utf-8")
    mine = re.sub(r"folders: .*\n", "", block("yaml"))
    (folder / "mine.yaml").write_text(mine, encoding="utf-8")
    path = os.pathsep.join(filter(None, [str(folder), os.environ.get("PYTHONPATH")]))
    asked = ["--configfile", "config/smoke.yaml", "mine.yaml", "--", "table2", "table4"]
    done = smoked_copy.snakemake(*asked, PYTHONPATH=path)
    assert done.returncode == 0, done.stdout
    assert re.search(r"^judge +1$", done.stdout, re.MULTILINE)  # the others need not run again
    results = folder / "results/smoke"
    table = pd.read_csv(results / "tables/table2.csv").set_index("model")
    assert list(dict.fromkeys(table.index)) == ["esn", "fprc", "fuzzy_linear", "ridge_on_taps"]
    ours = table.loc["ridge_on_taps"]
    assert np.isfinite(ours["mean"]).all()
    assert ours["published_mean"].isna().all()
    loops = pd.read_csv(results / "tables/table4.csv").set_index("controller")["rmse_deg"]
    assert np.isfinite(loops.loc[["ridge_on_taps", "ridge_on_taps_pd"]]).all()
    namespace = {"__name__": __name__}
    exec((folder / "my_models.py").read_text(encoding="utf-8"), namespace)
    model = load_model(results / "models/sweep_ridge_on_taps.h5", [namespace["RidgeOnTaps"]])
    with h5py.File(results / "raw/track_sine_0p2_ridge_on_taps.h5") as log:
        assert np.allclose(log["p_ff_kpa"], model.predict(log["theta_d_deg"][:][:, None]))


def test_class_that_is_not_there_is_refused_by_its_key(project):
    (project.folder / "mine.yaml").write_text("models: {others: {gone: {estimator: nowhere.Gone}}}")
    done = project.snakemake("-n", "--configfile", "mine.yaml", "--", "table2")
    assert done.returncode == 1
    assert "models.others.gone.estimator" in done.stdout
    assert "Traceback" not in done.stdout
