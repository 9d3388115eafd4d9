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


@pytest.mark.parametrize(
    ("text", "places"),
    [("a: 1\nb: {c: 1,\n    c: 2}\na: 3\nd: 4\n", ["line 3: c", "line 4: a"]),
     ("seed: 2\nmodels: {}\n'seed': 3\n", ["line 3: seed"]),
     ("a:\n- {form: 1, 'form': 2}\n", ["line 2: form"]),
     ("a: &x 1\nb: *x\n", ["line 2: *x"]), ("a: &x {c: 1}\nb:\n  <<: *x\n", ["line 3: *x"]),
     ("a: &x [*x]\n", ["line 1: *x"]), ("a: !mine 010\n", ["line 1"]),
     ("a: 1\n---\nb: 2\n", ["line 2"]), ("? [1, 2]\n: 3\n", ["line 1"]),
     ("[" * 100_000, []), ("- " * 10_000, []), ("- 1\n", []), ("7", []), ("false", []),
     (b"#" * 1_000_001, ["1,000,001 bytes"]), (b"\xff", []), ("n: " + "9" * 5000, [])],
)  # fmt: skip
def test_what_settings_do_not_need_is_refused_with_every_place(read, text, places):
    (line,) = refused(read, text)
    assert [place for place in places if place not in line] == []
