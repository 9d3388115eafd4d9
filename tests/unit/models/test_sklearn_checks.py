import pytest
from sklearn.utils.estimator_checks import parametrize_with_checks

from fprc.models import (
    ESN,
    FPRC,
    NVAR,
    EchoStates,
    FeatureModel,
    FuzzyLinear,
    LowpassBank,
    PlayOperators,
    RidgeReadout,
    SideBySide,
    TakagiSugenoReadout,
    TapFeatures,
)

#: Checks that take rows for independent of one another; here they are samples in time: an output
#: depends on those before it, and part of a log has another past than the whole log.
MEMORY = ("check_methods_sample_order_invariance", "check_methods_subset_invariance")

READOUTS = [RidgeReadout(), TakagiSugenoReadout(n_c=3)]

# The checks' data depend on one column, which FPRC sees unfiltered at epsilon = 1 only.
MAPS = [
    TapFeatures(),
    PlayOperators(n_plays=3),
    LowpassBank((0.9, 0.1)),
    NVAR(n_taps=2, spacing=2),
    SideBySide([(TapFeatures(n_references=None), [0]), (LowpassBank((0.9, 0.5)), [0])]),
]
SEQUENTIAL = [
    *MAPS,
    FeatureModel(TapFeatures(n_references=None), RidgeReadout(), random_state=1),
    EchoStates(r=12),
    ESN(r=12, washout=20),
    FPRC(n_c=3, epsilon=1.0),
    FuzzyLinear(n_c=3),
]


@parametrize_with_checks(READOUTS)
def test_readout_passes_scikit_learns_check(estimator, check):
    check(estimator)


@pytest.mark.slow
@parametrize_with_checks(SEQUENTIAL)
def test_model_with_memory_passes_scikit_learns_check(estimator, check):
    if check.func.__name__ in MEMORY:
        with pytest.raises((AssertionError, ValueError)):  # a row alone is a log that is too short
            check(estimator)
    else:
        check(estimator)
