"""The page in headless Chromium, on the smallest screen of the laboratory."""

import shutil

import pytest

from tests.unit.render.fake_report import bare_report, fake_report
from tethertest.records.comparison import Verdict
from tethertest.render import write_report

pytestmark = pytest.mark.browser

SCREEN = {"width": 1366, "height": 768}
LARGEST_PAGE = 5_000_000  #: [bytes]


@pytest.fixture(scope="module")
def browser():
    playwright = pytest.importorskip("playwright.sync_api")
    executable = shutil.which("chromium")
    if executable is None:
        pytest.fail("chromium is not installed; apt-get install chromium")
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=executable, args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture(scope="module", params=["slow", "fast", "undecided", "bare"])
def opened(request, browser, tmp_path_factory):
    report = {
        "slow": fake_report,
        "fast": lambda: fake_report(frequency=3.0, verdict=Verdict.FAIL),
        "undecided": lambda: fake_report(verdict=Verdict.UNDECIDED),
        "bare": bare_report,
    }[request.param]()
    path, _ = write_report(report, tmp_path_factory.mktemp("report"))
    page = browser.new_page(viewport=SCREEN)
    messages, requests = [], []
    page.on("console", lambda message: messages.append(message.text))
    page.on("pageerror", lambda error: messages.append(str(error)))
    page.on("request", lambda asked: requests.append(asked.url))
    page.goto(path.as_uri())
    yield request.param, path, page, messages, requests
    page.close()


def test_nothing_is_reported_on_the_console(opened):
    assert opened[3] == []


def test_nothing_is_fetched(opened):
    _, path, _, _, requests = opened
    assert [url for url in requests if not url.startswith("data:")] == [path.as_uri()]


def test_verdict_overlay_and_lines_are_on_the_first_screen(opened):
    name, _, page, _, _ = opened
    inside = ["#verdict", "#reasons", "#overlay", "#line-table"]
    if name != "bare":
        inside += ["#overlay img", "#line-table tbody tr:last-child td:last-child"]
    for selector in inside:
        box = page.locator(selector).bounding_box()
        assert box is not None
        assert box["y"] >= 0
        assert box["y"] + box["height"] <= SCREEN["height"], selector
        assert box["x"] + box["width"] <= SCREEN["width"], selector


def test_every_image_is_loaded(opened):
    name, _, page, _, _ = opened
    widths = page.eval_on_selector_all("img", "images => images.map(image => image.naturalWidth)")
    assert len(widths) == (0 if name == "bare" else 6)
    assert all(width > 800 for width in widths)


def test_the_page_never_scrolls_sideways(opened):
    page = opened[2]
    assert page.evaluate("document.documentElement.scrollWidth") <= SCREEN["width"]


def test_the_page_is_small(opened):
    assert opened[1].stat().st_size < LARGEST_PAGE


def test_it_prints_on_few_sheets(opened):
    pdf = opened[2].pdf(prefer_css_page_size=True)
    assert pdf.count(b"/Type /Page\n") <= 14
