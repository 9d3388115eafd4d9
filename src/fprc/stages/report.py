"""Write the report: one page with claims, tables, figures and settings."""

import base64
import hashlib
import json
import os
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any
from urllib.parse import quote

import jinja2
import pandas as pd
import yaml
from markupsafe import Markup, escape
from PIL import Image

import fprc
from fprc.artifacts import commit_of, versions, write_text
from fprc.claims.ledger import holding
from fprc.config import Settings
from fprc.escape import in_words, typeset
from fprc.given import read_json
from fprc.paper import SOURCES
from fprc.plan import title_of_result

#: Folder of the page's templates.
_HERE = Path(__file__).parent

#: Settings whose differences from the defaults are not announced.
_NOT_COMPARED = ("source", "seed", "folders", "rig", "fitted", "calibration")


def write_report(
    ledger: Sequence[str],
    tables: Sequence[str],
    figures: Sequence[str],
    html: str,
    *,
    sources: Sequence[str],
    caption_of: Mapping[str, str],
    missing: Mapping[str, str],
    settings: Mapping[str, Any],
) -> None:
    """Write claims, tables, figures and settings to one self-contained page.

    ``ledger`` is empty if no claims were judged; tables are JSON, figures PNG. ``sources`` are
    those of the figures' data, ``caption_of`` has the captions by target, ``missing`` the results
    that the data do not allow, with reasons.
    """
    folder = Path(html).parent
    shown = [_figure(*drawn, caption_of, folder) for drawn in zip(figures, sources, strict=True)]
    pages = {Path(page).stem: _page(page, settings["fitted"]["to"], folder) for page in tables}
    # a table of one seed is folded up below the same one over seeds
    for name in [name for name in pages if f"{name}_seeds" in pages]:
        one = pages[name]
        over = {"title": f"{one['title']}, over seeds", "short": one["short"], "one_seed": one}
        pages[name] = pages.pop(f"{name}_seeds") | over
        one["short"] += " with one seed"
    judged: Any = read_json(ledger[0]) if ledger else {"claims": [], "note": ""}
    code, here = Path(fprc.__path__[0]) / "claims" / "paper.py", Path.cwd()
    # a link where page and code are in one project, not where the package is installed elsewhere
    beside = code.is_relative_to(here) and folder.absolute().is_relative_to(here)
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(_HERE), autoescape=True,
        undefined=jinja2.StrictUndefined, trim_blocks=True,
    )  # fmt: skip
    environment.filters["symbols"] = lambda text: Markup(typeset(str(escape(text))))
    page = environment.get_template("page.html.j2").render(
        kinds=in_words(SOURCES[source] for source in sorted({*sources} - {"none"})),
        # the workflow refuses logs of which some are simulated and others are not
        simulated="sim" in sources,
        claims=judged["claims"],
        note=judged["note"],
        holding=holding(judged["claims"]),
        code=quote(os.path.relpath(code, folder)) if beside else "",
        ledger={"short": "Claims"} | _origin(ledger[0], folder, ".json", ".csv") if ledger else {},
        missing=missing,
        parts={part["anchor"]: part for part in (*pages.values(), *shown)},
        configuration=pages.pop("table1", None),
        pages=pages.values(),
        lines=[_line(pages[name]) for name in ("table2", "table4") if name in pages],
        figures=shown,
        settings=settings,
        changed=_changed(settings),
        yaml=yaml.safe_dump(dict(settings), sort_keys=False),
        config=hashlib.sha256(json.dumps(settings, sort_keys=True).encode()).hexdigest(),
        commit=commit_of(Path(fprc.__path__[0])),
        versions=versions(),
    )
    write_text(html, page)


def _changed(settings: Mapping[str, Any]) -> dict[str, tuple[Any, Any]]:
    """Return the settings of models, experiments and evaluation that differ from the defaults."""
    default, ours = (
        pd.json_normalize(section).iloc[0]
        for section in (Settings().model_dump(mode="json"), dict(settings))
    )
    return {
        key: (value, default.get(key, "none"))
        for key, value in ours.items()
        if value != default.get(key) and key.split(".")[0] not in _NOT_COMPARED
    }


def _line(page: Mapping[str, Any]) -> tuple[Mapping[str, Any], str, str]:
    """Return of Table II or IV what a reader asks first: what it is, and numbers."""
    table = pd.DataFrame(page["data"], columns=page["columns"]).set_index(page["columns"][0])
    if page["anchor"].startswith("table2"):
        cells = table.iloc[-1].filter(like="ours")
        what = f"{cells.name} of the models {table.index.name.partition(' ')[2]}"
    else:
        ours = table[table["Whose"] == "ours"]
        cells = ours["Sweep" if "Sweep" in ours else ours.columns[-1]]
        what = f"RMSE of tracking, {str(cells.name).lower()} [deg]"
    # the means, without interval or deviation
    means = [f"{key.partition(',')[0]} {re.split(' [(±]', cell)[0]}" for key, cell in cells.items()]
    return page, what, ", ".join(means)


def _page(path: str, fitted_to: Sequence[str], folder: Path) -> dict[str, Any]:
    """Return a table, with whether the rig was fitted to it or to some of its rows."""
    table, name, kinds = read_json(path), Path(path).stem, {}
    if name.startswith("table4"):
        kinds["FPRC"] = "fitted" if "open_loop" in fitted_to else "predicted"
        kinds["FPRC+PD"] = "half fitted" if "closed_sweep" in fitted_to else "predicted"
    elif name.removesuffix("_seeds") in ("table2", "table3"):
        kinds["all"] = "fitted" if "tables" in fitted_to else "predicted"
    mixed = len({*kinds.values()}) > 1
    return table | {
        "anchor": name,
        "short": table["title"].partition(". ")[0],
        "kind": "half fitted" if mixed else next(iter(kinds.values()), ""),
        "rows": kinds if mixed else {},
        "note": table["note"][:1].upper() + table["note"][1:],
        "name": "",
        "one_seed": None,
        **_origin(path, folder, ".csv", ".tex"),
    }


def _figure(
    picture: str, source: str, caption_of: Mapping[str, str], folder: Path
) -> dict[str, Any]:
    origin = _origin(picture, folder, ".csv", ".pdf")
    # sine_0p2 reads sine 0.2 Hz
    name = re.sub(r"(\d)p(\d)", r"\1.\2 Hz", Path(picture).stem.partition("_")[2])
    name = re.sub(r"\b(esn|fprc)\b", lambda match: match[0].upper(), name.replace("_", " "))
    with Image.open(picture) as image:
        size = image.size
    return {
        "anchor": origin["target"],
        "short": title_of_result(origin["target"]),
        "name": f", {name}",
        "png": base64.b64encode(Path(picture).read_bytes()).decode(),
        "size": size,
        "caption": " ".join(caption_of.get(origin["target"], "").split()),
        "data": SOURCES.get(source, "drawing, no data"),
        **origin,
    }


def _origin(path: str, folder: Path, *kinds: str) -> dict[str, Any]:
    """Return the target that makes a result, and links to its files from the page's folder."""
    stem = Path(path).stem.replace("table2_timing", "timing")
    target = "seeds" if stem.endswith("_seeds") else re.sub(r"^fig0?(\d+)_.*", r"fig\1", stem)
    files = [file for file in map(Path(path).with_suffix, kinds) if file.exists()]
    links = {file.suffix[1:].upper(): quote(os.path.relpath(file, folder)) for file in files}
    return {"target": target, "files": links}
