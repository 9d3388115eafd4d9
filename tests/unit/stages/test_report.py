import base64
import html
import os
import re
from functools import cache
from pathlib import Path
from urllib.parse import unquote

import jinja2
import pandas as pd
import pytest
import yaml
from bs4 import BeautifulSoup
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

import fprc
from fprc.artifacts import write_json
from fprc.config import Settings
from fprc.provenance import hash_of
from fprc.stages import report
from fprc.stages.report import symbols, write_report
from fprc.tables.text import write_table

TEMPLATE = [
    str(Path(__file__).parents[3] / "workflow" / "report" / f"page.{kind}.j2")
    for kind in ("html", "css")
]
DOI = "https://doi.org/10.1109/LRA.2024.3523229"
DEFAULTS = Settings().model_dump(mode="json")
EVALUATION = DEFAULTS["evaluation"]
SETTINGS = DEFAULTS | {
    "seed": 31,
    "evaluation": EVALUATION | {"folds": 4, "replicate_seeds": [401, 402]},
}
COMMIT = "0123456789ab"


class Page:
    """Elements of a page with their attributes and text."""

    def __init__(self, text):
        soup = BeautifulSoup(text, "html.parser", multi_valued_attributes=None)
        self.elements = [
            {"tag": found.name, "text": found.get_text(), **found.attrs}
            for found in soup.find_all()
        ]

    def all(self, tag, **attributes):
        return [
            element
            for element in self.elements
            if element["tag"] == tag
            and all(element.get(name) == value for name, value in attributes.items())
        ]

    def texts(self, tag, **attributes):
        return [" ".join(element["text"].split()) for element in self.all(tag, **attributes)]

    def text(self):
        return " ".join(self.texts("body"))


CLAIMS = [
    {"id": "C1", "claim": "FPRC is best", "published": "11.0 kPa", "basis": "3 seeds",
     "note": "P_o helps", "verdict": "reproduced", "shown_in": [], "rig": "fitted", "statements": [
         {"text": "RMSE of theta_d", "mean": 12.0, "first": 11.5, "last": 12.5,
          "limits": "below 13", "verdict": "reproduced"}]},
    {"id": "C2", "claim": "P_o is unmoved", "published": "so", "basis": "main run", "note": "",
     "verdict": "not reproduced", "shown_in": [], "rig": "predicted", "statements": [
         {"text": "growth", "mean": 1.0, "first": 0.9, "last": 1.125,
          "limits": "within 0.8 to 1.2", "verdict": "reproduced"}]},
    {"id": "C3", "claim": "PD moves", "published": "yes", "basis": "3 seeds", "note": "",
     "verdict": "undecided", "shown_in": [], "rig": "counted", "statements": []},
]  # fmt: skip


#: Templates that are compiled once.
ENVIRONMENT = cache(report._environment)


@pytest.fixture(autouse=True)
def fixed(monkeypatch):
    monkeypatch.setattr(report, "_environment", ENVIRONMENT)
    monkeypatch.setattr(report, "commit_of", lambda package: COMMIT)
    monkeypatch.setattr(report, "versions", lambda: {"python": "3.99.1", "numpy": "9.8.7"})


class Project:
    """Files of a report, and what goes to the stage."""

    def __init__(self, folder):
        self.folder = folder
        self.claims = [dict(row) for row in CLAIMS]
        self.ledger = [str(folder / "claims.json")]
        self.missing = {}
        self.tables, self.figures, self.sources, self.captions = [], [], [], {}
        self.settings = SETTINGS

    def add_table(self, words, name=None, **columns):
        path = self.folder / name if name else self.folder / str(len(self.tables))
        title, _, note = words.partition(": ")
        page = pd.DataFrame(columns)
        files = [f"{path}.{kind}" for kind in ("csv", "md", "tex", "json")]
        write_table(page, page, note, *files, title=title)
        self.tables.append(files[-1])

    def add_figure(self, number, caption="A caption.", source="sim"):
        stem = self.folder / f"fig{number:02}_name"
        Image.new("RGB", (20 + number, 10), (number, 100, 200)).save(f"{stem}.png")
        self.captions[f"fig{number}"] = caption
        self.figures.append(f"{stem}.png")
        self.sources.append(source)

    def write(self):
        """Write the report and return its text."""
        for path in self.ledger:
            write_json(path, {"source": "sim", "note": "Fitted to C2.", "claims": self.claims})
        target = self.folder / "report.html"
        captions = self.folder / "captions.yaml"
        write_json(captions, self.captions)
        write_report(
            TEMPLATE, self.ledger, self.tables, self.figures, str(captions), str(target),
            sources=self.sources, missing=self.missing, settings=self.settings,
        )  # fmt: skip
        return target.read_text(encoding="utf-8")

    def page(self):
        return Page(self.write())


