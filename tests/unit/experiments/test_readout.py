import numpy as np
import pytest

from fprc.experiments.data import Data
from fprc.experiments.readout import shifted

#: A P_o that leaks, over two recordings.
P_O = np.linspace(100.0, 60.0, 500)
LENGTHS = {"monday": 200, "tuesday": 300}


def log():
    channels = {"theta_deg": np.arange(500.0), "p_target_kpa": np.ones(500), "p_o_kpa": P_O}
    return Data(channels | {"time_s": np.arange(500) / 200.0}, {"recordings": LENGTHS})


@pytest.mark.parametrize("seed", range(5))
def test_shifted_p_o_is_that_of_another_time_of_the_same_recording(seed):
    X, y = shifted(log(), seed).pair("fprc")
    np.testing.assert_array_equal(X[:, 0], log().channels["theta_deg"])
    begin = 0
    for length in LENGTHS.values():
        whole, found = P_O[begin : begin + length], X[begin : begin + length, 1]
        begin += length
        (shift,) = np.flatnonzero(found == whole[0])
        np.testing.assert_array_equal(np.roll(whole, shift), found)
        assert 0.24 * length < shift < 0.76 * length
    assert y.shape == (500,)
