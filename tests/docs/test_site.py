"""The built site in a headless Chromium: `make site` builds and looks at it.

Skipped, with the reason, where there is no site, no Playwright or no Chromium.
"""

import os
import shutil
import threading
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from urllib.parse import unquote, urldefrag, urljoin, urlsplit

import pytest

pytestmark = pytest.mark.site

SITE = Path(__file__).parents[2] / "docs" / "_build" / "html"
PHONE, DESK = {"width": 390, "height": 800}, {"width": 1400, "height": 900}
FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--disable-background-networking",
         "--disable-component-update", "--disable-sync", "--no-first-run"]  # fmt: skip
SHOWN = ["index", "start", "ideas", "equations", "benchmarks", "comparison",
         "api/control", "gallery/index", "gallery/frames/figure04", "notebooks/table-3",
         "recipes/task"]  # fmt: skip
"""Pages of every kind, which are looked at closely."""

LINKS = "[...document.querySelectorAll('a[href]')].map(a => a.href)"
IDS = "[...document.querySelectorAll('[id]')].map(e => e.id)"
BROKEN = "[...document.images].filter(i => i.complete && !i.naturalWidth).map(i => i.src)"
WIDER = "document.documentElement.scrollWidth - document.documentElement.clientWidth"
CONTRAST = """() => {
  const parts = c => c.match(/[\\d.]+/g).map(Number);
  const light = c => {
    const [r, g, b] = parts(c).slice(0, 3).map(v => v / 255)
      .map(v => v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const behind = e => {
    for (; e; e = e.parentElement) {
      const c = getComputedStyle(e).backgroundColor;
      if ((parts(c)[3] ?? 1) > 0.5) return c;
    }
    return 'rgb(255, 255, 255)';
  };
  const found = [];
  const walk = document.createTreeWalker(document.querySelector('article'), NodeFilter.SHOW_TEXT);
  while (walk.nextNode()) {
    const e = walk.currentNode.parentElement;
    if (!walk.currentNode.textContent.trim() || !e.getClientRects().length) continue;
    if (getComputedStyle(e).visibility === 'hidden' || e.closest('.headerlink')) continue;
    const [a, b] = [light(getComputedStyle(e).color), light(behind(e))].sort((x, y) => y - x);
    const ratio = (a + 0.05) / (b + 0.05);
    if (ratio < 3) found.push(ratio.toFixed(2) + ' ' + walk.currentNode.textContent.trim());
  }
  return found;
}"""
"""Text whose contrast with what is behind it is below 3 (WCAG, large text)."""


@pytest.fixture(scope="module")
def browser():
    api = pytest.importorskip("playwright.sync_api", reason="Playwright is not installed")
    chromium = os.environ.get("CHROMIUM") or shutil.which("chromium")
    if not chromium:
        pytest.skip("there is no Chromium; install it, or name it in CHROMIUM")
    if not (SITE / "index.html").exists():
        pytest.skip("the site is not built; make docs builds it")
    with api.sync_playwright() as playwright:
        found = playwright.chromium.launch(executable_path=chromium, args=FLAGS)
        yield found
        found.close()


@pytest.fixture(scope="module")
def address():
    """The site behind a server of its own, as readers get it."""

    class Quiet(SimpleHTTPRequestHandler):
        def log_message(self, *_):
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=SITE))
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    yield f"http://127.0.0.1:{server.server_address[1]}/"
    server.shutdown()
    thread.join()


class Looked:
    """A page with what its console said and what it asked for elsewhere."""

    def __init__(self, browser, address, viewport=DESK, scheme="light"):
        self.complaints: list[str] = []
        self.context = browser.new_context(viewport=viewport, color_scheme=scheme)
        self.page = self.context.new_page()
        self.page.on("console", lambda m: m.type == "error" and self.complaints.append(m.text))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("requestfailed", self._failed)
        self.page.on("request", self._asked)
        self.address = address

    def _failed(self, request):
        # Whoever goes on to the next page calls off what is not there yet, such as its icon.
        if request.failure != "net::ERR_ABORTED":
            self.complaints.append(f"{request.url}: {request.failure}")

    def _asked(self, request):
        if not request.url.startswith((self.address, "data:")):
            self.complaints.append(f"asks for {request.url}")

    def go(self, page):
        self.page.goto(f"{self.address}{page}", wait_until="load")
        return self.page

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.context.close()


def test_no_link_is_broken_and_no_console_complains(browser, address):
    """Every page of the site, every link and anchor on it, every picture."""
    todo, seen, wanted, ids = [f"{address}index.html"], set(), {}, {}
    with Looked(browser, address) as looked:
        while todo:
            url = todo.pop()
            if url in seen:
                continue
            seen.add(url)
            page = looked.go(url.removeprefix(address))
            assert not page.evaluate(BROKEN), url
            ids[url] = set(page.evaluate(IDS))
            for link in page.evaluate(LINKS):
                target, anchor = urldefrag(urljoin(url, link))
                if not target.startswith(address):
                    continue
                wanted.setdefault((target, unquote(anchor)), url)
                if target.endswith(".html") and "/_modules/" not in target:
                    todo.append(target)
        assert looked.complaints == []
    assert len(seen) > 100
    for (target, anchor), source in wanted.items():
        file = SITE / unquote(urlsplit(target).path).lstrip("/")
        assert file.exists(), f"{source} links to {target}"
        if anchor and target in ids:
            assert anchor in ids[target], f"{source} links to {target}#{anchor}"


@pytest.mark.parametrize("name", SHOWN)
def test_a_phone_shows_the_whole_width(browser, address, name):
    with Looked(browser, address, viewport=PHONE) as looked:
        page = looked.go(f"{name}.html")
        assert page.evaluate(WIDER) <= 0
        style = "getComputedStyle(document.querySelector('article'))"
        size = page.evaluate(f"parseFloat({style}.fontSize)")
        assert size >= 14


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("name", SHOWN)
def test_text_stands_out(browser, address, name, scheme):
    with Looked(browser, address, scheme=scheme) as looked:
        page = looked.go(f"{name}.html")
        dark = page.evaluate("getComputedStyle(document.body).backgroundColor")
        levels = [int(part) for part in dark[4:-1].split(",")[:3]]
        assert (max(levels) < 60) == (scheme == "dark")
        assert page.evaluate(CONTRAST) == []


@pytest.mark.parametrize(
    ("word", "page"),
    [("gaussian_product", "api/values"), ("impedance", "api/control"), ("sugar", "cup-and-sugar")],
)
def test_search_finds(browser, address, word, page):
    with Looked(browser, address) as looked:
        found = looked.go(f"search.html?q={word}")
        found.wait_for_selector("ul.search li a")
        found.wait_for_function(
            "document.querySelector('#search-progress') === null || "
            "!document.querySelector('p.search-summary').innerText.includes('…')"
        )
        links = found.evaluate("[...document.querySelectorAll('ul.search li a')].map(a => a.href)")
        assert any(page in link for link in links), links
        assert looked.complaints == []


def test_every_picture_of_the_gallery_stands_beside_its_code(browser, address):
    with Looked(browser, address, viewport={"width": 1500, "height": 900}) as looked:
        page = looked.go("gallery/frames/figure04.html")
        picture = page.locator(".sphx-glr-single-img").first.bounding_box()
        code = page.locator(".highlight-Python").first.bounding_box()
        assert picture["x"] + picture["width"] <= code["x"]
        assert abs(picture["y"] - code["y"]) < 60
