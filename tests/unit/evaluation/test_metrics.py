import numpy as np
import pytest

from fprc.errors import EvaluationError
from fprc.evaluation import rmse


def test_rmse_is_the_root_of_the_mean_square():
    assert rmse(np.array([0.0, 0.0, 0.0, 0.0]), np.array([1.0, -1.0, 5.0, -3.0])) == 3.0


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_output_that_is_not_finite_is_refused(value):
    with pytest.raises(EvaluationError, match="3 samples is (nan|inf).*not finite.*check"):
        rmse(np.zeros(3), np.array([0.0, value, 0.0]))


@pytest.mark.parametrize("shape", [(3, 1), (1,), (2,)])
def test_arrays_of_different_shapes_are_refused(shape):
    with pytest.raises((EvaluationError, ValueError)):
        rmse(np.arange(3.0), np.zeros(shape))