@pytest.fixture
def project(tmp_path):
    """Three claims, two tables and three figures, one of which has no data."""
    project = Project(tmp_path)
    project.add_table("Table I. Settings: ours and\nas published.", Model=["ESN"], Value=["800"])
    project.add_table(
        "Table IV. Tracking: P_ff alone.", **{"RMSE [deg]": ["FPRC", "PD"], "Sweep": ["2.67", ""]}
    )
    project.add_figure(4, "Loops of theta over P_exp.")
    project.add_figure(6, "A drawing.", "none")
    project.add_figure(12, "Following.")
    return project


# Symbols


PIECES = st.sampled_from(["<", ">", "&", '"', "'", "P_o", "theta", "<i>", "&lt;", "</td>", " "])


@given(st.lists(PIECES | st.text(max_size=4), max_size=12).map("".join))
def test_whatever_a_text_holds_it_adds_no_other_tag_and_loses_nothing(text):
    shown = str(symbols(text))
    assert set(re.findall(r"<[^>]*>", shown)) <= {"<sub>", "</sub>"}
    plain = html.unescape(re.sub("<sub>(.*?)</sub>", r"_\1", shown))
    assert plain.replace("θ", "theta") == text.replace("θ", "theta")


# Banner


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
    (shown,) = page.texts("div", **{"class": "banner"})
    assert shown.startswith(f"{text} {kinds};")
    assert page.texts("strong") == [text]
    assert page.texts("title") == [f"fprc: {text.lower()}"]
    body = [element["tag"] for element in page.elements]
    assert body[body.index("body") + 1] == "div"


# What is on the page


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
    page = project.page()
    _, claims, two, four, _, _, *_ = page.texts("dd")[:1] + page.texts("dd")
    assert "1 of 3 claims hold" in claims
    assert "0 of 1 predicted, 1 of 1 fitted, 0 of 1 counted" in claims
    assert two.endswith("over seeds: ESN 16.0, FPRC 12.1")
    assert four.endswith("FPRC 2.3")


def test_every_claim_is_shown_with_its_verdict_its_numbers_and_its_code(project, monkeypatch):
    project.claims[1]["shown_in"] = ["fig4", "fig5"]
    (project.folder / "fig04_name.csv").touch()
    monkeypatch.chdir(os.path.commonpath([project.folder, fprc.__path__[0]]))
    page = project.page()
    for row, summary in zip(CLAIMS, page.texts("summary"), strict=False):
        text = shown(row["claim"])
        sentence = f"{text[0].upper()}{text[1:]}."
        assert summary == f"{row['id']} {sentence} {row['verdict']} {row['rig']}"
        (judged,) = page.texts("dl", id=row["id"])
        for key in ("published", "basis", "note"):
            assert shown(row[key]) in judged
        chip = f"chip {row['verdict'].replace(' ', '-')}"
        assert set(page.texts("span", **{"class": chip})) == {row["verdict"]}
        assert row["rig"] in page.texts("span", **{"class": row["rig"]})
    assert "Fitted to C2." in page.text()
    assert "RMSE of θd: 12 (11.5 to 12.5), below 13: reproduced" in page.texts("dl", id="C1")[0]
    links = [link["href"] for link in page.all("a")]
    assert links.count("claims.json") == 1 + len(CLAIMS)
    assert links.count("fig04_name.csv") == 2
    code = [project.folder / unquote(link) for link in links if link.endswith("paper.py")]
    assert len(code) == len(CLAIMS)
    assert all(path.is_file() for path in code)


def shown(text):
    """Return a text as it reads on the page, without its tags."""
    return html.unescape(re.sub("<[^>]*>", "", str(symbols(text))))


