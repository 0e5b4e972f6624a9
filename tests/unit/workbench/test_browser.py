"""The page in a real browser: the whole loop, by keyboard too; nothing in the console.

One server and one page serve all tests, in the order in which somebody would work; the jobs are
small.
"""

import contextlib
import json
import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tests.unit.workbench.browser import (
    PATIENCE_MS,
    REFUSED,
    TABLET,
    browser_alone,
    children_of,
    complaint,
    dismiss,
    drop,
    figure,
    needs_browser,
    open_job,
    press_tab,
    press_to,
    ready,
    says,
    until,
    workers_of,
)
from tests.unit.workbench.conftest import replace
from vmach.diagnosis.words import rounded

pytestmark = needs_browser


# ---- look


def test_the_part_is_there_and_the_token_is_not_in_the_address(tab):
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


def test_the_keyboard_alone(tab):
    tab.locator("#tab-look").focus()
    for name in ("what-if", "diagnose", "propose", "compensate"):
        tab.keyboard.press("ArrowRight")
        tab.locator(f"#panel-{name}").wait_for()
    tab.locator("#canvas").focus()
    before = tab.locator("#triad").inner_html()
    tab.keyboard.press("ArrowLeft")
    until(lambda: tab.locator("#triad").inner_html() != before)
    tab.locator("#lines").focus()
    tab.keyboard.press("ArrowDown")
    tab.locator(".line.selected").wait_for()


def test_it_plays_with_warmth_and_knows_of_no_collision(tab):
    tab.locator("#play").click()
    until(lambda: float(tab.locator("#time").input_value()) > 1)
    tab.locator("#play").click()
    assert re.search(r"line \d+ · T1 · X", tab.locator("#telling").inner_text())
    assert re.search(r"S 6000 1/min\s*Spindle [\d.]+ %\s*X [\d.]+ %",
                     tab.locator("#states").inner_text())  # fmt: skip
    says(tab, "#hits", "No collision")
    tab.get_by_title("Leave the playback").click()
    tab.locator("#states").wait_for(state="hidden")


# ---- what if


def test_a_slider_moves_the_colours_and_undo_brings_them_back(tab):
    tab.locator("#quantity").select_option("residual")
    says(tab, "#figures", "Measured")
    before = figure(tab, "RMS")
    tab.locator("#tab-what-if").click()
    tab.get_by_label("Find an effect").fill("backlash y")
    slider = tab.get_by_label("backlash Y reversal")
    slider.focus()
    tab.keyboard.press("PageUp")
    says(tab, "#what-if-residual", "µm")
    until(lambda: abs(figure(tab, "RMS") - before) > 0.05)
    tab.keyboard.press("Control+z")
    until(lambda: abs(figure(tab, "RMS") - before) < 0.011)
    says(tab, "#redo", "Redo")
    tab.locator("#redo").click()
    until(lambda: abs(figure(tab, "RMS") - before) > 0.05)
    tab.get_by_role("button", name="Reset").click()
    until(lambda: abs(figure(tab, "RMS") - before) < 0.011)


def test_a_table_is_drawn_by_hand(tab):
    tab.locator("#quantity").select_option("change")
    until(lambda: figure(tab, "RMS") == 0.0)
    tab.locator("#machine-data summary").click()
    box = tab.locator("#drawn").bounding_box()
    tab.mouse.move(box["x"] + 0.3 * box["width"], box["y"] + 0.85 * box["height"])
    tab.mouse.down()
    tab.mouse.move(box["x"] + 0.8 * box["width"], box["y"] + 0.05 * box["height"], steps=4)
    tab.mouse.up()
    until(lambda: figure(tab, "RMS") > 0.2)
    says(tab, "#undo", "EXX")
    tab.get_by_label("EXX Y of the reflector").focus()
    tab.keyboard.press("PageUp")
    tab.get_by_role("button", name="As it was").click()
    until(lambda: figure(tab, "RMS") == 0.0)


# ---- ask, add, go back


