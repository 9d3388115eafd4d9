import base64
import html
import os
import re
from pathlib import Path
from urllib.parse import unquote

import pandas as pd
import pytest
import yaml
from bs4 import BeautifulSoup
from PIL import Image

import fprc
from fprc.artifacts import write_json
from fprc.config import Settings
from fprc.escape import typeset
from fprc.stages import report
from fprc.stages.report import write_report
from fprc.tables.text import write_table

DOI = "https://doi.org/10.1109/LRA.2024.3523229"
DEFAULTS = Settings().model_dump(mode="json")
EVALUATION = DEFAULTS["evaluation"]
SETTINGS = DEFAULTS | {
    "seed": 31,
    "evaluation": EVALUATION | {"folds": 4, "replicate_seeds": [401, 402]},
}
COMMIT = "0123456789ab"
CLAIMS = [
    {"id": "C1", "claim": "FPRC is best", "published": "11.0 kPa", "basis": "3 seeds",
     "note": "P_o helps", "verdict": "reproduced", "shown_in": [], "rig": "fitted", "statements": [
         {"text": "RMSE of theta_d", "mean": 12.0, "first": 11.5, "last": 12.5,
          "limits": "below 13", "verdict": "reproduced"}]},
    {"id": "C2", "claim": "P_o is unmoved", "published": "so", "basis": "main run", "note": "",
     "verdict": "not reproduced", "shown_in": ["fig4", "fig5"], "rig": "predicted", "statements": [
         {"text": "growth", "mean": 1.0, "first": 0.9, "last": 1.125,
          "limits": "within 0.8 to 1.2", "verdict": "reproduced"}]},
    {"id": "C3", "claim": "PD moves", "published": "yes", "basis": "3 seeds", "note": "",
     "verdict": "undecided", "shown_in": [], "rig": "counted", "statements": []},
]  # fmt: skip


@pytest.fixture(autouse=True)
def fixed(monkeypatch):
    monkeypatch.setattr(report, "commit_of", lambda package: COMMIT)
    monkeypatch.setattr(report, "versions", lambda: {"python": "3.99.1"})


class Page:
    """Elements of a page."""

    def __init__(self, text):
        self.soup = BeautifulSoup(text, "html.parser", multi_valued_attributes=None)

    def all(self, tag, **attributes):
        return self.soup.find_all(tag, attrs=attributes)

    def texts(self, tag, **attributes):
        return [" ".join(found.get_text().split()) for found in self.all(tag, **attributes)]

    def links(self):
        return [link["href"] for link in self.all("a")]


class Project:
    """Files of a report, and what goes to the stage."""

    def __init__(self, folder):
        self.folder, self.settings, self.missing, self.captions = folder, SETTINGS, {}, {}
        self.claims = [dict(row) for row in CLAIMS]
        self.ledger = [str(folder / "claims.json")]
        self.tables, self.figures, self.sources = [], [], []

    def add_table(self, words, name=None, **columns):
        path = self.folder / (name or str(len(self.tables)))
        title, _, note = words.partition(": ")
        page = pd.DataFrame(columns)
        files = [f"{path}.{kind}" for kind in ("csv", "md", "tex", "json")]
        write_table(page, page, note, *files, title=title)
        self.tables.append(files[-1])

    def add_figure(self, number, source="sim"):
        stem = self.folder / f"fig{number:02}_name"
        Image.new("RGB", (20 + number, 10), (number, 100, 200)).save(f"{stem}.png")
        self.figures.append(f"{stem}.png")
        self.sources.append(source)

    def write(self):
        for path in self.ledger:
            write_json(path, {"source": "sim", "note": "Fitted to C2.", "claims": self.claims})
        target = self.folder / "report.html"
        write_report(
            self.ledger, self.tables, self.figures, str(target), sources=self.sources,
            caption_of=self.captions, missing=self.missing, settings=self.settings,
        )  # fmt: skip
        return target.read_text(encoding="utf-8")

    def page(self):
        return Page(self.write())


@pytest.fixture
def project(tmp_path):
    """Three claims, two tables and three figures, one of which has no data."""
    project = Project(tmp_path)
    project.add_table("Table I. Settings: ours.", "table1", Model=["ESN"], Value=["800"])
    project.add_table(
        "Table IV. Tracking: P_ff alone.", **{"RMSE [deg]": ["FPRC", "PD"], "Sweep": ["2.67", ""]}
    )
    project.add_figure(4)
    project.add_figure(6, "none")
    project.add_figure(12)
    return project