def test_every_table_is_shown_with_its_title_note_and_cells(project):
    page = project.page()
    assert page.texts("h3") == ["Table I. Settings", "Table IV. Tracking"]
    notes = page.texts("p", **{"class": "note"})
    assert notes[-2:] == ["Ours and as published.", "Pff alone."]
    assert ["ModelValueESN800", "RMSE [deg]SweepFPRC2.67PD"] == [
        text.replace(" ", "").replace("RMSE[", "RMSE [") for text in page.texts("table")[:2]
    ]


def test_configuration_is_shown_once_among_the_settings(project):
    project.add_table("Table I. Settings: a note.", "table1", Model=["ESN"], Value=["800"])
    page = project.page()
    places = [element.get("id") for element in page.elements]
    assert places.count("table1") == 1
    assert places.index("settings") < places.index("table1")


#: Of each table: what it is if the rig was fitted to Tables II and III, if to Table IV too, if to
#: neither, and if only the rig at which the fit began was searched for them.
TABLES = {
    **dict.fromkeys(
        ("table2", "table2_seeds", "table3", "table3_seeds"),
        ("fitted", "fitted", "predicted", "half fitted"),
    ),
    **dict.fromkeys(
        ("table4", "table4_seeds"), ("predicted", "half fitted", "predicted", "half fitted")
    ),
    "table2_timing": ("", "", "", ""),
}
FITS = (
    {"to": ["tables", "orders"]}, {"to": ["tables", "open_loop"]}, {"to": ["C8"]},
    {"to": ["C8"], "start": ["tables", "open_loop"]},
)  # fmt: skip


@pytest.mark.parametrize("source", ["sim", "rig"])
@pytest.mark.parametrize("number", range(len(FITS)))
def test_table_of_a_simulated_rig_says_whether_it_was_fitted_to(tmp_path, source, number):
    project = Project(tmp_path)
    project.settings = SETTINGS | {"fitted": {"name": "one", **FITS[number]}}
    expected = []
    for name, kinds in TABLES.items():
        project.add_table(f"Title {name}: a note.", name, Model=["ESN"], Value=["800"])
        kind = kinds[number] if source == "sim" else ""
        if name.endswith("_seeds"):  # in the place of the table of one seed
            expected[-1] = f"Title {name.removesuffix('_seeds')}, over seeds {kind}".strip()
        else:
            expected.append(f"Title {name} {kind}".strip())
    project.add_figure(4, source=source)
    page = project.page()
    assert page.texts("h3") == expected
    folded = [text.split(" with ")[0] for text in page.texts("summary") if "one seed" in text]
    assert folded == [f"Title {name}" for name in ("table2", "table3", "table4")]


@pytest.mark.parametrize(
    ("fitted", "kinds"),
    [
        ({"to": ["open_loop"]}, ["fitted", "predicted", "predicted"]),
        ({"to": ["open_loop", "closed_sweep"]}, ["fitted", "half-fitted", "predicted"]),
        ({"to": [], "start": ["closed_errors"]}, ["predicted", "half-fitted", "predicted"]),
    ],
)
def test_rows_of_a_half_fitted_table_say_what_was_fitted(project, fitted, kinds):
    project.settings = SETTINGS | {"fitted": {"name": "one", **fitted}}
    rows = ["FPRC", "FPRC+PD", "PD"]
    project.add_table("Table IV. A note.", "table4", **{"RMSE [deg]": rows, "Whose": ["ours"] * 3})
    page = project.page()
    found = {row["text"].split("\n")[0]: row.get("class") for row in page.all("tr")}
    assert [kind for text, kind in found.items() if text.endswith("ours")] == kinds
    assert page.texts("small") == ["half fitted"]


def test_every_figure_is_shown_with_number_caption_and_origin(project):
    page = project.page()
    commands = [text.split()[-1] for text in page.texts("code") if "snakemake --cores 2 " in text]
    assert commands[0] == "claims"
    assert commands[-3:] == ["fig4", "fig6", "fig12"]
    assert [figure["id"] for figure in page.all("figure")] == ["fig4", "fig6", "fig12"]
    captions = page.texts("figcaption")
    assert captions[0].startswith("Fig. 4. Loops of θ over Pexp.")
    for image, picture, caption in zip(
        page.all("img"), project.figures, project.captions.values(), strict=True
    ):
        kind, _, data = image["src"].partition(",")
        assert (kind, image["alt"]) == ("data:image/png;base64", caption)
        assert base64.b64decode(data, validate=True) == Path(picture).read_bytes()
    assert "simulated rig, not hardware" in captions[0]
    assert "drawing, no data" in captions[1]


