"""Describe a build as an RO-Crate: every file, and what the sidecars say of how it was made.

RO-Crate 1.1 with the profiles Workflow RO-Crate 1.0, Process Run Crate 0.5 and Workflow Run Crate
0.5 (https://w3id.org/ro/wfrun/workflow/0.5). Only figures have sidecars: for them the crate has an
action with exact inputs and outputs; for all other results, that the run of the workflow made them.
"""

import mimetypes
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any
from urllib.parse import quote

from rocrate.model import Entity
from rocrate.rocrate import ROCrate

from fprc.provenance import sha256
from tools.release.results import in_checkout

WORKFLOW = "workflow/Snakefile"
SHA256 = "https://w3id.org/ro/terms/workflow-run#sha256"
PROFILES = {
    "https://w3id.org/ro/wfrun/process/0.5": ("Process Run Crate", "0.5"),
    "https://w3id.org/ro/wfrun/workflow/0.5": ("Workflow Run Crate", "0.5"),
    "https://w3id.org/workflowhub/workflow-ro-crate/1.0": ("Workflow RO-Crate", "1.0"),
}
LICENSE = "https://spdx.org/licenses/MIT"
PAPER = "https://doi.org/10.1109/LRA.2024.3523229"
#: The types that Python has; the system's may take a Snakefile, .smk, for a video.
_TYPES = mimetypes.MimeTypes()
_TYPES.add_type("text/markdown", ".md")
_TYPES.add_type("application/yaml", ".yaml")


def describe_crate(
    root: Path,
    *,
    code: Sequence[str],
    made: Sequence[str],
    sidecars: Mapping[str, Mapping[str, Any]],
    version: str,
    published: str,
) -> ROCrate:
    """Return the crate of a release, which writes itself and its metadata.

    Parameters
    ----------
    root : Path
        The checkout.
    code, made : sequences of str
        Files of the commit; raw logs and results. Relative to the checkout.
    sidecars : Mapping
        The contents of each sidecar among ``made``. All have the same versions of libraries.
    version, published : str
        Version of the release, and its date as ISO 8601.
    """
    crate = ROCrate(version="1.1")
    crate.metadata.extra_terms["sha256"] = SHA256
    mit = _add(crate, LICENSE, "CreativeWork", "MIT License")
    developers = _add(crate, "#developers", "Organization", "The fprc developers")
    paper = _add(
        crate,
        PAPER,
        "ScholarlyArticle",
        "Control Pneumatic Soft Bending Actuator with Feedforward Hysteresis Compensation by "
        "Pneumatic Physical Reservoir Computing",
    )
    for name in sorted({*code, *made} - {WORKFLOW}):
        crate.add_file(root / name, name, properties=_described(root, name))
    workflow = crate.add_workflow(
        root / WORKFLOW,
        WORKFLOW,
        main=True,
        lang="snakemake",
        properties=_described(root, WORKFLOW)
        | {"name": "The paper, from raw logs to tables and figures"}
        | {"version": version, "license": mit},
    )
    crate.get("README.md")["about"] = crate.root_dataset
    run = crate.add_action(
        workflow,
        "#run",
        object=[_refer(name) for name in code if name.startswith("config/")],
        result=[_refer(name) for name in made],
        properties={
            "name": "make paper",
            "description": "The run of the workflow that made all raw logs and results.",
        },
    )
    fprc = _add(crate, "#fprc", "SoftwareApplication", "fprc", softwareVersion=version)
    fprc["softwareRequirements"] = [
        _add(crate, f"#{name}", "SoftwareApplication", name, softwareVersion=number)
        for name, number in next(iter(sidecars.values()))["versions"].items()
        if name != "fprc"
    ]
    drawn = [_drawing(crate, fprc, name, content) for name, content in sidecars.items()]
    profiles = [
        _add(crate, profile, "CreativeWork", name, version=number)
        for profile, (name, number) in PROFILES.items()
    ]
    about = {
        "name": f"fprc {version}: code, raw logs and results",
        "description": "A reproduction of feedforward hysteresis compensation by pneumatic "
        "physical reservoir computing. README.md says what was measured and what was "
        "simulated.",
        "version": version,
        "datePublished": published,
        "license": mit,
        "author": developers,
        "publisher": developers,
        "citation": paper,
        "conformsTo": profiles,
        "mentions": [run, *drawn],
    }
    for key, value in about.items():
        crate.root_dataset[key] = value
    return crate


def _add(crate: ROCrate, identifier: str, kind: str, name: str, **properties: Any) -> Entity:
    described = {"@id": identifier, "@type": kind, "name": name, **properties}
    return crate.add_or_update_jsonld(described)


def _refer(name: str) -> dict[str, str]:
    return {"@id": quote(name)}


def _described(root: Path, name: str) -> dict[str, str]:
    path = root / name
    return {
        "name": name,
        "contentSize": str(path.stat().st_size),
        "sha256": sha256(str(path)),
        "encodingFormat": _TYPES.guess_type(name)[0] or "text/plain",
    }


def _drawing(crate: ROCrate, fprc: Entity, name: str, sidecar: Mapping[str, Any]) -> Entity:
    """Add the action that made the files of a sidecar."""
    seeds = " ".join(map(str, sidecar["seeds"])) or "none"
    stated = {key: sidecar[key] for key in ("source", "commit", "config_sha256")} | {"seeds": seeds}
    settings = [
        _add(crate, f"#{quote(key)}={quote(value)}", "PropertyValue", key, value=value)
        for key, value in stated.items()
    ]
    action = crate.add_action(
        fprc,
        f"#made-{quote(name)}",
        properties={
            # here, because as an argument `object` is left out if it is empty
            "object": [_refer(in_checkout(file)) for file in sidecar["inputs"]],
            "result": [_refer(file) for file in (*sidecar["outputs"], name)],
            "name": f"Drawing of {Path(name).stem}",
            "description": f"What {name} says: inputs, outputs, settings.",
            "additionalProperty": settings,
        },
    )
    crate.get(quote(name))["about"] = action
    return action
