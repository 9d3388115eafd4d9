"""The report page in a browser."""

import fcntl
import importlib.util
import json
import os
import re
import select
import shutil
import subprocess
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import unquote

import pytest

from fprc.claims.paper import CLAIMS

pytestmark = pytest.mark.slow

BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "chrome"))), None)
OPTIONS = """--headless --no-sandbox --disable-gpu --no-first-run --disable-background-networking
    --disable-component-update --disable-sync --disable-dev-shm-usage --hide-scrollbars""".split()
SCREENS = {"phone": (390, 844), "laptop": (1280, 800), "desk": (1920, 1080)}

#: The browser answers within milliseconds, but may start on a busy machine.
PATIENCE_S = 120.0


class Page:
    """A page in the browser, which is driven over its DevTools pipe."""

    def __init__(self, commands, answers):
        self._commands, self._answers, self._sent, self._session = commands, answers, 0, {}
        self._unread = b""
        self.errors = []
        (page,) = (
            tab for tab in self.call("Target.getTargets")["targetInfos"] if tab["type"] == "page"
        )
        attached = self.call("Target.attachToTarget", targetId=page["targetId"], flatten=True)
        self._session = {"sessionId": attached["sessionId"]}
        for domain in ("Page", "Runtime", "Log"):
            self.call(f"{domain}.enable")

    def call(self, method, **parameters):
        """Call a method of the protocol and return its result."""
        self._sent += 1
        message = {"id": self._sent, "method": method, "params": parameters, **self._session}
        os.write(self._commands, json.dumps(message).encode() + b"\0")
        while (answer := self._message()).get("id") != self._sent:
            pass
        assert "error" not in answer, answer
        return answer["result"]

    def _message(self):
        while b"\0" not in self._unread:
            assert select.select([self._answers], [], [], PATIENCE_S)[0], "the browser is silent"
            read = os.read(self._answers, 1 << 20)
            assert read, "the browser has ended"
            self._unread += read
        first, self._unread = self._unread.split(b"\0", 1)
        message = json.loads(first)
        kind, parameters = message.get("method"), message.get("params", {})
        if (
            kind == "Runtime.exceptionThrown"
            or (kind == "Runtime.consoleAPICalled" and parameters["type"] == "error")
            or (kind == "Log.entryAdded" and parameters["entry"]["level"] == "error")
        ):
            self.errors.append(parameters)
        return message

    def open(self, path, screen="laptop"):
        """Load a page from disk on a screen, and wait for it."""
        width, height = SCREENS[screen]
        self.call(
            "Emulation.setDeviceMetricsOverride",
            width=width, height=height, deviceScaleFactor=1, mobile=False,
        )  # fmt: skip
        self.errors.clear()
        self.call("Page.navigate", url=path.as_uri())
        while self._message().get("method") != "Page.loadEventFired":
            pass

    def ask(self, expression):
        """Return the value of an expression of JavaScript, or what its promise gives."""
        answer = self.call(
            "Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True
        )
        assert "exceptionDetails" not in answer, answer
        return answer["result"].get("value")

    def prefer(self, colours):
        """Let the system of the reader be light or dark."""
        wanted = {"name": "prefers-color-scheme", "value": colours}
        self.call("Emulation.setEmulatedMedia", features=[wanted])


