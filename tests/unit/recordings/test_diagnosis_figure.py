import numpy as np
import pytest

from fprc.figures import style
from fprc.recordings.diagnosis import diagnose
from fprc.recordings.diagnosis_figure import plot_channel
from fprc.recordings.gather import Recording

pytestmark = pytest.mark.usefixtures("figures")  # which closes them

TIME_S = np.arange(6000) / 200.0


@pytest.fixture
def faulty():
    """Channels with a gap, a frozen stretch and a clipped top, and what is found."""
    kept = np.delete(np.arange(6000), slice(1000, 1100))
    time_s = TIME_S[kept]
    wave = np.sin(2 * np.pi * 0.5 * time_s)
    theta = 30.0 * wave + 1e-6 * time_s
    theta[3000:3600] = theta[3000]
    channels = {
        "p_exp_kpa": np.minimum(100.0 + 100.0 * wave, 180.0),
        "theta_deg": theta,
        "p_i_kpa": 200.0 * wave,
        "p_o_kpa": 150.0 + 30.0 * wave,
    }
    quality = {"gap_periods": 1.5, "stuck_s": 2.0}
    recording = Recording(time_s, channels)
    return time_s, channels, diagnose(recording, quality=quality)


def drawn(faulty, name):
    time_s, channels, found = faulty
    _, ax = style.figure(1, 1, 3.5, 2.0)
    plot_channel(time_s, channels[name], name, found, ax)
    return ax


def labels(ax):
    return set(ax.get_legend_handles_labels()[1])


def test_gap_is_shaded_where_it_is(faulty):
    (gap,) = drawn(faulty, "p_i_kpa").patches
    assert gap.get_x() == pytest.approx(999 / 200)
    assert gap.get_width() == pytest.approx(101 / 200)


def test_each_fault_is_marked_on_its_own_channel(faulty):
    assert labels(drawn(faulty, "theta_deg")) == {"gap", "frozen or at rest"}
    assert labels(drawn(faulty, "p_exp_kpa")) == {"gap", "clipped or held at an extreme"}
