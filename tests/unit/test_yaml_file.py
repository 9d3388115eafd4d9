import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fprc.errors import ConfigError
from fprc.yaml_file import read_yaml


@pytest.fixture(scope="session")
def read(tmp_path_factory):
    """Read a text, or bytes, as a file."""
    path = tmp_path_factory.mktemp("yaml") / "mine.yaml"

    def read_text(text):
        path.write_bytes(text if isinstance(text, bytes) else text.encode("utf-8"))
        return read_yaml(path)

    return read_text


def refused(read, text):
    """Return the lines of the refusal, without the file's name."""
    with pytest.raises(ConfigError) as caught:
        read(text)
    path, message = str(caught.value).split(": ", 1)
    assert path.endswith("mine.yaml")
    return message.splitlines()


@pytest.mark.parametrize(
    ("written", "meant"),
    [("010", 10), ("0o17", 15), ("0x1F", 31), ("1e3", 1000.0), ("2.5E+2", 250.0), (".5", 0.5),
     ("-.inf", -math.inf), ("1:30", "1:30"), ("1_000", "1_000"), ("2026-01-02", "2026-01-02"),
     ("inf", "inf"), ("'010'", "010"), ("true", True), ("tRUE", "tRUE"), ("", None)],
)  # fmt: skip
def test_word_has_its_meaning_in_yaml_1_2(read, written, meant):
    found = read(f"key: {written}\n")["key"]
    assert (type(found), str(found)) == (type(meant), str(meant))


#: Characters that YAML has in common with JSON.
TEXT = st.text(
    st.characters(exclude_categories=["Cs", "Cc"], exclude_characters="\ufeff\ufffe\uffff")
)
JSON = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**70), 2**70) | st.floats(allow_nan=False,
    allow_infinity=False) | TEXT,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(TEXT, inner, max_size=4),
    max_leaves=12,
)  # fmt: skip


@given(content=st.dictionaries(TEXT, JSON, max_size=4), indent=st.sampled_from([None, 2, "\t"]))
def test_json_is_read_as_a_json_reader_does(read, content, indent):
    written = json.dumps(content, indent=indent, ensure_ascii=False)
    assert read(written) == json.loads(written)


@given(content=st.dictionaries(st.from_regex("[a-z]{1,5}", fullmatch=True), JSON, min_size=1))
def test_duplicate_key_is_refused_for_any_values(read, content):
    whole = json.dumps(content, ensure_ascii=False)
    for key in content:
        again = f"{whole[:-1]}, {json.dumps(key)}: 1}}"
        (line,) = refused(read, again)
        assert f"line 1: {key} is a duplicate" in line


def test_every_duplicate_key_is_named_with_its_line(read):
    (line,) = refused(read, "a: 1\nb: {c: 1,\n    c: 2}\na: 3\nd: 4\n")
    assert "line 3: c is a duplicate" in line
    assert "line 4: a is a duplicate" in line


@pytest.mark.parametrize(
    ("text", "line"),
    [("a: &x 1\nb: *x\n", "line 2: *x is an alias"),
     ("a: &x {c: 1}\nb:\n  <<: *x\n", "line 3: *x is an alias"),
     ("a: &x [*x]\n", "line 1: *x is an alias"), ("a: !!int 010\n", "line 1: remove the tag"),
     ("a: 1\n---\nb: 2\n", "line 2: --- begins another document"),
     ("seed: 2\nmodels: {}\n'seed': 3\n", "line 3: seed is a duplicate"),
     ("a:\n- {form: 1, 'form': 2}\n", "line 2: form is a duplicate"),
     ("? [1, 2]\n: 3\n", "line 1: [1, 2]: a key must be a single word"),
     ("? {1: 2}\n: 3\n", "line 1: {1: 2}: a key must be a single word")],
)  # fmt: skip
def test_yaml_features_that_settings_do_not_need_are_refused_with_their_line(read, text, line):
    (found,) = refused(read, text)
    assert line in found


@pytest.mark.parametrize(
    "text", ["[" * 100_000, "\n".join(" " * n + "a:" for n in range(1000)), "- " * 10_000]
)
def test_value_that_is_nested_too_deeply_is_refused(read, text):
    (line,) = refused(read, text)
    assert "more than 50 levels" in line


def test_file_that_is_too_large_is_not_read(read):
    (line,) = refused(read, b"#" * 1_000_001)
    assert "1,000,001 bytes" in line
    assert read(b"#" * 1_000_000) == {}


@pytest.mark.parametrize("text", ["- 1\n", "7", "false"])
def test_file_that_holds_something_else_is_refused(read, text):
    assert len(refused(read, text)) == 1
