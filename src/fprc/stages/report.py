"""Write the report: one page with claims, tables, figures and settings."""

import base64
import logging
import os
import re
from collections.abc import Container, Mapping, Sequence
from pathlib import Path
from typing import Any
from urllib.parse import quote

import jinja2
import pandas as pd
import yaml
from markupsafe import Markup, escape
from PIL import Image

import fprc
from fprc.artifacts import read_json, write_text
from fprc.claims.ledger import holding
from fprc.config import Settings
from fprc.escape import in_words, typeset
from fprc.paper import SOURCES
from fprc.plan.results import title_of_result
from fprc.provenance import commit_of, hash_of, versions
from fprc.yaml_file import read_yaml

log = logging.getLogger(__name__)

#: Settings whose differences from the defaults are not announced.
_NOT_COMPARED = ("source", "seed", "folders", "rig", "fitted", "calibration")


def write_report(
    template: Sequence[str],
    ledger: Sequence[str],
    tables: Sequence[str],
    figures: Sequence[str],
    captions: str,
    html: str,
    *,
    sources: Sequence[str],
    missing: Mapping[str, str],
    settings: Mapping[str, Any],
) -> None:
    """Write claims, tables, figures and settings to one self-contained page.

    Parameters
    ----------
    template : sequence of str
        The page's template, then those that it includes.
    ledger : sequence of str
        The claims ledger, JSON; empty if there is none.
    tables, figures : sequence of str
        The tables, JSON, and the figures, PNG.
    captions : str
        The figures' captions by their targets, YAML.
    sources : sequence of str
        Source of the data of each figure; ``none`` if it shows none.
    missing : Mapping
        Results that the data do not allow, with reasons.
    """
    folder, texts = Path(html).parent, read_yaml(captions)
    shown = [_figure(*drawn, texts, folder) for drawn in zip(figures, sources, strict=True)]
    pages = {Path(page).stem: _page(page, settings["fitted"], folder) for page in tables}
    # a table of one seed is folded up below the same one over seeds
    for name in [name for name in pages if f"{name}_seeds" in pages]:
        one = pages[name]
        over = {"title": f"{one['title']}, over seeds", "short": one["short"]}
        one["short"] += " with one seed"
        pages[name] = pages.pop(f"{name}_seeds") | over | {"one_seed": one}
    parts = {part["anchor"]: part for part in (*pages.values(), *shown)}
    configuration = pages.pop("table1", None)
    drawn_from = set(sources) - {"none"}
    page = (
        _environment(Path(template[0]).parent)
        .get_template(Path(template[0]).name)
        .render(
            kinds=in_words(SOURCES[source] for source in sorted(drawn_from)),
            # the workflow refuses logs of which some are simulated and others are not
            simulated="sim" in drawn_from,
            missing=missing,
            pages=pages.values(),
            configuration=configuration,
            lines=_lines(pages),
            figures=shown,
            settings=settings,
            changed=_changed(settings),
            yaml=yaml.safe_dump(dict(settings), sort_keys=False),
            config=hash_of(settings),
            commit=commit_of(Path(fprc.__path__[0])),
            versions=versions(),
            parts=parts,
            **_claims(ledger, folder, parts),
        )
    )
    write_text(html, page)
    log.info("wrote %s, %d tables and %d figures", html, len(pages), len(shown))


def _environment(templates: Path) -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(templates),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
    )
    environment.filters["symbols"] = symbols
    environment.globals["zip"] = zip
    return environment


def symbols(text: object) -> Markup:
    """Return text as HTML with the paper's symbols typeset: theta_d as θ with a low d."""
    return Markup(typeset(str(escape(text))))


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


def _claims(ledger: Sequence[str], folder: Path, shown: Container[str]) -> dict[str, Any]:
    """Return the claims, with their evidence on the page, their code, and how many hold."""
    if not ledger:
        return {"claims": None}
    report = read_json(ledger[0])
    for claim in report["claims"]:
        claim["evidence"] = [name for name in claim["shown_in"] if name in shown]
    code, here = Path(fprc.__path__[0]) / "claims" / "paper.py", Path.cwd()
    # a link where page and code are in one project, not where the package is installed elsewhere
    beside = code.is_relative_to(here) and folder.absolute().is_relative_to(here)
    return {
        "claims": report["claims"],
        "holding": holding(report["claims"]),
        "code": quote(os.path.relpath(code, folder)) if beside else "",
        "note": report["note"],
        "ledger": {"short": "Claims", **_origin(ledger[0], folder, ".json", ".csv")},
    }


