import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fprc.errors import ConfigError
from fprc.given import read_yaml

KEYS = st.from_regex("[a-z]{1,5}", fullmatch=True)


@pytest.fixture(scope="module")
def read(tmp_path_factory):
    path = tmp_path_factory.mktemp("yaml") / "a.yaml"

    def read(text):
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return read_yaml(path)

    return read


def test_keys_and_values_are_read(read):
    text = "seed: 2\nfree: [0.1, null, 0x12, 0]\nnames: {b: 'P_o, ü'}  # a comment\n"
    assert read(text) == {"seed": 2, "free": [0.1, None, 18, 0], "names": {"b": "P_o, ü"}}
    assert read("") == read("# nothing\n") == {}


@given(content=st.dictionaries(KEYS, st.recursive(st.integers(), st.lists), min_size=1))
def test_repeated_key_is_refused_for_any_values(read, content):
    whole = json.dumps(content)
    assert read(whole) == content
    for key in content:
        with pytest.raises(ConfigError, match=f"line 1: {key} is a duplicate"):
            read(f"{whole[:-1]}, {key}: 1}}")


@pytest.mark.parametrize(
    ("text", "place"),
    [("a: 1\nb: {c: 1,\n    c: 2}\n", "line 3: c"), ("seed: 2\nmodels: {}\n'seed': 3\n", "line 3"),
     ("a:\n- {form: 1, 'form': 2}\n", "line 2: form"), ("a: !mine 010\n", "line 1"),
     ("a: 1\n---\nb: 2\n", "line 2"), ("? [1, 2]\n: 3\n", "line 1"), ("a:\n\tb: 1\n", "line 2"),
     ("[" * 100_000, ""), ("- 1\n", ""), ("7", ""), ("false", ""), (b"#" * 1_000_001, "bytes"),
     ("a:\n- 0700\n", "line 2: 0700"), ("a: 1:30\n", "line 1: 1:30"), ("a: -1:30.5", "line 1: -1"),
     (b"\xff", ""), ("n: " + "9" * 5000, "")],
)  # fmt: skip
def test_what_is_no_settings_is_refused_in_one_line(read, text, place):
    with pytest.raises(ConfigError) as caught:
        read(text)
    (line,) = str(caught.value).splitlines()
    assert "a.yaml: " in line
    assert place in line
