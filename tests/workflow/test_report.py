"""The report of the paper in a browser."""

import importlib.util
import json
import re
import shutil
import subprocess
from html import unescape
from pathlib import Path
from urllib.parse import unquote

import pytest

from fprc.claims.paper import CLAIMS

pytestmark = pytest.mark.slow

BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "chrome"))), None)
OPTIONS = """--headless --no-sandbox --disable-gpu --no-first-run --disable-background-networking
    --disable-component-update --disable-sync --disable-dev-shm-usage --hide-scrollbars
    --allow-file-access-from-files --window-size=2000,1200 --virtual-time-budget=600000
    --dump-dom""".split()
#: Width and height of a screen, and the colours that its reader prefers.
SCREENS = {"phone": (390, 844, "light"), "laptop": (1280, 800, "light"),
           "desk": (1920, 1080, "light"), "dark": (1280, 800, "dark")}  # fmt: skip

#: Shows a page on each screen, and prints what a reader sees: pictures that are missing, what is
#: wider than the screen, what is cut off, and what axe finds wrong, if it is there.
LOOK = """<!doctype html><pre id="seen"></pre><script>%(axe)s</script><script>
async function look(name, [width, height, colours]) {
  const frame = document.createElement("iframe");
  frame.style = `border: 0; width: ${width}px; height: ${height}px; color-scheme: ${colours}`;
  const loaded = new Promise((done) => { frame.onload = done; });
  frame.src = "%(page)s";
  document.body.append(frame);
  await loaded;
  const page = frame.contentDocument, root = page.documentElement, limit = root.clientWidth + 1;
  const box = (element) => element.getBoundingClientRect();
  const scrolling = [...page.querySelectorAll(".scroll, nav")];
  const inside = (element) => scrolling.some((around) => around.contains(element));
  const all = [...page.body.querySelectorAll("*")].filter((e) => e.getClientRects().length);
  const text = (element) => element.outerHTML.slice(0, 80);
  const seen = {
    images: page.images.length,
    broken: [...page.images].filter((i) => !i.complete || !i.naturalWidth).map((i) => i.alt),
    scrolls: root.scrollWidth > limit,
    wide: all.filter((element) => box(element).right > limit && !inside(element)).map(text),
    cut: scrolling.filter((e) => e.tagName != "NAV" && e.scrollWidth > e.clientWidth + 1).map(text),
    claims: page.querySelectorAll(".claims details").length,
    number: box(page.querySelector(".summary b") ?? page.body).bottom,
    banner: box(page.querySelector(".banner") ?? page.body).height,
    colour: frame.contentWindow.getComputedStyle(page.body).backgroundColor,
  };
  // closed, their text lies unseen over what follows, and axe takes that for its background
  for (const details of page.querySelectorAll("details")) details.open = true;
  // axe copies the source of each element, of which the pictures would be megabytes
  for (const image of page.images) image.src = "data:image/gif;base64,R0lGODlhAQABAAAAACw=";
  const script = page.createElement("script");
  script.text = document.scripts[0].text;
  page.head.append(script);
  const audit = await frame.contentWindow.axe?.run(page);
  seen.audited = audit?.passes.map((check) => check.id);
  seen.wrong = audit?.violations.flatMap((violation) => violation.nodes.map(
    (node) => `${violation.id}: ${node.target} ${node.failureSummary.slice(0, 200)}`));
  frame.remove();
  return [name, seen];
}
(async () => {
  const seen = [];
  for (const screen of Object.entries(%(screens)s)) seen.push(await look(...screen));
  document.getElementById("seen").textContent = JSON.stringify(Object.fromEntries(seen));
})();
</script>"""


@pytest.fixture(scope="module")
def seen(report, tmp_path_factory):
    """What a reader of the page sees, by the screen."""
    if BROWSER is None:
        pytest.skip("no chromium here; install it to test the page in a browser")
    found = importlib.util.find_spec("axe_core_python")
    axe = (Path(found.origin).parent / "axe.min.js").read_text(encoding="utf-8") if found else ""
    folder = tmp_path_factory.mktemp("browser")
    filled = {"axe": axe, "page": report.as_uri(), "screens": json.dumps(SCREENS)}
    (folder / "look.html").write_text(LOOK % filled, encoding="utf-8")
    asked = [BROWSER, *OPTIONS, f"--user-data-dir={folder}", (folder / "look.html").as_uri()]
    done = subprocess.run(asked, capture_output=True, text=True, timeout=600)
    return json.loads(unescape(re.search(r'<pre id="seen">(.*?)</pre>', done.stdout)[1]))


@pytest.fixture(scope="module")
def report(paper):
    """Path of the page of the paper."""
    return paper[0].folder / "results/report.html"


@pytest.mark.parametrize("screen", SCREENS)
def test_page_opens_from_disk_and_is_accessible_on_every_screen(seen, screen):
    page = seen[screen]
    assert page["images"] == 17
    assert page["broken"] == page["wide"] == page["cut"] == []
    assert not page["scrolls"]
    # the banner has one line, the first number is on the first screen
    assert page["banner"] < 50
    assert page["number"] < SCREENS[screen][1]
    assert page["claims"] == len(CLAIMS)
    if "wrong" in page:
        assert page["wrong"] == []
        assert "color-contrast" in page["audited"]


def test_colours_are_the_systems(seen):
    assert seen["laptop"]["colour"] != seen["dark"]["colour"]


def test_links_to_files_lead_to_files(report):
    text = report.read_text(encoding="utf-8")
    links = re.findall(r'href="(?!data:|#|https://doi\.org/)([^"]*)"', text)
    assert {"claims.json", "tables/table2.csv", "figures/fig08_training.pdf"} <= set(links)
    assert [link for link in links if not (report.parent / unquote(link)).is_file()] == []
    assert len(text) < 8e6
