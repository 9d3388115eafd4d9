import json

import yaml

from fprc.studies.stages.beyond import join_tuned


def test_chosen_settings_are_joined_by_family(tmp_path):
    names = ("dry", "viscous")
    for name in names:
        chosen = {"bank_tuned": {"epsilons": [0.1, 0.01], "alpha": 1e-06}}
        text = json.dumps({"world": name, "chosen": chosen})
        (tmp_path / f"{name}.json").write_text(text)
    joined = tmp_path / "tuned.yaml"
    join_tuned([str(tmp_path / f"{name}.json") for name in names], str(joined))
    assert yaml.safe_load(joined.read_text()) == dict.fromkeys(names, chosen)
