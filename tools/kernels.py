"""Compile the kernels once: processes that begin together would each compile them."""

from itertools import chain

from fprc.config import check
from fprc.control import run
from fprc.devices.sim import SimulatedRig
from fprc.experiments.data import Data
from fprc.experiments.hysteresis import acquire
from fprc.experiments.tracking import Track
from fprc.registry import SIDES, build


def main() -> None:
    """Simulate a short experiment, train every model on it, and track a reference with one."""
    settings = check({})
    control, rig, models = settings.control, settings.rig.model_dump(), settings.models.model_dump()
    signal = settings.experiments.sweep.changed(duration_s=2.0)
    log = acquire("sweep", signal, control, rig, seed=1)
    data = Data(log | {"p_target_kpa": log["p_exp_kpa"]}, {})
    for name in (*chain(*SIDES.values()), "fuzzy_linear"):
        X, y, _ = data.samples(name)
        changed = {"r": 20} if name.startswith("esn") else {}
        model = build(name, models, 1, **changed).fit(X, y)
        model.predict(X)
        model.step(X[0])
    X, y, _ = data.samples("fprc")
    fprc = build("fprc", models, 1).fit(X, y).remember(X)
    for adapt in (False, True):
        learning = control.changed(feedforward=control.feedforward.changed(adapt=adapt))
        bench = Track(settings.tracking, learning, rig, 1)
        bench.follow("sine_0p5", ["fprc_pd"], {"fprc": fprc})
        law = bench.law(bench.reference("sine_0p5")[:100], "fprc_pd", fprc)
        device = SimulatedRig(rig, seed=1, run=0, sample_rate_hz=control.sample_rate_hz)
        extra = bench.channels("fprc_pd")
        run(device, device, law, 100, control, extra=extra)


if __name__ == "__main__":
    main()
