import numpy as np
import pytest

from fprc.channels import NEEDED_SENSORS, Readings
from fprc.config.settings import Control
from fprc.control import RunAbortedError, run


class Bench:
    """Device and clock that record the calls and fail at chosen ones."""

    def __init__(self, fail=None, at=0, error=None):
        self.calls = []
        self.fail, self.at, self.error = fail, at, error or RuntimeError("unplugged")
        self.time_s = 0.0
        self.ticks = -1

    def _remember(self, name):
        self.calls.append(name)
        if name == self.fail and self.ticks == self.at:
            raise self.error

    def wait_for(self, tick):
        self.ticks += 1
        self.time_s = tick * 0.005
        self._remember("wait")
        return tick

    def read(self):
        self._remember("read")
        k = self.ticks
        return Readings(self.time_s, 10.0 + k, 20.0 + k, 30.0 + k, 40.0 + k, 50.0 + k)

    def write(self, main_v, reservoir_v):
        self._remember("write")

    def safe(self):
        self._remember("safe")


def law(k, now):
    return 100.0 + k, 200.0 + now.theta_deg


def go(bench, samples=3, law=law, **options):
    return run(bench, bench, law, samples, Control(), **options)


class Stuttering(Bench):
    """Clock that misses the ticks 2 and 3."""

    def wait_for(self, tick):
        return super().wait_for(4 if tick == 2 else tick)


def test_each_row_is_handed_on_when_it_is_complete():
    kept = []
    bench = Stuttering()
    rows = go(bench, samples=6, keep=lambda k, row: kept.append((k, row, bench.calls[-1])))
    assert [k for k, _, _ in kept] == [0, 1, 4, 5]
    np.testing.assert_allclose(rows["time_s"], 0.005 * np.array([0, 1, 4, 5]))
    np.testing.assert_array_equal(rows["p_exp_command_kpa"], [100.0, 101.0, 104.0, 105.0])
    np.testing.assert_array_equal([row for _, row, _ in kept], np.column_stack(list(rows.values())))
    assert {before for _, _, before in kept} == {"write"}


@pytest.mark.parametrize("where", ["wait", "read", "write"])
@pytest.mark.parametrize("at", [0, 2])
@pytest.mark.parametrize("error", [RuntimeError("unplugged"), KeyboardInterrupt()])
def test_device_is_made_safe_when_it_fails(where, at, error):
    bench = Bench(fail=where, at=at, error=error)
    with pytest.raises((type(error), RunAbortedError)) as caught:
        go(bench)
    assert error in (caught.value, caught.value.__cause__)
    assert bench.calls[-2:] == [where, "safe"]
    assert bench.calls.count("safe") == 1


@pytest.mark.parametrize("sensor", NEEDED_SENSORS)
@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_sensor_without_a_reading_stops_the_run_by_its_name(sensor, value):
    class Dropout(Bench):
        def read(self):
            now = super().read()
            return now._replace(**{sensor: value}) if self.ticks == 1 else now

    bench = Dropout()
    with pytest.raises(RunAbortedError, match=f"no reading of {sensor}"):
        go(bench)
    assert bench.calls == ["wait", "read", "write", "wait", "read", "safe"]


@pytest.mark.parametrize("setpoints", [(np.nan, 0.0), (0.0, np.nan), (np.inf, 0.0), (np.inf,) * 2])
def test_setpoint_that_is_not_finite_stops_the_run_before_it_reaches_a_valve(setpoints):
    bench = Bench()
    with pytest.raises(RunAbortedError, match="must be finite"):
        go(bench, law=lambda k, now: setpoints if k == 1 else law(k, now))
    assert bench.calls == ["wait", "read", "write", "wait", "read", "safe"]
