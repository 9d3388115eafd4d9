import re
from pathlib import Path

import pytest

from fprc.config import Settings, check, from_files, rig_files
from fprc.config.load import RIG, defaults, reference
from fprc.errors import ConfigError

ROOT = Path(__file__).parents[3]


def lines_of(config):
    """Return what is wrong with a configuration, as keys and what is said of them."""
    with pytest.raises(ConfigError) as caught:
        check(config)
    head, *lines = str(caught.value).splitlines()
    assert head.split(" ")[0] == str(len(lines))
    return dict(re.split(" = |: ", line.strip(), maxsplit=1) for line in lines)


@pytest.fixture
def written(tmp_path):
    """Write YAML texts to files and return their paths."""

    def write(*texts):
        paths = [tmp_path / f"{k}.yaml" for k in range(len(texts))]
        for path, text in zip(paths, texts, strict=True):
            path.write_text(text, encoding="utf-8")
        return paths

    return write


def test_every_error_is_reported_at_once_with_place_value_limit_and_remedy():
    lines = lines_of(
        {
            "seed": "one",
            "modles": {},
            "models": {"fprc": {"n_c": 0, "epsilom": 0.1}},
            "experiments": {"sweep": {"duration_s": float("nan")}},
            "rig": {"name": "papr", "valve": {"leak": 3}, "bending": {"slip_weight": [0.5]}},
            "calibration": {"free": ["step_s", "friction_law"]},
            "fitted": {"name": "mine"},
        }
    )
    assert lines.keys() == {
        "seed", "modles", "models.fprc.n_c", "models.fprc.epsilom", "experiments.sweep.duration_s",
        "rig", "rig.valve.leak", "rig.bending", "calibration", "fitted",
    }  # fmt: skip
    assert re.findall(r"\d+", lines["models.fprc.n_c"]) == ["0", "1", "8"]
    assert "bouc_wen, dry, paper or viscous" in lines["rig"]


@pytest.mark.parametrize(
    ("config", "unknown", "nearest"),
    [({"models": {"fprc": {"epsilom": 1}}}, "models.fprc.epsilom", "models.fprc.epsilon"),
     ({"modles": {}}, "modles", "models"), ({"n_c": 1}, "n_c", "models.fprc.n_c"),
     ({"models": {"fprc": {"r": 1}}}, "models.fprc.r", "models.esn.r"),
     ({"rig": {"valve": {"leek": 1}}}, "rig.valve.leek", "rig.valve.leak"),
     ({"control": {"pd": {"kp": 1}}}, "control.pd.kp", "control.pd.kp_kpa_per_deg")],
)  # fmt: skip
def test_unknown_key_names_the_nearest(config, unknown, nearest):
    assert lines_of(config) == {unknown: f"unknown key; did you mean {nearest}?"}


def test_later_files_win_key_by_key_and_what_stands_beside_them_last(written):
    first = "seed: 1\nmodels: {n_y: 7, fprc: {n_c: 4, n_u: 2}}\n"
    paths = written(first, "seed: 2\nmodels: {fprc: {n_c: 5}}\n")
    for beside, n_y in ((None, 7), ({"models": {"n_y": "08"}}, 8)):
        settings = from_files(paths, beside)
        fprc = settings.models.fprc
        assert (settings.seed, settings.models.n_y, fprc.n_c, fprc.n_u) == (2, n_y, 5, 2)


#: Files, a mapping beside them, and the rig that they stand for: its name, and its drift.
PAPER = check({}).rig.drift
LAYERS = [
    ([], None, (RIG, PAPER.sigma_kpa, PAPER.time_s)),
    (["seed: 4\nrig: mine\n"], None, ("mine", 2.0, 3.0)),
    (["rig: dry\n"], {"rig": "mine"}, ("mine", 2.0, 3.0)),
    (["rig: {drift: {time_s: 7}}\n"], {"rig": "mine"}, ("mine", 2.0, 3.0)),
    # numbers change the rig, which is then no fitted one
    (["rig: {name: mine, drift: {time_s: 7}}\n"], None, ("changed", 2.0, 7.0)),
    (["rig: {name: mine}\n", "rig: {drift: {time_s: 7}}\n"], None, ("changed", 2.0, 7.0)),
    (["rig: {name: mine}\n"], {"rig": {"drift": {"time_s": 7}}}, ("changed", 2.0, 7.0)),
    ([], {"rig": {"drift": {"time_s": 7}}}, ("changed", PAPER.sigma_kpa, 7.0)),
]  # fmt: skip


@pytest.mark.parametrize(("texts", "beside", "expected"), LAYERS)
def test_rig_of_files_and_of_what_stands_beside_them(
    written, tmp_path, monkeypatch, texts, beside, expected
):
    (tmp_path / "config/rigs").mkdir(parents=True)
    mine = "fitted: {name: mine, to: [tables]}\nrig: {drift: {sigma_kpa: 2.0, time_s: 3.0}}\n"
    (tmp_path / "config/rigs/mine.yaml").write_text(mine, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    settings = from_files(written(*texts), beside)
    drift = settings.rig.drift
    assert (settings.fitted.name, drift.sigma_kpa, drift.time_s) == expected
    assert (settings.fitted.to == ()) == (expected[0] == "changed")


def test_configuration_of_the_paper_is_the_default_but_for_its_rig():
    settings = from_files([ROOT / "config/config.yaml"])
    assert settings == check({})
    of_the_class = {"rig": Settings().rig, "fitted": Settings().fitted}
    assert settings.model_copy(update=of_the_class) == Settings()


@pytest.mark.parametrize("name", sorted(rig_files()))
def test_every_rig_of_the_package_is_valid_and_has_the_name_of_its_file(name):
    settings = check({"rig": name})
    assert settings.fitted.name == name
    assert (name == "bouc_wen") == (not settings.fitted.to)


def test_local_configuration_that_is_a_broken_link_is_not_passed_over(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "config").mkdir()
    (tmp_path / "config/config.yaml").symlink_to("nowhere")
    with pytest.raises(ConfigError, match=r"config\.yaml: cannot be opened"):
        from_files()


@pytest.mark.parametrize(
    ("page", "file"),
    [(defaults, "config/config.yaml"), (reference, "docs/configuration.md")],
)
def test_generated_file_is_up_to_date(page, file):
    committed = (ROOT / file).read_text(encoding="utf-8")
    assert committed == page(), f"{file} is stale: run `fprc config {page.__name__} > {file}`"
