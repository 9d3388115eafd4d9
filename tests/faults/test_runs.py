"""Whole experiments through driver and bus, compared with the simulator's own log."""

import hashlib

import numpy as np
import pytest

from fprc.apparatus import process
from fprc.apparatus.journal import read_journal
from fprc.channels import LEARNING_CHANNELS, RAW_CHANNELS, SENSORS, TRACKING_CHANNELS
from fprc.config.settings import Control, Signal, Tracking
from fprc.experiments.data import acquire
from fprc.experiments.tracking import TRACKING_RUNS, Track
from fprc.logs import read_columns, read_raw, read_run
from fprc.models import FPRC, load_model, save_model

# The driver's voltages are float32: a reading at the edge of a step may fall to the next one, and
# the loops carry that on.
PRESSURE_STEP_KPA = 20.0 / 2**16 * 250.0
ANGLE_STEP_DEG = 1.0 / 64.0


def compare(found, expected):
    """Check that two records agree within a few steps of a converter."""
    for name in SENSORS:
        step = PRESSURE_STEP_KPA if name.endswith("_kpa") else ANGLE_STEP_DEG
        difference = np.abs(found[name] - expected[name])
        assert np.ptp(expected[name]) > 0.0
        assert difference.max() <= 4.01 * step, name
        assert np.mean(difference > 0.5 * step) < 0.2, name
    assert found["time_s"] == pytest.approx(expected["time_s"], abs=1e-9)


def test_hysteresis_experiment_is_that_of_the_simulator(bench, settings, live_by, tmp_path):
    settings["experiments"]["sweep"]["duration_s"] = 20.0
    _, guardian = live_by(bench)
    raw = tmp_path / "sweep.h5"
    process.record("sweep", str(raw), settings=settings, guardian=guardian)
    log = read_raw(raw, experiment="sweep", sample_rate_hz=200.0, rate_tolerance=1e-6)
    signal, control = Signal(**settings["experiments"]["sweep"]), Control(**settings["control"])
    assert len(log.channels["time_s"]) == round(signal.duration_s * 200.0) == 4_000
    compare(log.channels, acquire("sweep", signal, control, settings["rig"], seed=1))
    assert (log.attributes["source"], log.attributes["complete"]) == ("rig", True)
    assert list(bench.shared.outputs[:2]) == [0.0, 0.0]


@pytest.mark.parametrize("adapt", [False, True])
def test_closed_loop_is_that_of_the_simulator(make_bench, settings, live_by, tmp_path, adapt):
    settings["control"]["feedforward"]["adapt"] = adapt
    reference = settings["tracking"]["references"]["sine_0p5"]
    reference |= {"duration_s": 5.0, "settle_s": 0.5}
    signal = Signal(**settings["experiments"]["sweep"]).changed(duration_s=20.0)
    control, tracking = Control(**settings["control"]), Tracking(**settings["tracking"])
    log = acquire("sweep", signal, control, settings["rig"], seed=1)
    X = np.column_stack([log["theta_deg"], log["p_o_kpa"]])
    model = tmp_path / "fprc.h5"
    save_model(FPRC(n_c=2, random_state=1).fit(X, log["p_exp_command_kpa"]).remember(X), model)

    _, guardian = live_by(make_bench(settings, run=TRACKING_RUNS["sine_0p5"]))
    raw, name = tmp_path / "track.h5", "track_sine_0p5_fprc_pd"
    process.record(name, str(raw), settings=settings, model=str(model), guardian=guardian)
    learned = LEARNING_CHANNELS if adapt else ()
    found = read_columns(raw, (*RAW_CHANNELS, *TRACKING_CHANNELS, *learned))

    simulator = Track(tracking, control, settings["rig"], settings["seed"])
    theta_d = simulator.reference("sine_0p5")
    expected = simulator.follow("sine_0p5", ["fprc_pd"], {"fprc": load_model(model)})["fprc_pd"]
    compare(found.channels, expected)
    assert np.array_equal(found.channels["theta_d_deg"], theta_d)
    assert np.ptp(found.channels["p_ff_kpa"]) > 10.0
    assert np.ptp(found.channels["p_fb_kpa"]) > 1.0
    if adapt:
        p_learned = found.channels["p_learned_kpa"]
        assert np.ptp(p_learned) > 0.5
        np.testing.assert_allclose(p_learned, expected["p_learned_kpa"], atol=0.5)
    described = found.attributes
    assert (described["experiment"], described["controller"]) == (name, "fprc_pd")
    digest = hashlib.sha256(model.read_bytes()).hexdigest()
    assert [described[key] for key in ("model", "model_file", "model_sha256")] == [
        "FPRC", "fprc.h5", digest,
    ]  # fmt: skip
    assert read_run(raw).attributes == described
    assert described["rig"]["control"]["pd"] == settings["control"]["pd"]
    (journal,) = tmp_path.glob("*.journal")
    channels, attributes, _ = read_journal(journal)
    assert attributes["complete"]
    for channel, values in channels.items():
        assert np.array_equal(values, found.channels[channel])
