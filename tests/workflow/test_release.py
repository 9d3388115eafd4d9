"""A release of a smoke run: the archive and its RO-Crate, refusals."""

import hashlib
import io
import json
import os
import shutil
import socket
import subprocess
import zipfile
from contextlib import redirect_stdout
from pathlib import Path
from urllib.parse import unquote

import pytest

from tools.release import __main__ as release

ROOT = Path(__file__).parents[2]
TOOLS = ROOT / ".venv/release/bin/python"
SMOKE = ["--configfile", "config/smoke.yaml"]
VERSION = "99.0"

pytestmark = pytest.mark.slow


def git(folder, *arguments):
    who = ["-c", "user.name=test", "-c", "user.email=test@localhost", "-c", "commit.gpgsign=false"]
    done = subprocess.run(
        ["git", *who, *arguments], cwd=folder, check=True, capture_output=True, text=True
    )
    return done.stdout


def rewrite(path, **changes):
    """Change a sidecar, but not its time, by which Snakemake judges."""
    before = path.stat()
    path.write_text(json.dumps(json.loads(path.read_text()) | changes))
    os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))


@pytest.fixture(scope="module")
def released(smoked, tmp_path_factory):
    """A checkout of a version, a smoke run of its commit, and its release; what it printed.

    The tools are left out; the last two tests have them.
    """
    folder = tmp_path_factory.mktemp("released") / "clone"
    for name in filter(None, git(ROOT, "ls-files", "-z").split("\0")):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(ROOT / name, folder / name)  # with its time, by which Snakemake judges
    for name in ("results/smoke", ".snakemake/metadata"):
        shutil.copytree(smoked[0].folder / name, folder / name)
    for name, old, new in (
        (release.CHANGELOG, "## Unreleased", f"## Unreleased\n\n## {VERSION} (2030-01-02)"),
        (release.VERSION, release.version_of(folder), VERSION),
    ):
        text = (folder / name).read_text(encoding="utf-8")
        (folder / name).write_text(text.replace(old, new, 1), encoding="utf-8")
    git(folder, "init", "--quiet")
    git(folder, "add", "--all")
    git(folder, "commit", "--quiet", "--message", "Release")
    commit = git(folder, "rev-parse", "HEAD").strip()
    results = folder / "results/smoke"
    for path in [*results.glob("figures/*.json"), results / "readout/readout.json"]:
        rewrite(path, commit=commit, dirty=False)
    with pytest.MonkeyPatch.context() as patch, redirect_stdout(io.StringIO()) as printed:
        patch.setattr(release, "validate", lambda *_: None)
        patch.setattr(release, "build_packages", lambda *_: None)
        release.build(folder, "tools", SMOKE[1:])
    return folder, printed.getvalue()


@pytest.fixture(scope="module")
def crate(released):
    """The files of the archive, and the entities of its metadata by identifier."""
    with zipfile.ZipFile(released[0] / f"dist/{VERSION}/fprc-{VERSION}.crate.zip") as archive:
        held = {name: archive.read(name) for name in archive.namelist()}
    graph = json.loads(held.pop("ro-crate-metadata.json"))["@graph"]
    entities = {entity["@id"]: entity for entity in graph}
    assert len(entities) == len(graph)
    return held, entities


@pytest.fixture
def clone(released, tmp_path, monkeypatch):
    """The checkout before the release; a test may break it."""
    folder = tmp_path / "clone"
    shutil.copytree(released[0], folder, ignore=shutil.ignore_patterns("dist"), symlinks=True)
    monkeypatch.chdir(folder)
    return folder


def test_archive_and_crate_describe_the_same_files(released, crate):
    clone, printed = released
    held, entities = crate
    files = {
        unquote(name): entity for name, entity in entities.items() if "File" in entity["@type"]
    }
    assert {
        name: (int(entity["contentSize"]), entity["sha256"]) for name, entity in files.items()
    } == {
        name: (len(content), hashlib.sha256(content).hexdigest()) for name, content in held.items()
    }
    results = {
        str(path.relative_to(clone))
        for path in (clone / "results/smoke").rglob("*")
        if path.is_file() and not {"logs", "digests"} & set(path.parts)
    }
    tracked = {name for name in git(clone, "ls-files").splitlines() if (clone / name).is_file()}
    assert held.keys() == results | tracked
    assert {"results/smoke/raw/sweep.h5", "results/smoke/figures/fig08_training.json"} <= results

    root = entities["./"]
    assert {part["@id"] for part in root["hasPart"]} == {
        identifier for identifier, entity in entities.items() if "File" in entity["@type"]
    }
    assert (root["version"], root["datePublished"]) == (VERSION, "2030-01-02")
    assert {reference for entity in entities.values() for reference in referred(entity)} <= {
        *entities,
        "https://w3id.org/ro/crate/1.1",
        "https://doi.org/10.1093/bioinformatics/bts480",
        "https://snakemake.readthedocs.io",
    }
    assert entities["workflow/rules/logs.smk"]["encodingFormat"] == "text/plain"
    assert "git tag -a v99.0" in printed