def test_every_setting_seed_and_version_is_on_the_page(project):
    page = project.page()
    (settings,) = page.all("pre")
    assert yaml.safe_load(settings["text"]) == SETTINGS
    text = page.text()
    assert {"31;", "401,", "402.", f"{COMMIT}."} <= set(text.split())
    assert f"Settings: SHA-256 {hash_of(SETTINGS)[:16]}" in text
    for name, number in (("python", "3.99.1"), ("numpy", "9.8.7")):
        assert name in text
        assert number in text


def test_only_settings_that_are_not_the_papers_are_listed_and_announced(project):
    def listed():
        return sorted(text for text in project.page().texts("li") if " instead of " in text)

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


def test_every_link_within_the_page_has_its_target(project):
    page = project.page()
    targets = {element["id"] for element in page.elements if "id" in element}
    links = [link["href"] for link in page.all("a") if link["href"].startswith("#")]
    sections = {"content", "claims", "tables", "figures", "settings"}
    shown = {"0", "1", "fig4", "fig6", "fig12"}
    assert {link[1:] for link in links} == sections | shown
    assert {link[1:] for link in links} <= targets
    identifiers = [element["id"] for element in page.elements if "id" in element]
    assert len(set(identifiers)) == len(identifiers)


def test_page_refers_to_nothing_outside_itself_but_the_paper(project):
    text = project.write()
    page = Page(text)
    references = [element.get("href", element.get("src", "#")) for element in page.elements]
    beside = {link for link in references if not link.startswith(("#", "data:"))} - {DOI}
    # links to the files beside the page, which nothing on it needs
    assert {element["tag"] for element in page.elements if element.get("href") in beside} == {"a"}
    files = {path.name for path in project.folder.iterdir() if path.suffix in (".csv", ".tex")}
    assert beside == files | {"claims.json"}
    assert str(project.folder) not in text
    assert not {"iframe", "object", "script"} & {element["tag"] for element in page.elements}
    assert set(re.findall(r"https?://[^\"<\s]+|@import|url\(", text)) == {DOI}


def test_page_without_a_ledger_has_tables_and_figures_but_no_claims(project):
    project.ledger = []
    page = project.page()
    assert "#claims" not in [link["href"] for link in page.all("a")]
    assert page.all("div", **{"class": "claims"}) == []
    assert len(page.all("figure")) == 3


def test_no_text_becomes_markup(project):
    odd = "<b>1 < 2</b> \" onload='x' & {{ 7 * 7 }} </td>"
    before = {element["tag"] for element in project.page().elements}
    project.claims[0] |= dict.fromkeys(("claim", "published", "basis", "verdict"), odd)
    project.add_table(f"{odd}: {odd}", **{odd: [odd]})
    project.add_figure(1, odd)
    page = project.page()
    assert {element["tag"] for element in page.elements} == before
    assert not [name for element in page.elements for name in element if name.startswith("on")]
    for tag in ("summary", "dd", "th", "figcaption"):
        assert any("{{ 7 * 7 }} </td>" in text for text in page.texts(tag))


# What is an error


def test_what_is_not_available_is_listed_with_its_reason(project):
    assert not project.page().all("h2", id="missing")
    project.missing = {"Fig. 5": "needs p_o_kpa, which sweep.h5 does not have"}
    page = project.page()
    assert page.texts("h2", id="missing") == ["Not available for this data"]
    assert "Fig. 5" in page.texts("dt")
    assert "needs p_o_kpa, which sweep.h5 does not have" in page.texts("dd")
    assert "Not available" in page.texts("a", href="#missing")


def test_failure_leaves_the_old_page(project):
    old = project.write()
    project.settings = {"fitted": DEFAULTS["fitted"]}
    with pytest.raises(jinja2.UndefinedError):
        project.write()
    assert (project.folder / "report.html").read_text(encoding="utf-8") == old
