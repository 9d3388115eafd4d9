import yaml

from fprc.config import Settings, check
from fprc.config.rig import Rig
from fprc.studies.calibration.rig_file import parameter_file

PATHS = Settings().calibration.free
SHARES = dict.fromkeys(PATHS, 0.5) | dict(
    zip(PATHS, (0.0, 0.0199, 0.0201, 0.9799, 0.9801, 1.0), strict=False)
)
SUMMARY = {
    "date": "2030-01-02", "software": "fprc 9.8.7", "fit": ["tables", "C8"], "seed": 3,
    "full_count": 8, "brief": {"median": 0.0456, "largest": 0.21},
    "shares": SHARES,
}  # fmt: skip


def test_file_holds_what_differs_from_the_defaults_and_what_was_fitted(tmp_path, monkeypatch):
    rig = Rig().model_dump(mode="json")
    rig["bending"]["relaxation_time_s"][1] = 5.5
    rig["drift"]["sigma_kpa"] = 1e-5
    text = parameter_file(rig, SUMMARY, "mine")
    assert yaml.safe_load(text) == {
        "fitted": {"name": "mine", "to": ["tables", "C8"]},
        "rig": {"bending": {"relaxation_time_s": [0.25, 5.5]}, "drift": {"sigma_kpa": 1e-5}},
    }
    (tmp_path / "config/rigs").mkdir(parents=True)
    (tmp_path / "config/rigs/mine.yaml").write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    assert check({"rig": "mine"}).rig == Rig.model_validate(rig)
    head = " ".join(line.removeprefix("# ") for line in text.splitlines() if line[0] == "#")
    assert all(number in head for number in ("4.6 %", "21.0 %"))
    edges = head.partition("an end of their range: ")[2].rstrip(". ")
    assert edges.split(", ") == [PATHS[k] for k in (0, 1, 4, 5)]
