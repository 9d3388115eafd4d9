"""What is generated from the settings, and committed: so any change of a setting shows."""

from pathlib import Path

import pytest

from fprc.config import reference

ROOT = Path(__file__).parents[3]


@pytest.mark.parametrize(
    ("page", "file"),
    [(reference.defaults, "config/config.yaml"), (reference.reference, "docs/configuration.md")],
)
def test_generated_file_is_up_to_date(page, file):
    committed = (ROOT / file).read_text(encoding="utf-8")
    assert committed == page(), f"{file} is stale: run `fprc config {page.__name__} > {file}`"
