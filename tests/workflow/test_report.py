"""The report page in a browser, and Snakemake's own report."""

import importlib.util
import json
import re
import shutil
import subprocess
import zipfile
from pathlib import Path
from urllib.parse import unquote

import pytest

from fprc.claims.paper import CLAIMS

pytestmark = pytest.mark.slow

BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "chrome"))), None)
WIDTHS = {"phone": 390, "laptop": 1280, "desk": 1920}

#: Loads a page into frames as wide as the screens and writes down what is wrong with it.
HARNESS = """<!DOCTYPE html><meta charset="utf-8"><body>
<script>
const widths = %s, axe = %s, found = {};
let done = 0;
// What a reader does elsewhere: sort a table, enlarge a figure and close it, choose colours.
function used(page) {
  const table = page.querySelector("table.deviations"), large = page.querySelector("dialog");
  if (!table) return null;
  const rows = () => [...table.tBodies[0].rows].map((row) => Number(row.cells[2].textContent));
  const heading = table.querySelectorAll("thead button")[1], before = rows();
  heading.click();
  const up = rows(), sorted = heading.parentElement.ariaSort;
  heading.click();
  const down = rows();
  page.querySelector(".picture button").click();
  const shown = large.open && large.querySelector("img").src.length > 99;
  large.close();
  const theme = page.getElementById("theme"), colours = [];
  for (const value of ["light", "dark"]) {
    theme.value = value;
    theme.dispatchEvent(new Event("change"));
    colours.push(getComputedStyle(page.body).backgroundColor);
  }
  return {before, up, down, sorted, shown, colours};
}
async function audit(page) {
  if (!page.defaultView.axe || !page.getElementById("theme")) return [];
  const wrong = [], checked = new Set();
  // closed, their text lies unseen over what follows, and axe takes that for its background
  for (const each of page.querySelectorAll("details")) each.open = true;
  // axe copies the source of each element, of which the pictures would be megabytes
  for (const image of page.images) image.src = "data:image/gif;base64,R0lGODlhAQABAAAAACw=";
  for (const theme of ["light", "dark"]) {
    page.documentElement.dataset.theme = theme;
    const rules = theme == "light" ? {} : {runOnly: ["color-contrast"]};
    const report = await page.defaultView.axe.run(page, rules);
    report.passes.forEach((each) => checked.add(each.id));
    wrong.push(...report.violations.flatMap((each) => each.nodes.map(
      (node) => `${theme}: ${each.id}: ${node.target} ${node.failureSummary.slice(0, 200)}`)));
  }
  if (!checked.has("color-contrast")) wrong.push("the contrast was not checked");
  return wrong;
}
async function look(frame, name) {
  const page = frame.contentDocument, root = page.documentElement;
  const limit = root.clientWidth + 1;
  const large = page.querySelector(".banner strong");
  const inside = (e) => [...page.querySelectorAll(".scroll, nav")].some((box) => box.contains(e));
  const seen = [...page.body.querySelectorAll("*")].filter(e => e.getClientRects().length);
  found[name] = {
    title: page.title,
    images: page.images.length,
    broken: [...page.images].filter(i => !i.complete || !i.naturalWidth).map(i => i.alt),
    scrolls: root.scrollWidth > limit,
    wide: seen.filter(e => e.getBoundingClientRect().right > limit && !inside(e))
      .map(e => e.outerHTML.slice(0, 80)),
    banner: parseFloat(getComputedStyle(large || page.body).fontSize),
    used: used(page),
  };
  if (name == "laptop") {
    page.head.append(Object.assign(page.createElement("script"), {textContent: axe}));
    found[name].wrong = await audit(page);
  }
  done += 1;
  if (done == Object.keys(widths).length) {
    const out = document.createElement("pre");
    out.id = "found";
    out.textContent = JSON.stringify(found);
    document.body.append(out);
  }
}
for (const [name, width] of Object.entries(widths)) {
  const frame = document.createElement("iframe");
  frame.style = `width:${width}px; height:800px; border:0`;
  frame.onload = () => look(frame, name);
  frame.src = %s;
  document.body.append(frame);
}
</script>"""


def audit():
    """Return the script of axe, which audits accessibility and contrast; none if not installed."""
    axe = importlib.util.find_spec("axe_core_python")
    if axe is None:
        return ""
    text = (Path(axe.origin).parent / "axe.min.js").read_text(encoding="utf-8")
    return text.replace("</", "<\\/")