def test_the_loop_by_keys_alone(tab, folder):
    """Open, diagnose, add, see the held-out error, undo: where the pointer clicks, Enter does."""
    press_to(tab, "#home")
    tab.keyboard.press("Enter")
    tab.locator(".jobs button", has_text="part/job.toml").first.wait_for()
    press_to(tab, ".jobs button:has-text('part/job.toml')")
    tab.keyboard.press("Enter")
    tab.locator("#bench").wait_for()
    ready(tab)
    press_tab(tab, "diagnose")
    press_to(tab, "#diagnose")
    tab.keyboard.press("Enter")
    tab.locator(".card .primary", has_text="Add").first.wait_for()
    agrees_with_the_command(tab, folder / "vmach-results" / "job" / "diagnosis" / "diagnosis.json")
    press_to(tab, ".card .primary:has-text('Add')")
    tab.keyboard.press("Enter")
    tab.wait_for_selector(".mark-held")
    ready(tab)
    assert (folder / "job-2.toml").is_file()
    fitted, held = (
        [float(t.split(":")[1].split()[0])
         for t in tab.locator(f".mark-{kind} title").all_text_contents()]
        for kind in ("fitted", "held")
    )  # fmt: skip
    assert fitted[1] < 0.5 * fitted[0] and held[1] < 0.7 * held[0]
    tab.keyboard.press("Control+z")
    until(lambda: tab.locator("#job-about").inner_text().startswith("job.toml"))
    ready(tab)
    assert (folder / "job-2.toml").is_file()  # no file goes away
    tab.keyboard.press("Control+z")  # the verdict, too
    tab.locator(".card .primary", has_text="Add").first.wait_for(state="detached")
    tab.keyboard.press("Control+y")
    tab.locator(".card .primary", has_text="Add").first.wait_for()


def test_the_error_on_another_part_is_watched(tab, folder):
    """The file beside is another measured part of the machine, which nothing is fitted to."""
    open_job(tab, "part/job-2.toml")
    tab.locator("#tab-diagnose").click()
    tab.get_by_label("Another part").select_option(label="part/odd.toml")
    tab.wait_for_selector(".mark-other")
    said = tab.locator(".mark-other title").all_text_contents()
    words = ["history", "job-2.toml", "--check-job", "odd.toml", "--json", "--picture", "h.png"]
    told = subprocess.run([sys.executable, "-P", "-m", "vmach", *words], cwd=folder,
                          capture_output=True, text=True, check=True)  # fmt: skip
    steps = json.loads(told.stdout)
    assert said == [f"other part: {step['check_rms_um']:.2f} µm" for step in steps]
    tab.get_by_label("Another part").select_option(label="none")
    tab.locator(".mark-other").first.wait_for(state="detached")
    open_job(tab, "part/job.toml")


def agrees_with_the_command(tab, figures):
    """The cards have the digits and the words of what the command prints."""
    found = json.loads(figures.read_text())
    cards = tab.locator("#panel-diagnose .card").all_inner_texts()
    for one, card in zip(found["effects"], cards, strict=False):
        assert f"{one['size_um']:.2f} µm RMS of these readings" in card
        assert f"(log odds {one['log_odds']:.0f})" in card and one["title"] in card
        for name, value in one["parameters"].items():
            said, low, high = (
                text.replace("-", "−") for text in rounded(value, one["interval_95"][name])
            )
            assert said in card and f"{low} to {high} (95 %)" in card
    assert "noise and the tables' uncertainty" in tab.locator("#panel-diagnose").inner_text()


def test_loaded_anew_it_shows_the_same(tab):
    tab.reload()
    ready(tab)
    tab.locator("#tab-diagnose").click()
    tab.locator(".card .primary", has_text="Add").first.wait_for()
    says(tab, ".steps", "+ backlash Y")


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


# ---- compensate, compare, report


def test_it_compensates_and_hands_the_program_out(tab, folder):
    press_tab(tab, "compensate")
    press_to(tab, "#compensate")
    tab.keyboard.press("Enter")
    tab.get_by_text("Download the program").wait_for()
    row = tab.locator("#panel-compensate tr", has_text="Tool off its path, largest")
    before, after = (float(t.split()[0]) for t in row.locator(".value").all_inner_texts())
    assert after < 0.8 * before
    tab.locator(".hunk .new").first.wait_for()
    press_to(tab, "a:has-text('Download the program')")
    with tab.expect_download() as waiting:
        tab.keyboard.press("Enter")
    written = folder / "vmach-results" / "job-2" / "compensated.nc"
    assert waiting.value.path().read_bytes() == written.read_bytes()
    assert waiting.value.suggested_filename == "job-2-compensated.nc"


