"""Make the pictures of workbench.md anew: the tour in a real browser, on a copy of the sample.

    .venv/bin/python docs/make_workbench_pictures.py

Needs Chromium and the packages of ``vmach[test]``.
"""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

from playwright.sync_api import Page, sync_playwright

ROOT = Path(__file__).resolve().parents[1]
IMAGES = ROOT / "docs" / "images"
#: of the window, px; and how well the pictures are kept
SIZE, QUALITY = {"width": 1400, "height": 900}, 82
PATIENCE_MS = 600_000
FLAGS = [
    "--no-sandbox",
    "--disable-dev-shm-usage",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
]


def main() -> None:
    """Open the sample, walk through the tour, keep a picture of every stop."""
    browser = next(filter(None, map(shutil.which, ("chromium", "google-chrome"))), None)
    if browser is None:
        sys.exit("no Chromium on this machine")
    with tempfile.TemporaryDirectory() as folder:
        for name in ("missing_effect", "iso10791_7"):
            shutil.copytree(ROOT / "samples" / name, Path(folder) / name)
        job = Path(folder) / "missing_effect"
        words = [sys.executable, "-m", "vmach", "open", str(job), "--no-browser"]
        environment = os.environ | {"XDG_STATE_HOME": folder}  # no trace among the user's jobs
        server = subprocess.Popen(words, stdout=subprocess.PIPE, text=True, env=environment)
        try:
            walk(server, browser)
        finally:
            server.send_signal(signal.SIGINT)
            server.wait(30)


def walk(server: subprocess.Popen[str], browser: str) -> None:
    """The tour in a browser of its own, at the address that the server prints."""
    assert server.stdout is not None
    address = re.search(r"http\S+", server.stdout.readline())
    assert address is not None
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=browser, args=FLAGS)
        page = chromium.new_page(viewport=SIZE)
        page.set_default_timeout(PATIENCE_MS)
        page.goto(address[0])
        tour(page)
        chromium.close()


def tour(page: Page) -> None:
    """The stops of workbench.md, in their order."""
    ready(page)
    given = page.locator("#job-name").inner_text()
    box = page.locator("#canvas").bounding_box()
    assert box is not None
    page.mouse.click(box["x"] + 0.52 * box["width"], box["y"] + 0.48 * box["height"])
    page.wait_for_selector("table.shares")
    keep(page, "see")
    page.locator("#play").click()
    page.wait_for_timeout(4000)
    page.locator("#play").click()
    page.get_by_text("No collision").wait_for()
    keep(page, "play")
    page.get_by_title("Leave the playback").click()
    page.locator("#tab-diagnose").click()
    page.locator("#diagnose").click()
    page.locator(".card .primary", has_text="Add").first.wait_for()
    page.locator("#quantity").select_option("residual")
    page.locator("#figures").get_by_text("Measured").wait_for()
    keep(page, "ask")
    page.locator(".card .primary", has_text="Add").first.click()
    page.wait_for_selector(".mark-held")
    ready(page)
    keep(page, "add")
    page.locator("#undo").click()
    drawn_again(page, given)
    page.locator("#tab-what-if").click()
    page.get_by_label("Find an effect").fill("backlash y")
    page.get_by_label("backlash Y reversal").fill("124")
    page.locator("#machine-data summary").click()
    page.get_by_text("with the sliders").wait_for()
    keep(page, "what-if")


def ready(page: Page) -> None:
    """Wait until the part is drawn."""
    page.wait_for_selector("body[data-ready=part]")


def drawn_again(page: Page, name: str) -> None:
    """Wait until the part of the job of a name is drawn in the place of another job's.

    The part that is drawn already says nothing: it may be that of the job before.
    """
    is_named = re.compile(f"^{re.escape(name)}$")
    page.locator("#job-name", has_text=is_named).wait_for()
    ready(page)


def keep(page: Page, name: str) -> None:
    """A picture, when the page has come to rest."""
    page.wait_for_timeout(1500)
    page.screenshot(path=IMAGES / f"workbench-{name}.jpg", type="jpeg", quality=QUALITY)


if __name__ == "__main__":
    main()