def opened(page, folder):
    """Return what a headless browser finds in a page on disk, and its console's errors."""
    harness = folder / "harness.html"
    harness.write_text(
        HARNESS % (*map(json.dumps, (WIDTHS, audit())), json.dumps(page.as_uri())), encoding="utf-8"
    )
    done = subprocess.run(
        [
            BROWSER, "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run",
            "--disable-background-networking", "--disable-component-update", "--disable-sync",
            "--disable-dev-shm-usage", "--hide-scrollbars", "--window-size=1400,1000",
            "--allow-file-access-from-files", "--enable-logging=stderr",
            f"--user-data-dir={folder / 'profile'}", "--virtual-time-budget=20000",
            "--dump-dom", harness.as_uri(),
        ],
        capture_output=True, text=True, timeout=180,
    )  # fmt: skip
    text = re.search(r'<pre id="found">(.*?)</pre>', done.stdout, flags=re.DOTALL)
    assert text, done.stdout[:2000] + done.stderr[-2000:]
    plain = text[1].replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&")
    return json.loads(plain), re.findall(r"CONSOLE[:(].*", done.stderr)


needs_browser = pytest.mark.skipif(
    BROWSER is None, reason="no chromium here; install it to test the page in a browser"
)


@pytest.fixture(scope="module")
def looked(smoked, tmp_path_factory):
    """What a browser finds in the page, and what its console says."""
    page = smoked[0].folder / "results/smoke/report.html"
    return opened(page, tmp_path_factory.mktemp("browser"))


@needs_browser
@pytest.mark.parametrize("screen", WIDTHS)
def test_page_opens_from_disk_without_error_on_every_screen(looked, screen):
    found, console = looked
    assert console == []
    assert found[screen]["images"] == 17
    assert found[screen]["broken"] == []
    assert not found[screen]["scrolls"]
    assert found[screen]["wide"] == []
    assert found[screen]["banner"] > 25


@needs_browser
def test_tables_sort_figures_enlarge_and_colours_change(looked):
    used = looked[0]["laptop"]["used"]
    assert used["sorted"] == "ascending"
    assert used["up"] == sorted(used["before"])
    assert used["down"] == used["up"][::-1]
    assert used["shown"]
    assert len(set(used["colours"])) == 2


@needs_browser
@pytest.mark.skipif(not audit(), reason="no axe-core-python here; install it to audit the page")
def test_page_is_accessible_in_light_and_dark(looked):
    assert looked[0]["laptop"]["wrong"] == []


@needs_browser
def test_browser_notices_a_page_that_is_wrong(tmp_path):
    page = tmp_path / "wrong.html"
    page.write_text(
        '<title>wrong</title><img src="gone.png" alt="gone"><p style="width:2000px">wide</p>'
        '<script>console.error("oh"); undefined.x</script>',
        encoding="utf-8",
    )
    found, console = opened(page, tmp_path)
    assert len(console) >= 2
    for screen in WIDTHS:
        assert found[screen]["broken"] == ["gone"]
        assert found[screen]["scrolls"]
        assert any("2000px" in element for element in found[screen]["wide"])


def test_page_holds_everything_and_asks_for_nothing(smoked):
    text = (smoked[0].folder / "results/smoke/report.html").read_text(encoding="utf-8")
    assert "SIMULATED DATA" in text
    assert re.findall(r'src="(?!data:)[^"]*"', text) == []
    assert re.findall(r'<tr id="(C\d+[a-d]?)">', text) == [claim.id for claim in CLAIMS]
    assert text.index('id="claims"') < text.index('id="tables"') < text.index('id="figures"')


def test_links_to_files_lead_to_files(smoked):
    results = smoked[0].folder / "results/smoke"
    text = (results / "report.html").read_text(encoding="utf-8")
    links = re.findall(r'href="(?!data:|#|https://doi\.org/)([^"]*)"', text)
    assert {"claims.json", "tables/table2.csv", "figures/fig08_training.pdf"} <= set(links)
    assert [link for link in links if not (results / unquote(link)).is_file()] == []
    assert len(text) < 8e6


def test_snakemakes_own_report_has_every_figure_with_caption_and_category(smoked_copy):
    # as docs/running.md has it, without a word on cores
    done = smoked_copy.smoke("all", "--report", "report.zip", cores=())
    assert done.returncode == 0, done.stdout
    with zipfile.ZipFile(smoked_copy.folder / "report.zip") as archive:
        names = archive.namelist()
        texts = [
            archive.read(n).decode(errors="replace") for n in names if n.endswith((".html", ".js"))
        ]
    for number in range(1, 18):
        assert any(re.search(rf"fig{number:02}_\w+\.png$", name) for name in names), number
        assert any(f"Fig. {number}" in text for text in texts), number
    for category in ("II Pneumatic bending actuators", "IV Experimental results"):
        assert any(category in text for text in texts)
    assert any("simulated rig, not hardware" in text for text in texts)
    assert any("in both experiments" in text for text in texts)  # caption of Fig. 5
