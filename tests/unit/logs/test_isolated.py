import pytest

from fprc.errors import LogError
from fprc.logs import isolated
from fprc.logs.isolated import attempt_each, isolated_each, time_limit_s

pytestmark = pytest.mark.slow


def test_prints_do_not_enter_the_results_which_are_in_the_order_of_the_files():
    assert isolated_each(print, ["noise"]) == [None]
    assert isolated_each(len, ["abc", "a", ""]) == [3, 1, 0]
    assert isolated_each(len, []) == []


def test_function_that_is_blocked_is_ended_and_the_file_named(monkeypatch):
    monkeypatch.setattr(isolated, "time_limit_s", lambda paths: 0.2)
    blocked = "__import__('time').sleep(60.0)"
    (found,) = attempt_each(eval, [blocked])
    assert str(found).startswith(f"{blocked}: not read within 2.4 s")
    assert "damaged" not in str(found)


def test_file_that_ends_the_process_is_named_and_the_others_are_read(monkeypatch):
    monkeypatch.setattr(isolated, "time_limit_s", lambda paths: 2.0)
    code = {
        "fine": "3",
        "crash": "__import__('ctypes').string_at(0)",
        "hang": "sum(iter(int, 1))",
        "too much": "__import__('numpy').ones(1 << 32)",
        "last": "5",
    }
    found = dict(zip(code, attempt_each(eval, list(code.values())), strict=True))
    assert (found.pop("fine"), found.pop("last")) == (3, 5)
    assert {name: type(error) for name, error in found.items()} == dict.fromkeys(found, LogError)
    for name, words in (
        ("crash", "crashed"),
        ("hang", "2 s of processor time"),
        ("too much", "MemoryError"),
    ):
        assert str(found[name]).startswith(f"{code[name]}: ")
        assert words in str(found[name])


def test_error_that_is_not_for_people_is_not_taken_for_one():
    with pytest.raises(ZeroDivisionError):
        isolated_each(eval, ["1 / 0"])


def test_larger_files_have_more_time(tmp_path):
    path = tmp_path / "a.h5"
    path.touch()
    least = time_limit_s([path, tmp_path / "none.h5"])
    with path.open("wb") as file:
        file.truncate(200_000_000)
    assert time_limit_s([path]) == pytest.approx(least + 10.0)
