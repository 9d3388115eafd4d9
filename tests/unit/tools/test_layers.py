"""The picture of the packages in CONTRIBUTING.md matches the imports."""

import pytest


@pytest.fixture
def layers(tool):
    return tool("layers")


def test_picture_is_what_the_imports_say(layers):
    page = layers.PAGE.read_text(encoding="utf-8")
    assert layers.updated(page) == page, "the imports have changed: make layers"


def test_every_package_is_in_the_picture_with_arrows_downwards_only(layers):
    floors = {room: floor for floor, layer in enumerate(layers.layers()) for room in layer}
    found = layers.imported()
    assert found.keys() == floors.keys()
    assert all(floors[room] < floors[other] for room in found for other in found[room])
    assert {"devices", "rig"} <= found.keys()
    assert "rig" in found["devices"]
