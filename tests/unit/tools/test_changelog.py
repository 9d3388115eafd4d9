"""The cut of the changelog."""

from datetime import date

import pytest

from fprc.errors import FprcError
from tools.release import changelog

PAGE = """# Changelog

## Unreleased

Added:

- A thing.

## 0.2.0 (2024-05-06)

- The first.
"""


@pytest.fixture
def root(tmp_path):
    (tmp_path / "src/fprc").mkdir(parents=True)
    (tmp_path / "src/fprc/__init__.py").write_text('"""Doc."""\n\n__version__ = "0.2.0"\n')
    (tmp_path / "CHANGELOG.md").write_text(PAGE)
    return tmp_path


def test_cut_dates_the_unreleased_changes_and_sets_the_version(root):
    changelog.cut(root, "0.10.0", date(2025, 1, 2))
    assert (root / "CHANGELOG.md").read_text() == PAGE.replace(
        "## Unreleased", "## Unreleased\n\n## 0.10.0 (2025-01-02)"
    )
    code = (root / "src/fprc/__init__.py").read_text()
    assert code == '"""Doc."""\n\n__version__ = "0.10.0"\n'
    assert changelog.version_of(root) == "0.10.0"
    assert list(changelog.released(root).items()) == [
        ("0.10.0", "2025-01-02"),
        ("0.2.0", "2024-05-06"),
    ]


@pytest.mark.parametrize(
    ("version", "page", "message"),
    [
        ("0.2.0", PAGE, "already has 0.2.0"),
        ("0.1.9", PAGE, "already has 0.2.0"),
        ("next", PAGE, "not a version"),
        ("v0.3.0", PAGE, "write 0.3.0"),
        ("0.3.0", PAGE.replace("Unreleased", "0.2.1 (2024-06-07)"), "needs one heading"),
        ("0.3.0", PAGE.replace("Added:\n\n- A thing.\n", ""), "nothing below"),
    ],
)
def test_cut_refuses_and_changes_nothing(root, version, page, message):
    (root / "CHANGELOG.md").write_text(page)
    with pytest.raises(FprcError, match=message):
        changelog.cut(root, version, date(2025, 1, 2))
    assert (root / "CHANGELOG.md").read_text() == page
    assert changelog.version_of(root) == "0.2.0"