def _lines(pages: Mapping[str, Mapping[str, Any]]) -> dict[str, tuple[str, str]]:
    """Return of Tables II and IV what a reader asks first, by anchor: what it is, and numbers."""
    found: dict[str, tuple[str, Any]] = {}
    for table in {"table2", "table4"} & pages.keys():
        columns, rows = (pages[table]["table"][key] for key in ("columns", "data"))
        if table == "table2":
            what, *cells = rows[-1]
            found[table] = f"{what} of the models [kPa]", zip(columns[1:], cells, strict=True)
        else:
            at = columns.index("Sweep") if "Sweep" in columns else -1
            numbers = ((row[0], row[at]) for row in rows if "paper" not in row)
            found[table] = f"RMSE of tracking, {columns[at].lower()} [deg]", numbers
    return {
        pages[table]["anchor"]: (
            what,
            # the means, without interval or deviation
            ", ".join(
                f"{name.removesuffix(', ours')} {re.split(' [(±]', cell)[0]}"
                for name, cell in cells
                if "paper" not in name
            ),
        )
        for table, (what, cells) in sorted(found.items())
    }


def _kinds(table: str, fitted: Mapping[str, Any]) -> dict[str, str]:
    """Return whether the rig was fitted to a table's rows."""
    to, start = set(fitted["to"]), set(fitted.get("start", ()))

    def kind(term: str) -> str:
        return "fitted" if term in to else "half fitted" if term in start else "predicted"

    if table in ("table2", "table3"):
        return dict.fromkeys(("FPRC", "FPRC+PD"), kind("tables"))
    if table == "table4":
        closed = {"closed_sweep", "closed_errors"} & (to | start)
        return {"FPRC": kind("open_loop"), "FPRC+PD": "half fitted" if closed else "predicted"}
    return {}


def _page(path: str, fitted: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    table, name = read_json(path), Path(path).stem
    kinds = _kinds(name.removesuffix("_seeds"), fitted)
    same = len(set(kinds.values())) < 2
    return {
        "anchor": name,
        "short": table["title"].partition(". ")[0],
        "kind": next(iter(kinds.values()), "") if same else "half fitted",
        "rows": {} if same else kinds,
        "title": table["title"],
        "note": table["note"][:1].upper() + table["note"][1:],
        "table": table,
        "one_seed": None,
        **_origin(path, folder, ".csv", ".tex"),
    }


def _figure(picture: str, source: str, captions: Mapping[str, str], folder: Path) -> dict[str, Any]:
    with Image.open(picture) as image:
        width, height = image.size
    origin = _origin(picture, folder, ".csv", ".pdf")
    target, stem = origin["target"], Path(picture).stem.partition("_")[2]
    # sine_0p2 reads sine, 0.2 Hz
    words = re.sub(r"_(\d)p(\d)", r", \1.\2 Hz", stem).replace("_", " ")
    name = re.sub(r"\b(esn|fprc)\b", lambda match: match[0].upper(), words)
    return {
        "anchor": target,
        "short": title_of_result(target),
        "name": name,
        "png": base64.b64encode(Path(picture).read_bytes()).decode(),
        "width": width,
        "height": height,
        "caption": captions.get(target, name),
        "data": SOURCES.get(source, "drawing, no data"),
        **origin,
    }


def _origin(path: str, folder: Path, *kinds: str) -> dict[str, Any]:
    """Return the target that makes a result, and links to its files from the page's folder."""
    files, stem = map(Path(path).with_suffix, kinds), Path(path).stem
    known = {"table2_timing": "timing"} | dict.fromkeys([stem] * stem.endswith("_seeds"), "seeds")
    return {
        "target": known.get(stem, re.sub(r"^fig0?(\d+)_.*", r"fig\1", stem)),
        "files": {
            file.suffix[1:].upper(): quote(os.path.relpath(file, folder))
            for file in files
            if file.exists()
        },
    }
