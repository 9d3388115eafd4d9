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

from fprc.provenance import sha256
from workflow.release.results import in_checkout

METADATA = "ro-crate-metadata.json"
CONTEXT = [
    "https://w3id.org/ro/crate/1.1/context",
    {"sha256": "https://w3id.org/ro/terms/workflow-run#sha256"},
]
WORKFLOW = "workflow/Snakefile"
PROFILES = {
    "https://w3id.org/ro/wfrun/process/0.5": ("Process Run Crate", "0.5"),
    "https://w3id.org/ro/wfrun/workflow/0.5": ("Workflow Run Crate", "0.5"),
    "https://w3id.org/workflowhub/workflow-ro-crate/1.0": ("Workflow RO-Crate", "1.0"),
}
LICENSE = "https://spdx.org/licenses/MIT"
PAPER = "https://doi.org/10.1109/LRA.2024.3523229"
SNAKEMAKE = "https://w3id.org/workflowhub/workflow-ro-crate#snakemake"
_TYPES = {".h5": "application/x-hdf5", ".md": "text/markdown", ".yaml": "application/yaml"}

Entity = dict[str, Any]


def describe_crate(
    root: Path,
    *,
    code: Sequence[str],
    made: Sequence[str],
    sidecars: Mapping[str, Mapping[str, Any]],
    version: str,
    published: str,
) -> Entity:
    """Return the metadata of a crate, JSON-LD.

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
    versions = next(iter(sidecars.values()))["versions"]
    actions = [_drawing(name, content) for name, content in sidecars.items()]
    files = {name: _file(root, name) for name in sorted({*code, *made})}
    for action, name in zip(actions, sidecars, strict=True):
        files[name]["about"] = _refer(action["@id"])
    files[WORKFLOW] |= {
        "@type": ["File", "SoftwareSourceCode", "ComputationalWorkflow"],
        "name": "The paper, from raw logs to tables and figures",
        "programmingLanguage": _refer(SNAKEMAKE),
        "version": version,
        "license": _refer(LICENSE),
    }
    files["README.md"]["about"] = _refer("./")
    run = {
        "@id": "#run",
        "@type": "CreateAction",
        "name": "make paper",
        "description": "The run of the workflow that made all raw logs and results.",
        "instrument": _refer(quote(WORKFLOW)),
        "object": [_refer(quote(name)) for name in code if name.startswith("config/")],
        "result": [_refer(quote(name)) for name in made],
    }
    values = {
        entity["@id"]: entity for content in sidecars.values() for entity in _settings_of(content)
    }
    root_entity = {
        "@id": "./",
        "@type": "Dataset",
        "name": f"fprc {version}: code, raw logs and results",
        "description": "A reproduction of feedforward hysteresis compensation by pneumatic "
        "physical reservoir computing. README.md says what was measured and what was simulated.",
        "version": version,
        "datePublished": published,
        "license": _refer(LICENSE),
        "author": _refer("#developers"),
        "publisher": _refer("#developers"),
        "citation": _refer(PAPER),
        "conformsTo": [_refer(profile) for profile in PROFILES],
        "mainEntity": _refer(quote(WORKFLOW)),
        "mentions": [_refer(action["@id"]) for action in (run, *actions)],
        "hasPart": [_refer(quote(name)) for name in files],
    }
    graph = [
        _descriptor(),
        root_entity,
        *files.values(),
        run,
        *actions,
        *values.values(),
        *_software(versions, version),
        *_context(),
    ]
    return {"@context": CONTEXT, "@graph": graph}


def _refer(identifier: str) -> Entity:
    return {"@id": identifier}


def _descriptor() -> Entity:
    conforms = [
        "https://w3id.org/ro/crate/1.1",
        "https://w3id.org/workflowhub/workflow-ro-crate/1.0",
    ]
    return {
        "@id": METADATA,
        "@type": "CreativeWork",
        "about": _refer("./"),
        "conformsTo": [_refer(profile) for profile in conforms],
    }


def _file(root: Path, name: str) -> Entity:
    path = root / name
    kind = _TYPES.get(path.suffix) or mimetypes.guess_type(name)[0] or "text/plain"
    return {
        "@id": quote(name),
        "@type": "File",
        "name": name,
        "contentSize": str(path.stat().st_size),
        "sha256": sha256(str(path)),
        "encodingFormat": kind,
    }


def _drawing(name: str, sidecar: Mapping[str, Any]) -> Entity:
    """Return the action that made the files of a sidecar."""
    return {
        "@id": f"#made-{quote(name)}",
        "@type": "CreateAction",
        "name": f"Drawing of {Path(name).stem}",
        "description": f"What {name} says: inputs, outputs, settings.",
        "instrument": _refer("#fprc"),
        "object": [_refer(quote(in_checkout(file))) for file in sidecar["inputs"]],
        "result": [_refer(quote(file)) for file in (*sidecar["outputs"], name)],
        "additionalProperty": [_refer(entity["@id"]) for entity in _settings_of(sidecar)],
    }


def _settings_of(sidecar: Mapping[str, Any]) -> list[Entity]:
    """Return what a sidecar says besides files and versions."""
    seeds = " ".join(map(str, sidecar["seeds"])) or "none"
    said = {key: sidecar[key] for key in ("source", "commit", "config_sha256")} | {"seeds": seeds}
    return [
        {
            "@id": f"#{quote(key)}={quote(value)}",
            "@type": "PropertyValue",
            "name": key,
            "value": value,
        }
        for key, value in said.items()
    ]


def _software(versions: Mapping[str, str], version: str) -> list[Entity]:
    libraries = [
        {"@id": f"#{name}", "@type": "SoftwareApplication", "name": name, "softwareVersion": number}
        for name, number in versions.items()
        if name != "fprc"
    ]
    fprc = {
        "@id": "#fprc",
        "@type": "SoftwareApplication",
        "name": "fprc",
        "softwareVersion": version,
        "softwareRequirements": [_refer(library["@id"]) for library in libraries],
    }
    return [fprc, *libraries]


def _context() -> list[Entity]:
    profiles = [
        {"@id": profile, "@type": "CreativeWork", "name": name, "version": version}
        for profile, (name, version) in PROFILES.items()
    ]
    return [
        *profiles,
        {
            "@id": SNAKEMAKE,
            "@type": "ComputerLanguage",
            "name": "Snakemake",
            "identifier": _refer("https://doi.org/10.1093/bioinformatics/bts480"),
            "url": _refer("https://snakemake.readthedocs.io"),
        },
        {"@id": LICENSE, "@type": "CreativeWork", "name": "MIT License"},
        {"@id": "#developers", "@type": "Organization", "name": "The fprc developers"},
        {
            "@id": PAPER,
            "@type": "ScholarlyArticle",
            "name": "Control Pneumatic Soft Bending Actuator with Feedforward Hysteresis "
            "Compensation by Pneumatic Physical Reservoir Computing",
        },
    ]
