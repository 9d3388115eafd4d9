"""A second cold build: one core, another folder, time zone, locale and hash seed."""

import json

import pytest

from fprc.fingerprint import reached

pytestmark = pytest.mark.slow


def test_second_build_gives_the_same_bytes(smoked, rebuilt, twice):
    first, second = (project.folder / "results/smoke" for project in (smoked[0], rebuilt[0]))
    before = twice.hashes(second)
    twice.give_measurements(first, second)
    done = rebuilt[0].smoke("all")
    assert done.returncode == 0, done.stdout
    ours, theirs = twice.hashes(first), twice.hashes(second)
    assert before != theirs, "times that were measured anew were the same"
    assert twice.differences(ours, theirs) == []
    assert {"report.html", "claims.json", "figures/fig10_settings.pdf"} <= ours.keys()


def test_differences_are_found(twice, tmp_path):
    for folder, files in {
        "one": {"a": "1", "b": "2"},
        "two": {"a": "1", "b": "3", "c": "4"},
    }.items():
        (tmp_path / folder).mkdir()
        for name, text in files.items():
            (tmp_path / folder / name).write_text(text)
    hashes = [twice.hashes(tmp_path / folder) for folder in ("one", "two")]
    assert twice.differences(*hashes) == ["b", "c"]
    assert "different: c" in twice.table(hashes[0], ["b", "c"])


def test_every_function_that_ran_is_in_the_fingerprint_of_its_rule(rebuilt):
    asked, ran = {}, {}
    for path in rebuilt[1].glob("*.txt"):
        for line in path.read_text(encoding="utf-8").splitlines():
            kind, rule, what = line.split(" ", 2)
            if kind == "asked":
                asked[rule] = json.loads(what)
            elif "<" not in what:  # a lambda or comprehension at the top of a module
                ran.setdefault(rule, set()).add(what)
    assert len(ran) > 40
    missing = {}
    for rule, names in ran.items():
        roots, without = asked[rule]
        missing[rule, roots[0], roots[-1]] = names - reached(*roots, without=without)
    assert {rule: names for rule, names in missing.items() if names} == {}
