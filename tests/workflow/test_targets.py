import re

import pytest

from fprc.yaml_file import read_yaml


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
    assert jobs["track"] == 5
    assert jobs["grid"] == 3


def test_profile_of_slurm_names_rules_that_there_are_and_groups_every_drawing(project):
    rules = set()
    for chunks in (1, 2):
        asked = project.snakemake("--list-rules", "--config", f"grids={{chunks: {chunks}}}")
        rules |= set(asked.stdout.split())
    profile = read_yaml(project.folder / "profiles/slurm/config.yaml")
    threads, groups = (
        dict(each.split("=") for each in profile[key]) for key in ("set-threads", "groups")
    )
    assert threads.keys() | profile["set-resources"].keys() | groups.keys() <= rules
    assert {rule for rule in rules if rule.startswith("draw_")} <= groups.keys()


def test_default_profile_is_read(project):
    assert "profiles/default" in project.snakemake("--dry-run", "table1").stdout


@pytest.mark.parametrize(
    ("target", "needs", "spares"),
    [
        ("logs", {"record"}, {"preprocess"}),
        ("table1", {"configuration_table"}, {"record"}),
        ("table2", {"comparison_table", "judge"}, {"measure_times", "replicate"}),
        ("table3", {"comparison_table", "judge"}, {"measure_times", "replicate"}),
        ("table4", {"tracking_table", "track", "identify_gain"}, {"grid", "replicate"}),
        ("seeds", {"seeds_table", "orders_table", "replicate"}, {"judge", "record"}),
        ("timing", {"timing_table", "measure_times"}, {"judge"}),
        ("fig1", {"draw_fig1", "record"}, {"judge"}),
        ("fig3", {"draw_fig3"}, {"record"}),
        ("fig6", {"draw_fig6"}, {"record"}),
        ("fig7", {"draw_fig7"}, {"record"}),
        ("readout", {"readout_table", "draw_readout", "measure_readout"}, {"judge"}),
        ("report", {"report_page", "ledger", "draw_fig11"}, {"ensemble_chunk", "fit_rig"}),
        ("ensemble", {"ensemble_chunk", "ensemble_figure"}, {"judge", "replicate"}),
        ("sensitivity", {"measure_sensitivity", "sensitivity_table"}, {"replicate"}),
        ("targets", {"targets_table", "replicate"}, {"judge"}),
        ("calibrate", {"fit_rig"}, {"replicate"}),
        ("fig4", {"draw_fig4"}, {"judge", "measure_times"}),
        ("fig5", {"draw_fig5"}, {"judge", "measure_times"}),
        ("fig8", {"draw_fig8", "judge"}, {"replicate", "measure_times"}),
        ("fig9", {"draw_fig9", "weigh"}, {"judge", "grid"}),
        ("fig10", {"draw_fig10", "grid", "measure_times_over_n_c"}, {"judge", "track"}),
        ("fig11", {"draw_fig11", "grid"}, {"judge", "measure_times_over_n_c"}),
        ("fig12", {"draw_fig12", "track"}, {"grid", "tracking_table"}),
        ("fig13", {"draw_fig13", "track"}, {"grid", "tracking_table"}),
        ("fig14", {"draw_fig14", "track"}, {"grid", "tracking_table"}),
        ("fig15", {"draw_fig15", "track"}, {"grid", "tracking_table"}),
        ("fig16", {"draw_fig16", "track"}, {"grid", "tracking_table"}),
        ("fig17", {"draw_fig17", "track"}, {"grid", "tracking_table"}),
        (
            "benchmark",
            {"measure_benchmark", "benchmark_table", "benchmark_figure", "rule_times"},
            {"judge", "replicate", "performance_page"},
        ),
        ("smoke", {"smoke"}, {"judge"}),
        (
            "readme",
            {"readme", "timing_table", "ledger", "readout_table"},
            {"fit_rig", "ensemble_chunk"},
        ),
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
