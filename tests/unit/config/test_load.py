import copy
import re
from pathlib import Path

import pytest

from fprc.config import Settings, check, from_files, local_files, rig_files
from fprc.config.reference import RIG
from fprc.errors import ConfigError

CONFIG = Path(__file__).parents[3] / "config"


def message(config):
    """Return what is wrong with a configuration, which the check leaves as it is."""
    before = copy.deepcopy(config)
    with pytest.raises(ConfigError) as caught:
        check(config)
    assert str(config) == str(before)  # NaN differs from itself
    return str(caught.value)


def keys_of(text):
    """Return the keys of a message that lists errors."""
    head, *lines = text.splitlines()
    assert head.split(" ")[0] == str(len(lines))
    return [re.split(" = |: ", line.strip(), maxsplit=1)[0] for line in lines]


@pytest.fixture
def written(tmp_path):
    """Write YAML texts to files and return their paths."""

    def write(*texts):
        paths = [tmp_path / f"{k}.yaml" for k in range(len(texts))]
        for path, text in zip(paths, texts, strict=True):
            path.write_text(text, encoding="utf-8")
        return paths

    return write


def test_error_tells_place_value_limit_and_remedy():
    _, line = message({"models": {"fprc": {"n_c": 0}}}).splitlines()
    assert re.findall(r"[\w.]*\w", line)[:2] == ["models.fprc.n_c", "0"]
    assert re.findall(r"\d+", line) == ["0", "1", "8"]


def test_every_error_is_reported_at_once():
    text = message(
        {
            "seed": "one",
            "modles": {},
            "models": {"fprc": {"n_c": 0, "epsilom": 0.1}},
            "experiments": {"sweep": {"duration_s": float("nan")}},
            "rig": {"valve": {"leak": 3}, "bending": {"slip_weight": [1.0]}},
            "calibration": {"ranges": {"friction_law": [0.0, 1.0]}},
        }
    )
    assert set(keys_of(text)) == {
        "seed", "modles", "models.fprc.n_c", "models.fprc.epsilom",
        "experiments.sweep.duration_s", "rig.valve.leak", "rig.bending", "calibration",
    }  # fmt: skip


def test_missing_rig_and_unreadable_file_hide_no_error(written):
    paths = written("rig: papr\nmodles: 1\n", "models:\n\tesn: 1\n", "seed: 1\nseed: 2\n")
    with pytest.raises(ConfigError) as caught:
        from_files(paths, {"seed": "one"})
    rig, file, repeated, *others = str(caught.value).splitlines()
    assert "papr" in rig
    assert file.startswith(str(paths[1]))
    assert repeated.startswith(str(paths[2]))
    assert set(keys_of("\n".join(others))) == {"modles", "seed"}


@pytest.mark.parametrize(
    ("config", "unknown", "nearest"),
    [({"models": {"fprc": {"epsilom": 1}}}, "models.fprc.epsilom", "models.fprc.epsilon"),
     ({"modles": {}}, "modles", "models"), ({"n_c": 1}, "n_c", "models.fprc.n_c"),
     ({"models": {"fprc": {"r": 1}}}, "models.fprc.r", "models.esn.r"),
     ({"rig": {"valve": {"leek": 1}}}, "rig.valve.leek", "rig.valve.leak"),
     ({"control": {"pd": {"kp": 1}}}, "control.pd.kp", "control.pd.kp_kpa_per_deg")],
)  # fmt: skip
def test_unknown_key_names_the_nearest(config, unknown, nearest):
    assert f"  {unknown}: unknown key; did you mean {nearest}?" in message(config)


def test_later_files_win_key_by_key_and_what_stands_beside_them_last(written):
    first = "seed: 1\nmodels: {n_y: 7, fprc: {n_c: 4, n_u: 2}}\n"
    paths = written(first, "seed: 2\nmodels: {fprc: {n_c: 5}}\n")
    for beside, n_y in ((None, 7), ({"models": {"n_y": "08"}}, 8)):
        settings = from_files(paths, beside)
        fprc = settings.models.fprc
        assert (settings.seed, settings.models.n_y, fprc.n_c, fprc.n_u) == (2, n_y, 5, 2)
    with pytest.raises(ConfigError, match=r"models\.n_z: unknown key"):
        from_files(paths, {"models": {"n_z": 1}})


DRY = "fitted: {name: dry, to: [tables, C8]}\nrig: {drift: {sigma_kpa: 2.0, time_s: 3.0}}\n"
WET = "rig: {drift: {time_s: 4.0}, bending: {preload_kpa: 30}}\n"


