"""Write the report: one page with claims, tables, figures and settings."""

import base64
import logging
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import jinja2
import pandas as pd
import yaml
from markupsafe import Markup, escape
from PIL import Image

from fprc.artifacts import read_json, write_text
from fprc.config import Settings
from fprc.paper import SOURCES
from fprc.provenance import checkout, hash_of, versions
from fprc.tables import read_markdown

log = logging.getLogger(__name__)


def write_report(
    template: str,
    ledger: Sequence[str],
    missing: str,
    tables: Sequence[str],
    pictures: Sequence[str],
    sidecars: Sequence[str],
    captions: Sequence[str],
    html: str,
    *,
    settings: Mapping[str, Any],
) -> None:
    """Write claims, tables, figures and settings to one self-contained page.

    Parameters
    ----------
    ledger : sequence of str
        The claims ledger, JSON; empty if there is none.
    missing : str
        Results that the data do not allow, with reasons, CSV.
    tables : sequence of str
        Tables as Markdown pages.
    pictures, sidecars, captions : sequences of str
        PNG, sidecar and caption of each figure, in the same order.
    """
    figures = [_figure(*files) for files in zip(pictures, sidecars, captions, strict=True)]
    drawn_from = {figure["source"] for figure in figures} - {"none"}
    kinds = " and ".join(SOURCES[source] for source in sorted(drawn_from))
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(Path(template).parent),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
    )
    environment.filters["symbols"] = symbols
    environment.globals["zip"] = zip
    page = environment.get_template(Path(template).name).render(
        banner=banner(drawn_from),
        explanation=f"All our results on this page except the execution times come from: {kinds}.",
        simulated="sim" in drawn_from,
        missing=pd.read_csv(missing).drop(columns="name"),
        pages=[_page(path, settings["fitted"]["to"]) for path in tables],
        figures=figures,
        settings=settings,
        changed=_changed(settings),
        yaml=yaml.safe_dump(dict(settings), sort_keys=False),
        config=hash_of(settings),
        commit=_commit(*checkout()),
        versions=pd.DataFrame(versions().items(), columns=["Software", "Version"]),
        **_claims(ledger),
    )
    write_text(html, page)
    log.info("wrote %s, %d tables and %d figures", html, len(tables), len(figures))


def banner(sources: set[str]) -> str:
    """Return the kind of the page's data, in capitals."""
    if sources == {"sim"}:
        return "SIMULATED DATA"
    if any(source.endswith("sim") for source in sources):
        return "PARTLY SIMULATED DATA"
    return "MEASURED DATA"


_NOT_COMPARED = ("source", "seed", "folders", "rig", "calibration", "ensemble")


def _changed(settings: Mapping[str, Any]) -> dict[str, tuple[Any, Any]]:
    """Return the settings of models, experiments and evaluation that differ from the defaults."""
    default, ours = (
        pd.json_normalize(section).to_dict("records")[0]
        for section in (Settings().model_dump(mode="json"), dict(settings))
    )
    return {
        key: (value, default.get(key, "none"))
        for key, value in ours.items()
        if value != default.get(key) and key.split(".")[0] not in _NOT_COMPARED
    }


def _claims(ledger: Sequence[str]) -> dict[str, Any]:
    if not ledger:
        return {"claims": None}
    report = read_json(ledger[0])
    claims = pd.DataFrame(report["claims"]).drop(columns="statements")
    counts = claims["verdict"].value_counts().to_dict()
    claims.columns = claims.columns.str.capitalize()
    return {"claims": claims, "counts": counts, "note": report["note"]}


def _kind(table: str, terms: Sequence[str]) -> str:
    """Return whether the rig was fitted to a table's numbers, by the terms of its objective."""
    if table in ("table2", "table3"):
        return "fitted" if "tables" in terms else "predicted"
    if table == "table4":
        return "half fitted" if "open_loop" in terms else "predicted"
    return ""


def _page(path: str, terms: Sequence[str]) -> dict[str, Any]:
    note, table = read_markdown(Path(path).read_text(encoding="utf-8"))
    title, _, rest = note.partition(": ")
    kind = _kind(Path(path).stem.removesuffix("_seeds"), terms)
    return {"kind": kind, "title": title, "note": rest[:1].upper() + rest[1:], "table": table}


def _figure(picture: str, sidecar: str, caption: str) -> dict[str, Any]:
    origin = read_json(sidecar)
    with Image.open(picture) as image:
        width, height = image.size
    return {
        "number": int(re.findall(r"^fig(\d+)", Path(picture).name)[0]),
        "png": base64.b64encode(Path(picture).read_bytes()).decode(),
        "width": width,
        "height": height,
        "caption": " ".join(Path(caption).read_text(encoding="utf-8").split()),
        "source": origin["source"],
        "mark": SOURCES.get(origin["source"], "drawing, no data"),
        "commit": _commit(origin["commit"], origin["dirty"]),
        "inputs": origin["inputs"],
        "config": origin["config_sha256"],
    }


def _commit(commit: str | None, dirty: bool | None) -> str:
    if commit is None:
        return "unknown (not a git checkout)"
    return f"{commit[:12]}{' with uncommitted changes' if dirty else ''}"


_GREEK = {"theta": "θ", "epsilon": "ε", "gamma": "γ", "rho": "ρ", "sigma": "σ", "alpha": "α"}
_SYMBOL = re.compile(
    r"\b(P|K|n|f|theta)_(exp|ff|fb|input|in|i|o|d|c|u|y)\b|\b(" + "|".join(_GREEK) + r")\b"
)


def symbols(text: object) -> Markup:
    """Return text as HTML with the paper's symbols typeset: P_o with a subscript, theta as θ."""

    def shown(match: re.Match[str]) -> str:
        letter, index, greek = match.groups()
        if greek:
            return f"<i>{_GREEK[greek]}</i>"
        return f"<i>{_GREEK.get(letter, letter)}</i><sub>{index}</sub>"

    return Markup(_SYMBOL.sub(shown, str(escape(text))))
