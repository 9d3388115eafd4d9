import pytest

from fprc.config import Settings
from fprc.plan import on_rig


@pytest.fixture
def family(signals):
    """A family of the default rig, with short experiments."""
    settings = Settings().model_dump(mode="json")
    return {
        "name": "dry",
        "every_model": True,
        "members": None,
        "fitted": ["tables"],
        "on_rig": on_rig(settings)
        | {"signals": {name: signal.model_dump() for name, signal in signals.items()}},
    }
