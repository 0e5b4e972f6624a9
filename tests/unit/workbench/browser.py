"""A real browser on a workbench of its own; one server and one page serve the tests of a module.

What has to come is waited for as long as it takes.
"""

import contextlib
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.measured_job import write_odd_job

BROWSER = next(
    filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), ""
)
needs_browser = pytest.mark.skipif(not BROWSER, reason="no Chromium on this machine")

#: software rendering, as there is no graphics card
FLAGS = ["--no-sandbox", "--disable-dev-shm-usage", "--use-gl=angle", "--use-angle=swiftshader",
         "--enable-unsafe-swiftshader"]  # fmt: skip
PATIENCE_MS = 300_000
#: a desk's layout with a small map, as every pixel is drawn by the processor; and a tablet's
WINDOW, TABLET = {"width": 1180, "height": 640}, {"width": 1024, "height": 600}
#: answers that the tests ask for: a job that cannot be read, readings that are none
REFUSED = "Failed to load resource: the server responded with a status of 400"


@pytest.fixture(scope="module")
def served(measured_folder, tmp_path_factory):
    """`vmach open` in a process of its own: its address, folder and process."""
    folder = tmp_path_factory.mktemp("browser") / "part"
    shutil.copytree(measured_folder, folder, symlinks=True)
    write_odd_job(folder)
    words = [sys.executable, "-P", "-m", "vmach", "open", str(folder), "--no-browser"]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, text=True, start_new_session=True)
    address = re.search(r"http://127\.0\.0\.1:\d+/\?token=\S+", process.stdout.readline())[0]
    yield address, folder, process
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
    assert process.wait(PATIENCE_MS / 1000) in (0, 130)
    process.stdout.close()


@pytest.fixture(scope="module")
def folder(served):
    return served[1]


@pytest.fixture(scope="module")
def context():
    sync_api = pytest.importorskip("playwright.sync_api", reason="no Playwright")
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=BROWSER, args=FLAGS, timeout=PATIENCE_MS
        )
        made = browser.new_context(viewport=WINDOW)
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


def press_to(page, place, key="Tab"):
    """Press a key until the focus is on a place of the page."""
    target = page.locator(place).first
    for _ in range(200):
        if target.evaluate("one => one === document.activeElement"):
            return
        page.keyboard.press(key)
    raise AssertionError(f"{place} is not reached by {key}")


def press_tab(page, name):
    """Choose a panel by keys."""
    press_to(page, "[role=tab][aria-selected=true]")
    press_to(page, f"#tab-{name}", "ArrowRight")


def dismiss(page):
    """Close all messages."""
    while page.locator(".notice .close").count():
        page.locator(".notice .close").first.click(force=True)


def complaint(page):
    """What is said in red; it is then closed."""
    page.locator(".notice.error").first.wait_for()
    text = page.locator(".notice.error").first.inner_text()
    dismiss(page)
    return text


def open_job(page, name):
    """Open a job by its name on the start page, or by the end of its path."""
    page.locator("#home").click()
    page.locator(".jobs button", has_text=name).first.click()
    until(lambda: page.locator("#job-about").inner_text().startswith(name.split("/")[-1]))
    ready(page)


def children_of(pid, word):
    """Processes that a process started whose command has a word in it."""
    children, found = [], []
    for task in Path(f"/proc/{pid}/task").iterdir():
        with contextlib.suppress(OSError):  # a thread, or a process, may have ended meanwhile
            children += (task / "children").read_text().split()
    for child in children:
        with contextlib.suppress(OSError):
            if word in Path(f"/proc/{child}/cmdline").read_bytes().decode():
                found.append(int(child))
    return found


def workers_of(process):
    """The process that holds the part: what loads for it has started it."""
    loaders = children_of(process.pid, "forkserver")
    return [worker for loader in loaders for worker in children_of(loader, "forkserver")]


@contextlib.contextmanager
def browser_alone(context, size):
    """A browser that knows the token, and no other tab: those of one browser share their events."""
    made = context.browser.new_context(storage_state=context.storage_state(), viewport=size)
    made.set_default_timeout(PATIENCE_MS)
    yield made
    made.close()


def drop(page, place, name, text):
    """Let a file fall on a place of the page."""
    made = page.evaluate_handle(
        "([name, text]) => { const data = new DataTransfer();"
        " data.items.add(new File([text], name)); return data; }",
        [name, text],
    )
    page.locator(place).dispatch_event("drop", {"dataTransfer": made})