def test_two_jobs_turn_together_and_their_difference_is_shown(tab):
    tab.locator("#tab-compare").click()
    tab.get_by_label("Job to compare with").select_option(label="part/odd.toml")
    box = tab.get_by_label("show the difference")
    box.wait_for()  # the parts are the same
    mine = figure(tab, "RMS")
    box.check()
    until(lambda: figure(tab, "RMS") != mine)
    says(tab, "#caption", "job-2 − odd")
    tab.locator("#other-view").wait_for(state="hidden")  # the difference stands alone
    box.uncheck()
    until(lambda: figure(tab, "RMS") == mine)
    before = tab.locator("#other-canvas").screenshot()
    tab.locator("#canvas").focus()
    tab.keyboard.press("ArrowLeft")
    until(lambda: tab.locator("#other-canvas").screenshot() != before)
    tab.get_by_label("Job to compare with").select_option(label="nothing")
    tab.locator("#other-view").wait_for(state="hidden")


def test_the_report_is_of_what_is_on_the_screen(tab, folder):
    before = figure(tab, "RMS")
    tab.locator("#quantity").select_option("difference")
    until(lambda: figure(tab, "RMS") != before)
    rms = figure(tab, "RMS")
    tab.locator("#report").click()
    with tab.expect_popup() as waiting:
        tab.get_by_role("link", name="Open it").click()
    report = waiting.value
    report.get_by_text("Abbe − HTM").first.wait_for()
    said = report.locator(".figures dd").first.inner_text()
    assert float(said.split()[0]) == pytest.approx(rms, abs=0.0051)
    report.locator("#stage").wait_for()  # its map turns
    report.close()
    page = (folder / "vmach-results" / "job-2" / "screen.html").read_text()
    assert "http://" not in page.replace("http://www.w3.org", "") and "data:image/jpeg" in page
    dismiss(tab)
    tab.locator("#quantity").select_option("deviation")


# ---- where the catalogue ends


def test_it_proposes_a_form_and_writes_it_as_an_effect(tab, folder):
    open_job(tab, "odd.toml")
    tab.locator("#tab-diagnose").click()
    tab.locator("#diagnose").click()
    tab.get_by_role("button", name="Diagnose again").wait_for()
    tab.locator("#tab-propose").click()
    tab.get_by_role("button", name="Write it as an effect").first.click()
    until(lambda: "proposed_1.py" in tab.get_by_label("File of the effect").input_value())
    assert "class" in tab.get_by_label("Python of the effect").input_value()
    assert (folder / "proposed_1.py").is_file()


def test_what_to_measure_next_has_a_program_and_a_place_for_its_readings(tab, context, folder):
    # what a diagnosis asks for changes with its rules: the page is told of one that asks
    answer = context.request.get(tab.url + "api/state", headers={"x-vmach": "1"})
    state = answer.json()
    place = Path("vmach-results") / "odd" / "diagnosis" / "next.nc"
    (folder / place).write_text("G0 X0\nM30\n")
    asked = {"text": "ballbar in XY, radius 120 mm", "separates": [], "program": str(place)}
    state["shown"]["diagnosis"] |= {"next_measurement": asked, "program": str(place)}
    hello = f"retry: 600000\nevent: hello\ndata: {json.dumps(state)}\n\n"
    with browser_alone(context, TABLET) as alone:
        other = alone.new_page()  # the message that nobody answers covers no button there
        other.route("**/api/events", lambda route: route.fulfill(
            content_type="text/event-stream", body=hello))  # fmt: skip
        other.route("**/api/state", lambda route: route.fulfill(json=state))
        other.goto(tab.url)
        ready(other)
        says(other, "#notices", "does not answer")
        other.locator("#tab-diagnose").click()
        with other.expect_download() as waiting:
            other.get_by_text("Download its NC program").click()
        assert waiting.value.path().read_text() == "G0 X0\nM30\n"
        until(lambda: other.get_by_label("Instrument").input_value() == "ballbar")
        assert other.locator(".readings [name=tool_length_mm]").is_visible()


