"""The picture of the packages in CONTRIBUTING.md matches the imports."""

import pytest


@pytest.fixture
def layers(tool):
    return tool("layers")


def test_picture_is_what_the_imports_say(layers):
    page = layers.PAGE.read_text(encoding="utf-8")
    assert layers.updated(page) == page, "the imports have changed: make layers"