@pytest.mark.parametrize(
    ("sources", "text", "kinds"),
    [
        (["sim", "none"], "SIMULATED DATA", "simulated rig, not hardware"),
        (["rig", "none"], "MEASURED DATA", "recorded on the rig"),
        (["import", "rig"], "MEASURED DATA", "imported recordings and recorded on the rig"),
    ],
)
def test_page_begins_with_the_banner_of_its_figures(tmp_path, sources, text, kinds):
    project = Project(tmp_path)
    for number, source in enumerate(sources, start=1):
        project.add_figure(number, source=source)
    page = project.page()
    assert page.texts("div", **{"class": "banner"})[0].startswith(f"{text} {kinds};")
    assert page.texts("title") == [f"fprc: {text.lower()}"]
    assert page.soup.body.find()["class"] == "banner"


def test_page_opens_with_what_holds_and_what_was_measured(tmp_path):
    project = Project(tmp_path)
    project.add_figure(1)
    errors = {"E [kPa]": ["Training", "Test"], "ESN, ours": ["1", "16.0 (15 to 17)"],
              "ESN, paper": ["2", "3"], "FPRC, ours": ["2", "12.1 ± 0.2"]}  # fmt: skip
    project.add_table("Table II. Of one seed.", "table2", **errors)
    project.add_table("Table II. Errors.", "table2_seeds", **errors)
    project.add_table(
        "Table IV. Tracking.", "table4", **{"RMSE [deg]": ["FPRC", "FPRC"],
        "Whose": ["ours", "paper"], "Sine": ["1", "2"], "Sweep": ["2.3 (2 to 3)", "4"]},
    )  # fmt: skip
    claims, two, four, *_ = project.page().texts("dd")
    assert "1 of 3 claims hold" in claims
    assert "0 of 1 predicted, 1 of 1 fitted, 0 of 1 counted" in claims
    assert two.endswith("over seeds: ESN 16.0, FPRC 12.1")
    assert four.endswith("FPRC 2.3")


def test_every_claim_is_shown_with_its_verdict_its_numbers_and_its_code(project, monkeypatch):
    def shown(text):
        return html.unescape(re.sub("<[^>]*>", "", typeset(text)))

    (project.folder / "fig04_name.csv").touch()
    monkeypatch.chdir(os.path.commonpath([project.folder, fprc.__path__[0]]))
    page = project.page()
    for row, summary in zip(CLAIMS, page.texts("summary"), strict=False):
        text = shown(row["claim"])
        sentence = f"{text[0].upper()}{text[1:]}."
        assert summary == f"{row['id']} {sentence} {row['verdict']} {row['rig']}"
        (judged,) = page.texts("dl", id=row["id"])
        assert all(shown(row[key]) in judged for key in ("published", "basis", "note"))
        chip = f"chip {row['verdict'].replace(' ', '-')}"
        assert set(page.texts("span", **{"class": chip})) == {row["verdict"]}
    assert "RMSE of θd: 12 (11.5 to 12.5), below 13: reproduced" in page.texts("dl", id="C1")[0]
    links = page.links()
    assert links.count("claims.json") == 1 + len(CLAIMS)
    assert links.count("fig04_name.csv") == 2
    code = [project.folder / unquote(link) for link in links if link.endswith("paper.py")]
    assert len(code) == len(CLAIMS)
    assert all(path.is_file() for path in code)
    project.ledger = []
    page = project.page()
    assert "#claims" not in page.links()
    assert page.all("div", **{"class": "claims"}) == []


#: What a rig was fitted to; kinds of Tables II and IV, and of the rows of Table IV if they differ.
FITS = [
    ({"to": ["tables", "orders"]}, "fitted", "predicted", [None] * 3),
    ({"to": ["tables", "open_loop"]}, "fitted", "half fitted",
     ["fitted", "predicted", "predicted"]),
    ({"to": ["open_loop", "closed_sweep"]}, "predicted", "half fitted",
     ["fitted", "half-fitted", "predicted"]),
]  # fmt: skip


@pytest.mark.parametrize("source", ["sim", "rig"])
@pytest.mark.parametrize(("fitted", "of_models", "of_loops", "rows"), FITS)
def test_table_of_a_simulated_rig_says_whether_it_was_fitted_to(
    tmp_path, source, fitted, of_models, of_loops, rows
):
    project = Project(tmp_path)
    project.settings = SETTINGS | {"fitted": {"name": "one", **fitted}}
    for name in ("table2", "table2_seeds", "table2_timing"):
        project.add_table("Errors: a note.", name, Model=["ESN"], Value=["800"])
    loops = {"RMSE [deg]": ["FPRC", "FPRC+PD", "PD"], "Whose": ["ours"] * 3, "Sweep": ["1"] * 3}
    project.add_table("Loops: a note.", "table4", **loops)
    project.add_figure(4, source=source)
    page = project.page()
    kinds = ["Errors, over seeds", "Errors", "Loops"]
    if source == "sim":
        kinds = [f"Errors, over seeds {of_models}", "Errors", f"Loops {of_loops}"]
    assert sorted(page.texts("h3")) == sorted(kinds)
    # the table of one seed is folded up in the place of the same one over seeds
    assert [text for text in page.texts("summary") if "one seed" in text] == [
        "Errors with one seed, that of the figures"
    ]
    assert [row.get("class") for row in page.all("tr")[-3:]] == rows


