import re

import pytest


def planned(output: str) -> dict[str, int]:
    """Jobs of a dry run by rule."""
    counts = re.findall(r"^(\w+) +(\d+)$", output, flags=re.MULTILINE)
    return {rule: int(count) for rule, count in counts if rule != "total"}


def test_dry_run_of_the_paper_plans_every_stage(project):
    jobs = planned(project.snakemake("--dry-run", "all").stdout)
    assert jobs["record"] == 2
    assert jobs["judge"] == 3
    assert jobs["replicate"] == 5
    assert jobs["measure_times"] == 1


@pytest.mark.parametrize(
    ("target", "needs", "spares"),
    [
        ("logs", {"record"}, {"preprocess"}),
        ("table1", {"configuration_table"}, {"record"}),
        ("table2", {"comparison_table", "judge"}, {"measure_times", "replicate"}),
        ("seeds", {"seeds_table", "replicate"}, {"judge", "record"}),
        ("timing", {"timing_table", "measure_times"}, {"judge"}),
        ("fig4", {"actuator_hysteresis"}, {"judge", "measure_times"}),
        ("fig5", {"reservoir_hysteresis"}, {"judge", "measure_times"}),
        ("fig8", {"training", "judge"}, {"replicate", "measure_times"}),
        ("smoke", {"smoke"}, {"judge"}),
        ("readme", {"readme", "timing_table", "seeds_table"}, {"actuator_hysteresis"}),
    ],
)
def test_named_target_plans_what_it_needs_and_no_more(project, target, needs, spares):
    done = project.snakemake("--dry-run", target)
    assert done.returncode == 0, done.stdout
    jobs = planned(done.stdout)
    assert needs <= jobs.keys()
    assert not spares & jobs.keys()


def test_word_all_after_configfile_means_the_target(project):
    swallowed = project.snakemake("--dry-run", "--configfile", "config/smoke.yaml", "all")
    assert planned(swallowed.stdout)["record"] == 2
    assert "results/smoke" in swallowed.stdout


@pytest.mark.slow
def test_changed_setting_reruns_what_reads_it(smoked):
    done = smoked[0].smoke("--dry-run", "all", "--config", "models={fprc: {n_c: 4}}")
    jobs = planned(done.stdout)
    assert {"judge", "comparison_table", "configuration_table", "training"} <= jobs.keys()
    assert not {"record", "preprocess", "actuator_hysteresis"} & jobs.keys()
