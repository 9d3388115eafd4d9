"""Real keys on the report page, in a headless Chromium that is driven over its DevTools pipe."""

import fcntl
import json
import os
import select
import shutil
import subprocess
from contextlib import contextmanager

import pytest

pytestmark = pytest.mark.slow

PROGRAM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "chrome"))), None)

OPTIONS = """--headless --no-sandbox --disable-gpu --no-first-run --disable-background-networking
    --disable-component-update --disable-sync --disable-dev-shm-usage --hide-scrollbars""".split()

#: The browser answers within milliseconds, but may start on a busy machine.
PATIENCE_S = 120.0

#: Windows' code of a key, and the text that it types.
KEYS = {"Tab": (9, ""), "Enter": (13, "\r"), "Escape": (27, "")}


class Page:
    """A page in the browser."""

    def __init__(self, commands, answers):
        self._commands, self._answers, self._sent, self._session = commands, answers, 0, {}
        self._unread = b""
        (page,) = (
            each for each in self.call("Target.getTargets")["targetInfos"] if each["type"] == "page"
        )
        attached = self.call("Target.attachToTarget", targetId=page["targetId"], flatten=True)
        self._session = {"sessionId": attached["sessionId"]}
        self.call("Page.enable")

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
        return json.loads(first)

    def open(self, address):
        """Load a page, and wait for it."""
        self.call("Page.navigate", url=address)
        while self._message().get("method") != "Page.loadEventFired":
            pass

    def ask(self, expression):
        """Return the value of an expression of JavaScript."""
        answer = self.call("Runtime.evaluate", expression=expression, returnByValue=True)
        assert "exceptionDetails" not in answer, answer
        return answer["result"].get("value")

    def press(self, key):
        """Press and release a key of ``KEYS``."""
        code, text = KEYS[key]
        typed = {"key": key, "code": key, "windowsVirtualKeyCode": code}
        self.call(
            "Input.dispatchKeyEvent", type="keyDown", **typed, **({"text": text} if text else {})
        )
        self.call("Input.dispatchKeyEvent", type="keyUp", **typed)


@contextmanager
def browsing(folder):
    """Yield a page of a browser, whose profile is in ``folder``."""
    ends = {}

    def connect():
        # Chromium reads commands from descriptor 3 and answers on 4
        # through copies above both: neither end is overwritten before it is copied
        above = [fcntl.fcntl(ends[name], fcntl.F_DUPFD, 20) for name in ("read", "write")]
        for number, copied in enumerate(above, start=3):
            os.dup2(copied, number)

    ends["read"], commands = os.pipe()
    answers, ends["write"] = os.pipe()
    process = subprocess.Popen(
        [PROGRAM, *OPTIONS, "--remote-debugging-pipe", "--window-size=1280,900",
         f"--user-data-dir={folder / 'profile'}"],
        preexec_fn=connect, close_fds=False, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    try:
        yield Page(commands, answers)
    finally:
        process.kill()
        process.wait()
        for each in (*ends.values(), commands, answers):
            os.close(each)


#: What has the keyboard's focus: its name, and whether a reader sees it and its ring.
FOCUSED = """(() => {
  const at = document.activeElement, box = at.getBoundingClientRect(), style = getComputedStyle(at);
  const middle = (low, high, limit) => (Math.max(low, 0) + Math.min(high, limit)) / 2;
  const hit = document.elementFromPoint(
    middle(box.left, box.right, innerWidth), middle(box.top, box.bottom, innerHeight));
  return {
    number: [...document.querySelectorAll("*")].indexOf(at),
    name: `${at.tagName} ${at.getAttribute("aria-label") || at.textContent.trim().slice(0, 40)}`,
    seen: Boolean(hit && (at.contains(hit) || hit.contains(at))),
    ring: style.outlineStyle != "none" && parseFloat(style.outlineWidth) > 0,
  };
})()"""

#: Numbers of the elements that a pointer can use.
USABLE = """[...document.querySelectorAll("a[href], button, select, summary, [tabindex='0']")]
  .filter((each) => each.getClientRects().length && each.checkVisibility())
  .map((each) => [...document.querySelectorAll("*")].indexOf(each))"""

#: Whether the focus is on an element behind the dialog; from its last one it goes to the browser.
BEHIND = """document.activeElement != document.body
  && !document.querySelector("dialog").contains(document.activeElement)"""


@pytest.mark.skipif(PROGRAM is None, reason="no chromium here; install it to test the page")
def test_every_link_and_button_is_reached_by_the_keyboard(smoked, tmp_path):
    with browsing(tmp_path) as page:
        page.open((smoked[0].folder / "results/smoke/report.html").as_uri())
        usable, walk = set(page.ask(USABLE)), []
        for _ in range(len(usable) + 5):
            page.press("Tab")
            walk.append(page.ask(FOCUSED))
            if walk[-1]["name"].startswith("BODY"):
                break
        assert walk.pop()["name"].startswith("BODY")
        assert usable <= {each["number"] for each in walk}
        assert [each["name"] for each in walk if not (each["seen"] and each["ring"])] == []

        page.ask("document.querySelector('#fig8 .picture button').focus()")
        before = page.ask(FOCUSED)["name"]
        page.press("Enter")
        assert page.ask("document.querySelector('dialog').open")
        page.press("Tab")
        assert page.ask(BEHIND) is False
        page.press("Escape")
        assert not page.ask("document.querySelector('dialog').open")
        assert page.ask(FOCUSED)["name"] == before