@contextmanager
def browsing(folder):
    """Yield a page of a browser, whose profile is in ``folder``."""
    read, commands = os.pipe()
    answers, write = os.pipe()
    # Chromium reads commands from descriptor 3 and answers on 4; ends that are 3 or 4 would be lost
    ends = [fcntl.fcntl(end, fcntl.F_DUPFD, 20) for end in (read, write)]
    process = subprocess.Popen(
        [
            "bash", "-c", f'exec "$@" 3<&{ends[0]} 4>&{ends[1]}', "browser", BROWSER, *OPTIONS,
            "--remote-debugging-pipe", f"--user-data-dir={folder / 'profile'}",
        ],
        pass_fds=ends, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    # so that a browser that ends is noticed
    for end in (*ends, read, write):
        os.close(end)
    try:
        yield Page(commands, answers)
    finally:
        process.kill()
        process.wait()
        for pipe in (commands, answers):
            os.close(pipe)


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    """One page of a browser, in which each test opens what it looks at."""
    if BROWSER is None:
        pytest.skip("no chromium here; install it to test the page in a browser")
    with browsing(tmp_path_factory.mktemp("browser")) as page:
        yield page


@pytest.fixture(scope="module")
def report(paper):
    """Path of the page of the paper."""
    return paper[0].folder / "results/report.html"


#: What a reader sees: pictures that are missing, what is wider than the screen, what is cut off.
SEEN = """(() => {
  const root = document.documentElement, limit = root.clientWidth + 1;
  const box = (element) => element.getBoundingClientRect();
  const scrolling = [...document.querySelectorAll(".scroll, nav")];
  const inside = (element) => scrolling.some((around) => around.contains(element));
  const all = [...document.body.querySelectorAll("*")].filter((e) => e.getClientRects().length);
  const text = (element) => element.outerHTML.slice(0, 80);
  return {
    images: document.images.length,
    broken: [...document.images].filter((i) => !i.complete || !i.naturalWidth).map((i) => i.alt),
    scrolls: root.scrollWidth > limit,
    wide: all.filter((element) => box(element).right > limit && !inside(element)).map(text),
    cut: scrolling.filter((e) => e.tagName != "NAV" && e.scrollWidth > e.clientWidth + 1).map(text),
    claims: [...document.querySelectorAll(".claims details")].map((element) => box(element).bottom),
    number: box(document.querySelector(".summary b") ?? document.body).bottom,
    banner: box(document.querySelector(".banner") ?? document.body).height,
  };
})()"""


@pytest.mark.parametrize("screen", SCREENS)
def test_page_opens_from_disk_without_error_on_every_screen(browser, report, screen):
    browser.open(report, screen)
    seen = browser.ask(SEEN)
    assert browser.errors == []
    assert seen["images"] == 17
    assert seen["broken"] == seen["wide"] == seen["cut"] == []
    assert not seen["scrolls"]
    # the banner has one line, the first number is on the first screen
    assert seen["banner"] < 50
    assert seen["number"] < SCREENS[screen][1]
    assert len(seen["claims"]) == len(CLAIMS)


def test_colours_are_the_systems(browser, report):
    browser.open(report)
    colours = set()
    for system in ("light", "dark"):
        browser.prefer(system)
        colours.add(browser.ask("getComputedStyle(document.body).backgroundColor"))
    assert len(colours) == 2


def axe():
    """Return the script of axe, which audits accessibility and contrast; none if not installed."""
    found = importlib.util.find_spec("axe_core_python")
    return found and (Path(found.origin).parent / "axe.min.js").read_text(encoding="utf-8")


#: Prepares a page for axe.
UNFOLD = """
  // closed, their text lies unseen over what follows, and axe takes that for its background
  for (const details of document.querySelectorAll("details")) details.open = true;
  // axe copies the source of each element, of which the pictures would be megabytes
  for (const image of document.images) image.src = "data:image/gif;base64,R0lGODlhAQABAAAAACw=";
"""
AUDIT = """axe.run(document, %s).then((report) => ({
  checked: report.passes.map((check) => check.id),
  wrong: report.violations.flatMap((violation) => violation.nodes.map(
    (node) => `${violation.id}: ${node.target} ${node.failureSummary.slice(0, 200)}`)),
}))"""


@pytest.mark.skipif(not axe(), reason="no axe-core-python here; install it to audit the page")
@pytest.mark.parametrize(
    ("screen", "colours", "rules"),
    [
        ("laptop", "light", {}),
        ("laptop", "dark", {"runOnly": ["color-contrast"]}),
        ("phone", "light", {}),
    ],
)
def test_page_is_accessible(browser, report, screen, colours, rules):
    browser.open(report, screen)
    browser.prefer(colours)
    browser.ask(UNFOLD)
    browser.ask(f"{axe()}; undefined")
    found = browser.ask(AUDIT % json.dumps(rules))
    assert found["wrong"] == []
    assert "color-contrast" in found["checked"]


def test_browser_notices_a_page_that_is_wrong(browser, tmp_path):
    page = tmp_path / "wrong.html"
    page.write_text(
        '<title>wrong</title><img src="gone.png" alt="gone"><p style="width:2000px">wide</p>'
        '<div class="scroll" style="width:9rem; overflow:auto"><p style="width:99rem">cut</div>'
        '<script>console.error("oh"); undefined.x</script>',
        encoding="utf-8",
    )
    browser.open(page)
    seen = browser.ask(SEEN)
    assert len(browser.errors) >= 2
    assert seen["broken"] == ["gone"]
    assert seen["scrolls"]
    assert any("2000px" in element for element in seen["wide"])
    assert len(seen["cut"]) == 1


def test_links_to_files_lead_to_files(report):
    text = report.read_text(encoding="utf-8")
    links = re.findall(r'href="(?!data:|#|https://doi\.org/)([^"]*)"', text)
    assert {"claims.json", "tables/table2.csv", "figures/fig08_training.pdf"} <= set(links)
    assert [link for link in links if not (report.parent / unquote(link)).is_file()] == []
    assert len(text) < 8e6