def referred(value):
    """Yield every identifier that an entity points to."""
    if isinstance(value, list):
        for item in value:
            yield from referred(item)
    elif isinstance(value, dict):
        if value.keys() == {"@id"}:
            yield value["@id"]
        else:
            yield from referred(list(value.values()))


def test_action_of_a_figure_says_what_its_sidecar_says(released, crate):
    held, entities = crate
    name = "results/smoke/figures/fig03_apparatus.json"
    sidecar = json.loads(held[name])
    action = entities[entities[name]["about"]["@id"]]
    assert action["@type"] == "CreateAction"
    assert set(referred(action["result"])) == {*sidecar["outputs"], name}
    made_of = {reference: entities[reference]["sha256"] for reference in referred(action["object"])}
    assert made_of == {
        file.replace("fprc/config", "src/fprc/config"): value
        for file, value in sidecar["inputs"].items()
    }
    properties = {entities[reference]["name"]: entities[reference]["value"]
                  for reference in referred(action["additionalProperty"])}  # fmt: skip
    assert properties["commit"] == git(released[0], "rev-parse", "HEAD").strip()
    assert properties["config_sha256"] == sidecar["config_sha256"]
    libraries = {entity["name"]: entity["softwareVersion"] for entity in entities.values()
                 if entity["@type"] == "SoftwareApplication"}  # fmt: skip
    assert libraries == sidecar["versions"] | {"fprc": VERSION}


def test_everything_that_forbids_a_release_is_said_at_once(clone, capsys):
    figures = clone / "results/smoke/figures"
    rewrite(figures / "fig01_actuator.json", commit="0" * 40)
    rewrite(figures / "fig02_reservoir.json", dirty=True)
    rewrite(figures / "fig04_hysteresis_actuator.json", versions={"numpy": "1.0"})
    (figures / "fig05_hysteresis_reservoir.pdf").write_bytes(b"edited")
    (clone / "results/smoke/tables/table2.csv").unlink()
    (clone / "README.md").write_text("edited")
    git(clone, "tag", f"v{VERSION}")
    (clone / f"dist/{VERSION}").mkdir(parents=True)
    assert release.main(SMOKE) == 1
    printed = capsys.readouterr().err
    for message in (
        "uncommitted changes; commit them",
        "fig01_actuator.json: not made by this commit",
        "fig02_reservoir.json: made with uncommitted changes",
        "different versions of libraries",
        "fig05_hysteresis_reservoir.pdf is missing or was changed",
        "tables/table2.csv: missing or outdated",
        f"the tag v{VERSION} exists",
        f"dist/{VERSION}: exists",
    ):
        assert message in printed
    assert list((clone / "dist").rglob("*")) == [clone / f"dist/{VERSION}"]


def test_nothing_is_left_when_a_tool_refuses(clone, monkeypatch, capsys):
    def refuse(*_):
        raise release.FprcError("refused by the validator")

    made = sorted(str(path.relative_to(clone)) for path in clone.glob("results/smoke/figures/*"))
    monkeypatch.setattr(release, "built", lambda *_: (made, []))
    monkeypatch.setattr(release, "validate", refuse)
    assert release.main(SMOKE) == 1
    assert capsys.readouterr().err == "error: refused by the validator\n"
    assert list((clone / "dist").iterdir()) == []


def test_a_release_needs_results_and_a_changelog_with_its_version(clone, monkeypatch, capsys):
    monkeypatch.setattr(release, "built", lambda *_: (["results/report.html"], []))
    path = clone / "src/fprc/__init__.py"
    path.write_text(path.read_text().replace(VERSION, "99.1"))
    git(clone, "commit", "--quiet", "--all", "--message", "Next")
    assert release.main(SMOKE) == 1
    printed = capsys.readouterr().err
    assert "no results; build them with `make paper`" in printed
    assert "its newest release is 99.0, the package is 99.1" in printed


with_tools = pytest.mark.skipif(
    not TOOLS.exists(), reason="the tools that `make release-tools` installs"
)


@with_tools
def test_validator_accepts_the_archive(released):
    try:
        socket.getaddrinfo("w3id.org", 443)
    except OSError:
        pytest.skip("the validator reads w3id.org, which cannot be reached")
    release.validate(released[0] / f"dist/{VERSION}/fprc-{VERSION}.crate.zip", str(TOOLS))


@with_tools
def test_tools_accept_the_packages(clone, monkeypatch, capsys):
    monkeypatch.setattr(release, "validate", lambda *_: None)
    code = release.main(["--tools", str(TOOLS), *SMOKE])
    assert code == 0, capsys.readouterr().err
    assert sorted(path.name for path in (clone / f"dist/{VERSION}").iterdir()) == [
        f"fprc-{VERSION}-py3-none-any.whl",
        f"fprc-{VERSION}.crate.zip",
        f"fprc-{VERSION}.tar.gz",
    ]
