"""The choice of the clustering reaches the fuzzy models through the workflow."""

import re

import numpy as np
import pandas as pd
import pytest

pytestmark = pytest.mark.slow


def test_table2_with_scikit_fuzzy_has_the_errors_of_our_clustering(smoked, smoked_copy):
    chosen = "models={fprc: {clustering: scikit-fuzzy}}"
    done = smoked_copy.smoke("table2", "--config", chosen)
    assert done.returncode == 0, done.stdout
    jobs = dict(re.findall(r"^(\w+) +(\d+)$", done.stdout, flags=re.MULTILINE))
    assert jobs["judge"] == "2", "the ESN has no clusters"
    ours, theirs = (
        pd.read_csv(project.folder / "results/smoke/tables/table2.csv").set_index("model")["mean"]
        for project in (smoked[0], smoked_copy)
    )
    assert not ours.equals(theirs), "both stop a little before the optimum, at different places"
    np.testing.assert_allclose(theirs, ours, rtol=1e-3)