def test_tables_and_figures_are_shown_with_their_notes_captions_and_files(project):
    project.captions = {"fig4": "Loops of\n  P_o.", "fig6": "A drawing."}
    page = project.page()
    assert page.texts("h3") == ["Table IV. Tracking", "Table I. Settings"]
    assert "Pff alone." in page.texts("p", **{"class": "note"})
    cells = [[cell.get_text() for cell in table(["th", "td"])] for table in page.all("table")]
    assert cells == [
        ["RMSE [deg]", "Sweep", "FPRC", "2.67", "PD", ""], ["Model", "Value", "ESN", "800"]
    ]  # fmt: skip
    assert [figure["id"] for figure in page.all("figure")] == ["fig4", "fig6", "fig12"]
    captions = page.texts("figcaption")
    assert captions[0].startswith("Fig. 4. Loops of Po.")
    shown = [*page.texts("ul", **{"class": "links"})[-1].split("Fig. ")[1:]]
    assert shown == ["4, name ", "6, name ", "12, name"]
    alternatives = ["Loops of P_o.", "A drawing.", ""]
    for image, picture, text in zip(page.all("img"), project.figures, alternatives, strict=True):
        kind, _, data = image["src"].partition(",")
        assert (kind, image["alt"]) == ("data:image/png;base64", text)
        assert base64.b64decode(data, validate=True) == Path(picture).read_bytes()
    assert "simulated rig, not hardware" in captions[0]
    assert "drawing, no data" in captions[1]


def test_every_setting_seed_and_version_is_on_the_page_and_what_differs_is_announced(project):
    def listed():
        return sorted(text for text in project.page().texts("li") if " instead of " in text)

    page = project.page()
    (settings,) = page.texts("pre")
    assert yaml.safe_load(page.all("pre")[0].get_text()) == SETTINGS
    (text,) = page.texts("body")
    assert {"31;", "401,", "402.", f"{COMMIT}.", "3.99.1."} <= set(text.split())
    assert re.search(r"Settings: SHA-256 [0-9a-f]{16}\b", text)
    taps = {"estimator": "my_models.Taps", "settings": {"n_y": 10}}
    project.settings = SETTINGS | {"models": DEFAULTS["models"] | {"others": {"taps": taps}}}
    assert "4 settings are not the paper's" in project.page().texts("header")[0]
    assert listed() == [
        "evaluation.folds: 4 instead of 5",
        f"evaluation.replicate_seeds: [401, 402] instead of {EVALUATION['replicate_seeds']}",
        "models.others.taps.estimator: my_models.Taps instead of none",
        "models.others.taps.settings.n_y: 10 instead of none",
    ]
    rig = DEFAULTS["rig"] | {"drift": DEFAULTS["rig"]["drift"] | {"sigma_kpa": 0.125}}
    own = {"seed": 99, "rig": rig, "folders": {"raw": "somewhere", "results": "else"}}
    project.settings = DEFAULTS | own | {"fitted": {"name": "dry", "to": ["tables"]}}
    assert listed() == []


def test_page_has_every_target_of_its_links_and_needs_nothing_outside_itself(project):
    text = project.write()
    page = Page(text)
    identifiers = [element["id"] for element in page.soup.find_all(id=True)]
    assert len(set(identifiers)) == len(identifiers)
    assert {link[1:] for link in page.links() if link.startswith("#")} <= set(identifiers)
    references = [*page.links(), *(image["src"] for image in page.all("img"))]
    beside = {link for link in references if not link.startswith(("#", "data:"))} - {DOI}
    files = {path.name for path in project.folder.iterdir() if path.suffix in (".csv", ".tex")}
    assert beside == files | {"claims.json"}
    assert str(project.folder) not in text
    assert page.all(["iframe", "object", "script"]) == []
    assert set(re.findall(r"https?://[^\"<\s]+|@import|url\(", text)) == {DOI}


def test_what_is_not_available_is_listed_with_its_reason(project):
    assert not project.page().all("h2", id="missing")
    project.missing = {"Fig. 5": "needs p_o_kpa, which sweep.h5 does not have"}
    page = project.page()
    assert "Fig. 5" in page.texts("dt")
    assert "needs p_o_kpa, which sweep.h5 does not have" in page.texts("dd")
    assert "#missing" in page.links()