@pytest.fixture
def rigs(tmp_path, monkeypatch):
    """Two rigs below the working directory; ``wet`` does not say what it was fitted to."""
    folder = tmp_path / "config/rigs"
    folder.mkdir(parents=True)
    (folder / "dry.yaml").write_text(DRY, encoding="utf-8")
    (folder / "wet.yaml").write_text(WET, encoding="utf-8")
    (folder / "dry.json").write_text("{}", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return folder


DRY_TERMS, DRIFT = ("tables", "C8"), Settings().rig.drift
#: Files, a mapping beside them, and the rig that they stand for: its name and terms, and its drift.
LAYERS = [
    (["seed: 4\nrig: dry\n"], None, ("dry", DRY_TERMS), (2.0, 3.0)),
    ([DRY], None, ("dry", DRY_TERMS), (2.0, 3.0)),
    (["rig: wet\n"], {"rig": "dry"}, ("dry", DRY_TERMS), (2.0, 3.0)),
    (["rig: wet\n", DRY], None, ("dry", DRY_TERMS), (2.0, 3.0)),
    (["rig: dry\n", "seed: 5\n"], {"models": {"n_y": 6}}, ("dry", DRY_TERMS), (2.0, 3.0)),
    # a name replaces the whole rig before it, also where its own file leaves defaults
    (["rig: dry\n", "rig: wet\n"], None, ("wet", ()), (DRIFT.sigma_kpa, 4.0)),
    ([DRY, "rig: wet\n"], None, ("wet", ()), (DRIFT.sigma_kpa, 4.0)),
    (["rig: {drift: {sigma_kpa: 9.0}}\n", "rig: wet\n"], None, ("wet", ()),
     (DRIFT.sigma_kpa, 4.0)),
    # numbers after a name change the rig, which is then no fitted one
    (["rig: dry\n", "rig: {drift: {time_s: 7.0}}\n"], None, ("changed", ()), (2.0, 7.0)),
    (["rig: dry\n"], {"rig": {"drift": {"time_s": 7.0}}}, ("changed", ()), (2.0, 7.0)),
]  # fmt: skip


def fitted(settings):
    return settings.fitted.name, settings.fitted.to


@pytest.mark.usefixtures("rigs")
@pytest.mark.parametrize(("texts", "beside", "fit", "drift"), LAYERS)
def test_rig_of_files_and_of_what_stands_beside_them(written, texts, beside, fit, drift):
    settings = from_files(written(*texts), beside)
    assert fitted(settings) == fit
    assert (settings.rig.drift.sigma_kpa, settings.rig.drift.time_s) == drift
    preload = 30.0 if fit[0] == "wet" else Settings().rig.bending.preload_kpa
    assert settings.rig.bending.preload_kpa == preload


@pytest.mark.usefixtures("rigs")
@pytest.mark.parametrize("name", ["drie", "", "../rigs/dry", "dry.yaml"])
def test_unknown_name_is_refused_with_those_that_there_are(written, name):
    for files, beside in ((written(f"rig: '{name}'\n"), None), ([], {"rig": name})):
        with pytest.raises(ConfigError, match="bouc_wen, dry, paper, viscous or wet"):
            from_files(files, beside)


def test_rig_is_the_fitted_one_where_none_is_given(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    named = check({"rig": RIG})
    assert fitted(named)[0] == RIG
    assert check({}) == from_files([]) == named
    changed = check({"rig": {"drift": {"time_s": 7.0}}})
    assert fitted(changed) == ("changed", ())
    drift = named.rig.drift.model_copy(update={"time_s": 7.0})
    assert changed.rig == named.rig.model_copy(update={"drift": drift})


def test_configuration_of_the_paper_is_the_default_but_for_its_rig():
    settings = from_files([CONFIG / "config.yaml"])
    assert settings.fitted.name == RIG
    of_the_class = {"rig": Settings().rig, "fitted": Settings().fitted}
    assert settings.model_copy(update=of_the_class) == Settings()


@pytest.mark.parametrize("name", sorted(rig_files()))
def test_every_rig_of_the_package_is_valid_and_has_the_name_of_its_file(
    name, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    settings = from_files([], {"rig": name})
    assert settings.fitted.name == name
    assert (name == "bouc_wen") == (not settings.fitted.to)
    assert settings.rig != Settings().rig


def test_local_configuration_that_is_a_broken_link_is_not_passed_over(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert local_files() == []
    (tmp_path / "config").mkdir()
    (tmp_path / "config/config.yaml").symlink_to("nowhere")
    with pytest.raises(ConfigError, match=r"config\.yaml: cannot be opened"):
        from_files(local_files())
