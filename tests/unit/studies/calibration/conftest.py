import pytest

from fprc.config import Settings
from fprc.experiments.data import RigSettings


@pytest.fixture(scope="session")
def on_rig():
    """Both experiments cut to 8 s; of different lengths, since the paper's are."""
    settings = Settings().model_dump(mode="json")
    signals = settings["experiments"]
    signals["sweep"] |= {"duration_s": 8.0, "f_hz": [0.8, 1.0]}  # whole loops in its first quarter
    signals["complex"] |= {"duration_s": 7.0}
    return RigSettings(
        rig=settings["rig"], control=settings["control"], signals=signals, target="command"
    )


@pytest.fixture(scope="session")
def tracking():
    """References of 2 s."""
    found = Settings().model_dump(mode="json")["tracking"]
    for name, reference in found["references"].items():
        f_hz = [0.5, 1.0] if name == "sweep" else reference["f_hz"]
        reference |= {"f_hz": f_hz, "duration_s": 2.0, "settle_s": 0.5}
    found["pushes"]["quiet_s"] = 1.0
    return found
