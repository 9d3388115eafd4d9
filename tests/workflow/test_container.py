"""`make container`, with stand-ins for the engines and, on demand, with a real one."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
ENGINES = ("podman", "docker", "buildah")
MAKE = shutil.which("make") or "make"


def container(*arguments, **environment):
    return subprocess.run(
        [MAKE, "--no-print-directory", "container", *arguments],
        cwd=ROOT,
        env={k: v for k, v in os.environ.items() if k != "MAKEFLAGS"} | environment,
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.parametrize(
    ("present", "chosen"),
    [
        (ENGINES, "podman"),
        (("docker", "buildah"), "docker"),
        (("silent docker", "buildah"), "buildah"),
    ],
)
def test_make_container_takes_the_first_engine_that_answers(tmp_path, present, chosen):
    for name in present:
        engine = tmp_path / name.split()[-1]
        refuse = '[ "$1" != info ] || exit 1\n' if name.startswith("silent") else ""
        engine.write_text(f'#!/bin/sh\n{refuse}echo "{engine.name} $*"\n')
        engine.chmod(0o755)
    done = container("BASE=debian", PATH=str(tmp_path))
    assert done.returncode == 0, done.stderr
    last = done.stdout.splitlines()[-1]
    assert last == f"{chosen} build --file Containerfile --tag fprc --build-arg BASE=debian ."


def engine():
    """Return the engine that `make container` takes; None if none answers."""
    for name in filter(shutil.which, ENGINES):
        if subprocess.run([name, "info"], capture_output=True, check=False).returncode == 0:
            return name
    return None


@pytest.mark.slow
@pytest.mark.skipif(
    "FPRC_CONTAINER" not in os.environ, reason="`FPRC_CONTAINER=1` builds the image"
)
def test_image_works_for_a_user_without_a_home():
    name = engine()
    if name is None:
        pytest.skip("no podman, docker or buildah that answers")
    base = os.environ.get("BASE")
    done = container(*([f"BASE={base}"] if base else []))
    assert done.returncode == 0, done.stderr
    line = "unset HOME; git -C /fprc rev-parse HEAD && snakemake --cores 1 --dry-run all"
    if name == "buildah":
        made = subprocess.run([name, "from", "fprc"], capture_output=True, text=True, check=True)
        command = [name, "run", "--user", "1000", made.stdout.strip(), "--"]
    else:
        command = [name, "run", "--rm", "--user", "1000", "fprc"]
    done = subprocess.run([*command, "sh", "-c", line], capture_output=True, text=True, check=False)
    if name == "buildah":
        subprocess.run([name, "rm", made.stdout.strip()], capture_output=True, check=True)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "job stats" in (done.stdout + done.stderr).lower()
