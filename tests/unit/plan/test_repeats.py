import json

import pytest

from fprc.errors import FprcError
from fprc.plan.repeats import landing_tests, read_fits, variants_beside
from fprc.tables.repeats import Limits

TWELVE, SIX = list(range(12)), list(range(6))
SPREAD = [f"again_from_pilot_{number}" for number in (3, 4, 5, 6)]


def put(folder, name, **changes):
    report = {"seeds": TWELVE, "finished": True} | changes
    (folder / f"{name}.yaml").touch()
    (folder / f"{name}.json").write_text(json.dumps(report))


def test_seeds_are_those_of_the_reports(tmp_path):
    put(tmp_path, "b", seeds=SIX)
    put(tmp_path, "a")
    assert list(read_fits(tmp_path).items()) == [("a", TWELVE), ("b", SIX)]


def test_everything_that_is_wrong_is_reported_at_once(tmp_path):
    put(tmp_path, "good")
    put(tmp_path, "viscous")
    put(tmp_path, "late", finished=False)
    put(tmp_path, "seen", seeds=[500, 501, 510, 511, 540])
    put(tmp_path, "other", seeds=3)
    (tmp_path / "alone.yaml").touch()
    (tmp_path / "broken.yaml").touch()
    (tmp_path / "broken.json").write_text('{"seeds": [')
    with pytest.raises(FprcError) as raised:
        read_fits(tmp_path, {"viscous"})
    lines = str(raised.value).splitlines()
    assert [line.partition(": ")[0].rpartition("/")[2] for line in lines] == [
        "alone.json", "broken.json", "late.json", "other.json", "seen.json", "viscous.yaml"
    ]  # fmt: skip
    assert "501, 510, 540;" in lines[4]


def test_folder_that_is_empty_or_missing_has_no_fits(tmp_path):
    assert read_fits(tmp_path) == read_fits(tmp_path / "none") == {}


def test_every_repeat_is_judged_by_the_first_limits():
    # docs/preregistration.md: at most 8 % and 30 %, 9 points, 0.60 to 0.82, on 501 to 510
    tests = landing_tests({"again": SIX, "mine": TWELVE})
    assert tests.keys() == {"repeats"}
    assert tests["repeats"].rigs == ("again", "mine")
    assert list(tests["repeats"].seeds) == list(range(501, 511))
    assert Limits(**tests["repeats"].limits) == (0.08, 0.30, 9, (0.60, 0.82))


def test_spread_of_four_repeats_judges_those_with_as_many_seeds():
    # on 521 to 540, and with the same limits but that of the median
    tests = landing_tests({"old": SIX, **dict.fromkeys(SPREAD, TWELVE), "new": TWELVE})
    assert tests["spread"].rigs == (*SPREAD, "new")
    assert tests["spread"].spread_of == tuple(SPREAD)
    assert list(tests["spread"].seeds) == list(range(521, 541))
    assert Limits(**tests["spread"].limits, median=0.08) == (0.08, 0.30, 9, (0.60, 0.82))


def test_seeds_of_the_two_tests_and_of_the_kept_fits_are_different(request):
    folder = request.config.rootpath / "config/rigs/repeats"
    fitted_on = read_fits(folder)
    assert fitted_on.keys() >= set(SPREAD)
    first, second = (set(test.seeds) for test in landing_tests(fitted_on).values())
    assert not first & second


BESIDE = [*SPREAD, "again_from_pilot_7", "again_from_pilot_8"]


def test_variants_stand_beside_the_six_repeats_with_twelve_seeds():
    repeats = {"old": SIX, **dict.fromkeys(BESIDE, TWELVE), "again_mine": TWELVE}
    found = variants_beside(repeats, {"damped": TWELVE})
    assert found.rigs == (*BESIDE, "damped")
    assert list(found.seeds) == list(range(501, 511))


def test_variants_that_cannot_be_compared_are_refused_with_every_reason():
    repeats = dict.fromkeys(BESIDE[1:], TWELVE)
    with pytest.raises(FprcError) as raised:
        variants_beside(repeats, {"few": SIX, "enough": TWELVE})
    missing, few = str(raised.value).splitlines()
    assert BESIDE[0] in missing
    assert few.startswith("few: fitted on 6 seeds, and the repeats on 12")
    with pytest.raises(FprcError, match="no fit with other settings"):
        variants_beside(dict.fromkeys(BESIDE, TWELVE), {})


def test_kept_variants_stand_beside_repeats_4_to_9(request):
    folder = request.config.rootpath / "config/rigs"
    found = variants_beside(read_fits(folder / "repeats"), read_fits(folder / "variants"))
    assert found.variants == ("damped_from_pilot", "damped_from_pilot_2")
