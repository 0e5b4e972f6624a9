"""The page in a real browser: the whole loop, by keyboard too; nothing in the console."""

import re
import shutil
import signal
import subprocess
import sys
import time

import pytest

from tests.unit.workbench.conftest import replace

sync_api = pytest.importorskip("playwright.sync_api", reason="no Playwright to drive a browser")

BROWSER = next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), ""
)
pytestmark = pytest.mark.skipif(not BROWSER, reason="no Chromium on this machine")

#: software rendering, as there is no graphics card
FLAGS = ["--no-sandbox", "--disable-dev-shm-usage", "--use-gl=angle", "--use-angle=swiftshader",
         "--enable-unsafe-swiftshader"]  # fmt: skip
PATIENCE_MS = 300_000


@pytest.fixture(scope="module")
def served(measured_folder, tmp_path_factory):
    """`vmach open` in a process of its own: its address and folder."""
    folder = tmp_path_factory.mktemp("browser") / "part"
    shutil.copytree(measured_folder, folder, symlinks=True)
    words = [sys.executable, "-P", "-m", "vmach", "open", str(folder), "--no-browser"]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, text=True, start_new_session=True)
    address = re.search(r"http://127\.0\.0\.1:\d+/\?token=\S+", process.stdout.readline())[0]
    yield address, folder, process
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
    assert process.wait(PATIENCE_MS / 1000) in (0, 130)
    process.stdout.close()


@pytest.fixture(scope="module")
def context():
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=BROWSER, args=FLAGS, timeout=PATIENCE_MS
        )
        made = browser.new_context(viewport={"width": 1400, "height": 900})
        made.set_default_timeout(PATIENCE_MS)
        yield made
        browser.close()


@pytest.fixture(scope="module")
def heard(context):
    """What the pages said in the console, and whom they asked."""
    told = {"console": [], "hosts": set()}
    context.on("request", lambda request: told["hosts"].add(request.url.split("/")[2]))
    context.on("console", lambda message: message.type in ("error", "warning")
               and told["console"].append(message.text))  # fmt: skip
    context.on("weberror", lambda error: told["console"].append(str(error.error)))
    return told


@pytest.fixture(scope="module")
def tab(context, heard, served):
    page = context.new_page()
    page.goto(served[0])
    ready(page)
    return page


def until(holds):
    """Wait until something holds in the page; its policy lets no text be run there."""
    end = time.monotonic() + PATIENCE_MS / 1000
    while not holds():
        assert time.monotonic() < end, "it does not come to hold"
        time.sleep(0.05)


def says(page, place, word):
    until(lambda: word in page.locator(place).inner_text())


def ready(page):
    page.wait_for_selector("body[data-ready=part]")


def figure(page, word):
    text = page.locator("#figures div", has_text=word).locator("dd").inner_text()
    return float(text.split()[0].replace("−", "-"))


def test_the_part_is_there_and_the_token_is_not_in_the_address(tab, served):
    assert "token" not in tab.url
    assert figure(tab, "RMS") > 0.1
    assert tab.locator("#lines .line").count() > 10


def test_a_click_names_the_point_and_the_text_follows(tab):
    box = tab.locator("#canvas").bounding_box()
    tab.mouse.click(box["x"] + 0.45 * box["width"], box["y"] + 0.5 * box["height"])
    tab.wait_for_selector("table.shares")
    made_by = tab.locator(".point .facts").inner_text()
    line = re.search(r"line (\d+)", made_by)[1]
    assert tab.locator(".line.selected").get_attribute("data-line") == line
    shares = [float(t.replace("−", "-")) for t in tab.locator(".shares .value").all_inner_texts()]
    total = float(tab.locator(".point .big").inner_text().split()[0].replace("−", "-"))
    assert sum(shares) == pytest.approx(total, abs=0.06)  # rounded to 0.01 each


def test_a_line_shows_what_it_makes(tab):
    tab.locator('#lines .line[data-line="9"]').click()
    says(tab, "#line-foot", "Line 9")


def test_a_slider_moves_the_colours_and_reset_brings_them_back(tab):
    tab.locator("#quantity").select_option("residual")
    says(tab, "#figures", "Measured")
    before = figure(tab, "RMS")
    tab.locator("#tab-what-if").click()
    tab.get_by_label("Find an effect").fill("backlash y")
    slider = tab.locator(".effect input[type=range]").first
    slider.focus()
    for _ in range(3):
        tab.keyboard.press("PageUp")
    says(tab, "#what-if-residual", "µm")
    until(lambda: abs(figure(tab, "RMS") - before) > 0.05)
    tab.get_by_role("button", name="Reset").click()
    until(lambda: abs(figure(tab, "RMS") - before) < 0.011)


def test_the_loop_takes_three_clicks_and_undo_one(tab, served):
    tab.locator("#tab-diagnose").click()
    tab.locator("#diagnose").click()
    tab.locator(".card .primary", has_text="Add").first.click()
    tab.wait_for_selector(".mark-held")
    ready(tab)
    assert (served[1] / "job-2.toml").is_file()
    fitted = [
        float(t.split(":")[1].split()[0])
        for t in tab.locator(".mark-fitted title").all_text_contents()
    ]
    held = [
        float(t.split(":")[1].split()[0])
        for t in tab.locator(".mark-held title").all_text_contents()
    ]
    assert fitted[1] < 0.5 * fitted[0] and held[1] < 0.7 * held[0]
    tab.locator("#undo").click()
    says(tab, "#job-about", "job.toml")
    ready(tab)


def test_two_tabs_show_the_same(tab, context):
    other = context.new_page()
    other.goto(tab.url)
    ready(other)
    other.locator("#tab-diagnose").click()
    other.get_by_role("button", name="Forward to it").click()
    for page in (tab, other):
        says(page, "#job-about", "job-2.toml")
        ready(page)
    other.close()


def test_the_keyboard_alone(tab):
    tab.locator("#tab-look").click()
    for name in ("what-if", "diagnose", "propose", "compensate"):
        tab.keyboard.press("ArrowRight")
        assert tab.locator(f"#panel-{name}").is_visible()
    tab.keyboard.press("ArrowRight")
    tab.locator("#canvas").focus()
    before = tab.locator("#triad").inner_html()
    tab.keyboard.press("ArrowLeft")
    until(lambda: tab.locator("#triad").inner_html() != before)
    tab.locator("#lines").focus()
    tab.keyboard.press("ArrowDown")
    assert tab.locator(".line.selected").count() == 1


def test_it_plays(tab):
    tab.locator("#play").click()
    until(lambda: float(tab.locator("#time").input_value()) > 1)
    tab.locator("#play").click()
    assert re.search(r"line \d+ · T1 · X", tab.locator("#telling").inner_text())


def test_a_broken_file_is_said_and_harms_nothing(tab, served):
    job = served[1] / "job-2.toml"
    good = job.read_text()
    replace(job, good + "\n[oops\n")
    tab.wait_for_selector(".notice:not(.news)")
    assert "job-2.toml" in tab.locator(".notice:not(.news)").first.inner_text()
    replace(job, good)
    ready(tab)


def test_the_console_is_silent_and_nobody_else_is_asked(tab, heard, served):
    expected = (
        "Failed to load resource: the server responded with a status of 400"  # the broken file
    )
    assert [text for text in heard["console"] if not text.startswith(expected)] == []
    assert heard["hosts"] == {served[0].split("/")[2]}


def test_it_closes_when_it_is_told_to(tab, served):
    tab.locator("#shut-down").click()
    tab.get_by_text("The workbench is closed").wait_for()
    assert served[2].wait(PATIENCE_MS / 1000) == 0
