"""`tools/container.sh`, with stand-ins for the engines."""

import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
ENGINES = ("podman", "docker", "buildah")


def container(**environment):
    return subprocess.run(
        [ROOT / "tools/container.sh"],
        env=os.environ | environment,
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
def test_container_takes_the_first_engine_that_answers(tmp_path, present, chosen):
    for name in present:
        engine = tmp_path / name.split()[-1]
        refuse = '[ "$1" != info ] || exit 1\n' if name.startswith("silent") else ""
        engine.write_text(f'#!/bin/sh\n{refuse}echo "{engine.name} $*"\n')
        engine.chmod(0o755)
    done = container(BASE="debian", PATH=str(tmp_path))
    assert done.returncode == 0, done.stderr
    last = done.stdout.splitlines()[-1]
    assert last == f"{chosen} build --file Containerfile --tag fprc --build-arg BASE=debian ."