def test_a_broken_law_is_said_with_its_line(tab):
    tab.get_by_label("File of the effect").fill("broken_law.py")
    tab.get_by_label("Python of the effect").fill("import vmach\nx = (\n")
    tab.get_by_role("button", name="Save and check").click()
    tab.locator("#panel-propose .trouble").wait_for()
    assert "broken_law.py" in tab.locator("#panel-propose .trouble").inner_text()
    assert "broken_law.py" in complaint(tab)


def test_a_broken_file_that_is_dropped_is_said_and_harms_nothing(tab, folder):
    before = sorted(path.name for path in folder.glob("*.toml"))
    tab.locator("#tab-diagnose").click()
    tab.locator(".readings").wait_for()
    if not tab.get_by_label("Instrument").is_visible():  # open at once where the verdict asks
        tab.get_by_text("Further readings").click()
    tab.get_by_label("Instrument").wait_for()
    drop(tab, "#panel-diagnose .drop", "broken.csv", "radius;1\n\x00\n")
    tab.get_by_label("Instrument").select_option("part")
    take = tab.get_by_role("button", name="Add these readings")
    until(take.is_enabled)
    take.click()
    assert "broken.csv" in complaint(tab)
    assert sorted(path.name for path in folder.glob("*.toml")) == before
    says(tab, "#job-about", "odd.toml")


# ---- what goes wrong


def test_a_run_is_stopped_and_leaves_nothing(tab, served):
    _, folder, process = served
    found = []
    while not found:  # held still before it can end; where it was too fast, once more
        until(lambda: not tab.locator("#run").is_visible())
        tab.locator("#machine").click()
        until(
            lambda: (
                children_of(process.pid, "\0run\0") or tab.get_by_text("its report made").count()
            )
        )
        for pid in children_of(process.pid, "\0run\0"):
            os.kill(pid, signal.SIGSTOP)
            found.append(pid)
    tab.locator("#run .stop").click()
    tab.locator("#run").wait_for(state="hidden")
    for pid in found:
        with contextlib.suppress(ProcessLookupError):  # on a busy machine it was killed meanwhile
            os.kill(pid, signal.SIGCONT)
    until(lambda: not children_of(process.pid, "\0run\0"))
    assert not list((folder / "vmach-results" / "odd").glob("run*"))


def test_a_killed_worker_is_replaced_and_nothing_is_lost(tab, served):
    (worker,) = workers_of(served[2])
    os.kill(worker, signal.SIGKILL)
    until(lambda: workers_of(served[2]) != [worker])
    tab.locator("#quantity").select_option("measured")
    says(tab, "#figures", "Measured")
    ready(tab)
    assert tab.locator(".notice.error").count() == 0
    says(tab, "#job-about", "odd.toml")


def test_a_broken_job_is_said_and_harms_nothing(tab, folder):
    job = folder / "odd.toml"
    good = job.read_text()
    replace(job, good + "\n[oops\n")
    assert "odd.toml" in complaint(tab)
    tab.get_by_role("button", name="Read it again").wait_for()
    replace(job, good)
    ready(tab)


def test_the_console_is_silent_and_nobody_else_is_asked(tab, heard, served):
    assert [text for text in heard["console"] if not text.startswith(REFUSED)] == []
    assert heard["hosts"] == {served[0].split("/")[2]}


def test_it_closes_when_it_is_told_to_and_nothing_breaks(tab, heard, served):
    tab.locator("#shut-down").click()
    tab.get_by_text("The workbench is closed").wait_for()
    tab.wait_for_timeout(500)  # maps and lists learn that they have no size any more
    assert not tab.locator("#bench").is_visible()
    assert [text for text in heard["console"] if "Cannot read" in text] == []
    assert served[2].wait(PATIENCE_MS / 1000) == 0
