"""The page in a real browser where something is wrong, slow, or done twice."""

import io
import json
import re
import shutil

import numpy as np
import pytest
import trimesh
from PIL import Image

from tests.unit.workbench.browser import (
    TABLET,
    WINDOW,
    browser_alone,
    complaint,
    dismiss,
    drop,
    figure,
    needs_browser,
    open_job,
    ready,
    says,
    until,
)
from tests.unit.workbench.conftest import replace
from tests.unit.workbench.test_runs import LAW

pytestmark = needs_browser

WIDER_MM = 30


@pytest.fixture(scope="module", autouse=True)
def jobs(folder):
    """Beside the measured job: one of a wider part, one that is broken, one with an odd name."""
    mesh = trimesh.load(folder / "part.stl")
    mesh.vertices[mesh.vertices[:, 0] < -25, 0] -= WIDER_MM
    mesh.export(folder / "wider.stl")
    text = (folder / "job.toml").read_text()
    wider = text.replace("part.stl", "wider.stl").replace("[-30,", f"[{-30 - WIDER_MM},")
    (folder / "wider.toml").write_text(wider)
    (folder / "broken.toml").write_text(text.replace("diameter_mm = 10", 'diameter_mm = "ten"'))
    shutil.copy(folder / "job.toml", folder / "50% #2?.toml")
    (folder / "no_cad.toml").write_text(re.sub(r"(?m)^nominal.*$", "", text))
    (folder / "bare.toml").write_text(re.sub(r"(?m)^(nominal|measured).*$", "", text))


def answer(page, address, *, status=400, said="it is refused", times=None):
    """Let the server refuse what is asked for at an address; gives what it was sent."""
    sent = []

    def refuse(route):
        sent.append(route.request.post_data_json if route.request.method == "POST" else None)
        route.fulfill(status=status, json={"error": said})

    page.route(address, refuse, **({} if times is None else {"times": times}))
    return sent


def open_readings(page):
    page.locator("#tab-diagnose").click()
    page.locator(".readings").wait_for()
    if not page.get_by_label("Instrument").is_visible():
        page.get_by_text("Further readings").click()
    page.get_by_label("Instrument").wait_for()


# ---- what is written and what is read


def test_a_decimal_comma_is_one_and_two_numbers_are_refused(tab):
    open_readings(tab)
    drop(tab, "#panel-diagnose .drop", "round.csv", "angle_deg,d_um\n0,1\n")
    tab.get_by_label("Instrument").select_option("ballbar")
    take = tab.get_by_role("button", name="Add these readings")
    until(take.is_enabled)
    sent = answer(tab, "**/api/readings")
    fields = {"tool_length_mm": "100,5", "u_um": "0,3 2", "centre_mm": "1,5; 2; -3",
              "radius_mm": "1,500"}  # fmt: skip
    for name, text in fields.items():
        tab.locator(f".readings [name={name}]").fill(text)
    take.click()
    assert "0,3 2" in complaint(tab)
    tab.locator(".readings [name=u_um]").fill("0,3")
    take.click()
    assert "1,500 may be 1500 or 1.5" in complaint(tab) and not sent
    tab.locator(".readings [name=radius_mm]").fill("150")
    take.click()
    assert "it is refused" in complaint(tab)
    tab.unroute("**/api/readings")
    settings = sent[0]["settings"]
    assert (settings["tool_length_mm"], settings["u_um"]) == (100.5, 0.3)
    assert settings["centre_mm"] == [1.5, 2, -3] and settings["radius_mm"] == 150


def test_a_size_of_a_compensation_takes_a_decimal_comma_and_says_what_it_is(tab):
    tab.locator("#tab-compensate").click()
    field = tab.locator("[name=tolerance_um]")
    sent = answer(tab, "**/api/compensate")
    for text, said in (("half", "before rounding, µm: half"), ("", "before rounding, µm: nothing")):
        field.fill(text)
        tab.locator("#compensate").click()
        assert said in complaint(tab)
    field.fill("")
    field.press_sequentially("0,5")
    tab.locator("#compensate").click()
    assert "it is refused" in complaint(tab)
    assert len(sent) == 1 and sent[0]["tolerance_um"] == 0.5 and sent[0]["residual_limit_um"] == 5
    tab.unroute("**/api/compensate")
    field.fill("0.1")


def test_readings_of_the_part_say_what_they_replace_and_draw_no_empty_chart(tab, folder):
    open_readings(tab)
    tab.get_by_label("Instrument").select_option("part")
    says(tab, ".readings", "take the place of points.csv")
    drop(tab, "#panel-diagnose .drop", "again.csv", (folder / "points.csv").read_text())
    says(tab, ".readings", "again.csv")
    tab.get_by_role("button", name="Add these readings").click()
    until(lambda: tab.locator("#job-about").inner_text().startswith("job-2.toml"))
    ready(tab)
    says(tab, ".history", "in place of points.csv")
    assert tab.locator(".history svg").count() == 0
    tab.get_by_role("button", name="Evaluate the models").click()
    tab.locator(".history svg").wait_for()
    open_job(tab, "part/job.toml")


def test_the_choice_names_what_is_seen(tab):
    answer(tab, "**/api/values?quantity=difference*")
    tab.locator("#quantity").select_option("difference")
    assert "it is refused" in complaint(tab)
    until(lambda: tab.locator("#quantity").input_value() == "deviation")
    tab.unroute("**/api/values?quantity=difference*")
    held = []
    tab.route("**/api/values?quantity=difference*", lambda route: held.append(route), times=1)
    tab.locator("#quantity").select_option("difference")
    until(lambda: tab.locator(".stage.old").count() and held)
    for route in held:
        route.continue_()
    tab.locator(".stage:not(.old)").wait_for()
    assert tab.locator("#quantity").input_value() == "difference"


def test_an_uncertainty_begins_at_zero_and_has_no_sign(tab):
    tab.locator("#quantity").select_option("uncertainty")
    until(lambda: not any(c in tab.locator("#ticks").inner_text() for c in "+−"))
    assert tab.locator("#ticks li").last.inner_text() == "0"
    text = tab.locator("#figures").inner_text()
    assert "Beyond" not in text and "+" not in text
    tab.locator("#quantity").select_option("deviation")
    says(tab, "#figures", "Beyond")


def test_angles_have_the_names_of_the_glossary(tab):
    words = " ".join(tab.locator("#quantity option").all_inner_texts())
    assert "yaw of X, about Z" in words and "tilt" not in words


def test_a_job_that_cannot_be_read_shows_nothing_of_the_one_before(tab):
    tab.locator("#tab-diagnose").click()
    says(tab, "#panel-diagnose", "µm RMS")
    tab.locator("#home").click()
    tab.locator(".jobs button", has_text="broken.toml").first.click()
    assert "diameter_mm" in complaint(tab)
    for place in ("#figures", "#diagnose", "#lines-sheet", "#panel-diagnose .lead"):
        assert not tab.locator(place).is_visible(), place
    tab.locator("#tab-propose").click()  # where a law that is the cause can be mended
    assert tab.get_by_label("Python of the effect").is_visible()
    open_job(tab, "part/job.toml")
    assert tab.locator("#figures").is_visible()


def test_colours_of_a_part_without_cad_are_seen_from_afar(tab):
    open_job(tab, "no_cad.toml")
    tab.locator(".options summary").click()
    tab.locator("#marks-on").uncheck()  # their numbers are dark, too
    tab.keyboard.press("Escape")
    tab.locator("#canvas").focus()
    for _ in range(12):
        tab.keyboard.press("-")
    tab.wait_for_timeout(1000)  # the map rests, and is drawn in full
    picture = np.asarray(Image.open(io.BytesIO(tab.locator("#canvas").screenshot())).convert("RGB"))
    middle = picture[tuple(slice(n // 4, 3 * n // 4) for n in picture.shape[:2])].astype(int)
    is_line, is_coloured = middle.max(axis=2) < 70, np.ptp(middle, axis=2) > 40
    assert is_coloured.sum() > 3 * is_line.sum(), (is_coloured.sum(), is_line.sum())
    tab.locator(".options summary").click()
    tab.locator("#marks-on").check()
    tab.keyboard.press("Escape")
    open_job(tab, "part/job.toml")


# ---- names


def test_a_job_with_neither_cad_nor_points_shows_its_blank_and_the_tool(tab):
    open_job(tab, "bare.toml")
    says(tab, "#figures", "neither nominal CAD nor measured points")
    assert "RMS" not in tab.locator("#figures").inner_text()
    assert not tab.locator("#ramp").is_visible()
    tab.locator("#play").click()
    until(lambda: float(tab.locator("#time").input_value()) > 1)
    tab.locator("#play").click()
    says(tab, "#telling", "line ")
    tab.get_by_title("Leave the playback").click()
    tab.locator("#tab-diagnose").click()
    says(tab, "#panel-diagnose", "Nothing was measured for this job")
    assert tab.locator(".notice.error").count() == 0


def test_results_of_a_job_with_an_odd_name_are_found(tab):
    open_job(tab, "50% #2?.toml")
    tab.locator("#report").click()
    with tab.expect_popup() as waiting:
        tab.get_by_role("link", name="Open it").click()
    waiting.value.get_by_text("Predicted deviation").first.wait_for()
    waiting.value.close()
    with tab.expect_download() as waiting:
        tab.get_by_role("link", name="download").click()
    assert waiting.value.suggested_filename.endswith("-screen.html")
    dismiss(tab)
    open_job(tab, "part/job.toml")


def test_jobs_of_like_names_are_told_apart(tab):
    def likes(route):
        found = route.fetch().json()
        route.fulfill(json=found | {"recent": ["/a/x/part/job.toml", "/b/y/part/job.toml"]})

    tab.route("**/api/start", likes)
    tab.locator("#home").click()
    tab.locator(".jobs b", has_text="x/part/job.toml").wait_for()
    assert tab.locator(".jobs b", has_text="y/part/job.toml").count() == 1
    tab.unroute("**/api/start")
    tab.get_by_role("button", name="Back to the open job").click()


def test_escape_closes_the_sheet_of_the_view(tab):
    tab.locator(".options summary").click()
    tab.locator("#tolerance").focus()
    tab.keyboard.press("Escape")
    until(lambda: not tab.locator("#tolerance").is_visible())


# ---- twice, slow, gone


def test_a_second_click_does_nothing(tab):
    asked = []
    tab.on("request", lambda request: asked.append(request.url.split("/")[-1]))
    tab.locator("#play").dblclick()
    until(lambda: float(tab.locator("#time").input_value()) > 0)
    assert asked.count("playback") == 1
    tab.get_by_title("Leave the playback").click()
    tab.locator("#tab-diagnose").click()
    tab.locator("#diagnose").dblclick()
    tab.locator("#run .stop").click()
    tab.locator("#run").wait_for(state="hidden")
    assert asked.count("diagnose") == 1 and tab.locator(".notice.error").count() == 0


def test_work_that_would_end_is_asked_for(tab):
    sent = answer(tab, "**/api/open", status=409, said="diagnose is at work", times=1)
    tab.locator("#home").click()
    tab.locator(".jobs button", has_text="part/job.toml").first.click()
    with tab.expect_request("**/api/open") as waiting:
        tab.get_by_role("button", name="End it and open the job").click()
    assert sent[0]["ends_work"] is False and waiting.value.post_data_json["ends_work"] is True
    until(lambda: tab.locator("#notices").inner_text() == "")
    ready(tab)


def test_lines_that_did_not_come_are_asked_for_again(tab):
    answer(tab, "**/api/program*", times=1)
    tab.reload()
    ready(tab)
    says(tab, "#lines", "G21 G17")
    until(lambda: tab.locator(".notice.error").count() == 0)


def test_the_seventh_tab_works_as_the_first(tab, context):
    more = [context.new_page() for _ in range(6)]
    for page in more:
        page.goto(tab.url, wait_until="commit")
    says(more[-1], "#job-about", "job.toml")
    for page in more:
        page.close()


def test_a_tab_of_a_workbench_that_ended_says_so_and_an_absent_one_is_offered_its_job(tab, context):
    state = context.request.get(tab.url + "api/state", headers={"x-vmach": "1"}).json()
    made = {"number": 9, "kind": "add", "state": "done", "command": "vmach add", "share": None,
            "result": {"job": "/x/job-9.toml", "is_opened": False}}  # fmt: skip
    told = [("hello", state), ("run", made)]
    body = "".join(f"event: {kind}\ndata: {json.dumps(what)}\n\n" for kind, what in told)
    answers = [lambda route: route.fulfill(content_type="text/event-stream",
                                           body="retry: 100\n" + body)]  # fmt: skip
    with browser_alone(context, TABLET) as alone:
        page = alone.new_page()
        page.route("**/api/events", lambda route: answers[-1](route))
        page.goto(tab.url)
        says(page, "#notices", "job-9.toml is written")
        answer(page, "**/api/state", status=403)
        answers.append(lambda route: route.fulfill(status=403))
        page.get_by_text("The workbench has ended").wait_for()


# ---- what cannot be read


def test_a_job_that_cannot_be_read_is_not_compared_with(tab):
    tab.locator("#tab-compare").click()
    choice = tab.get_by_label("Job to compare with")
    choice.select_option(label="part/broken.toml")
    assert "diameter_mm" in complaint(tab)
    tab.locator("#other-view").wait_for(state="hidden")
    until(lambda: choice.input_value() == "")


def test_the_difference_ends_where_the_other_part_is_not_the_same(tab, folder):
    """What was seen stayed, under the name of the other job."""
    open_job(tab, "part/job.toml")
    tab.locator("#quantity").select_option("deviation")
    says(tab, "#figures", "Beyond")
    mine = figure(tab, "RMS")
    tab.locator("#tab-compare").click()
    choose = tab.get_by_label("Job to compare with")
    choose.select_option(str(folder / "odd.toml"))
    tab.get_by_label("show the difference").check()
    until(lambda: figure(tab, "RMS") != mine)
    choose.select_option(str(folder / "wider.toml"))
    says(tab, "#panel-compare", "no difference to show")
    until(lambda: figure(tab, "RMS") == mine)
    assert tab.locator("#caption").inner_text() == "part"
    assert tab.locator("#other-view").is_visible()
    choose.select_option(str(folder / "odd.toml"))
    tab.get_by_label("show the difference").wait_for()
    assert not tab.get_by_label("show the difference").is_checked()
    choose.select_option(label="nothing")
    tab.locator("#other-view").wait_for(state="hidden")


def test_sliders_have_names_and_say_what_they_are_set_to(tab):
    tab.locator(".options summary").click()
    for name, place in {"Tolerance": "#tolerance", "End of the scale": "#range"}.items():
        slider = tab.get_by_role("slider", name=name)
        assert slider.get_attribute("id") == place[1:]
        assert "µm" in slider.get_attribute("aria-valuetext")
    tab.keyboard.press("Escape")


def test_a_phone_has_a_few_lines_of_the_program_at_a_time(tab, context):
    """All lines in the page at once, as it was, are too much of a long program."""
    with browser_alone(context, {"width": 500, "height": 900}) as phone:
        page = phone.new_page()
        page.goto(tab.url)
        ready(page)
        assert page.locator("#lines").bounding_box()["height"] == pytest.approx(220, abs=1)


def test_the_section_lies_in_the_part_that_is_open(tab):
    views = []
    tab.on("request", lambda request: request.url.endswith("/api/report")
           and views.append(request.post_data_json["view"]))  # fmt: skip
    tab.locator(".options summary").click()
    tab.locator("#section").select_option("0")
    tab.keyboard.press("Escape")
    for name in ("part/job.toml", "part/wider.toml"):
        open_job(tab, name)
        tab.locator("#report").click()
        tab.get_by_text("The report of what is on the screen is made").wait_for()
        dismiss(tab)
    places = [view["section"][3] for view in views]
    assert places[1] - places[0] == pytest.approx(-WIDER_MM / 2, abs=0.1)
    tab.locator(".options summary").click()
    tab.locator("#section").select_option("")
    tab.keyboard.press("Escape")


def test_measurements_that_cannot_be_read_are_no_result(tab, folder):
    open_job(tab, "part/job.toml")
    tab.locator("#tab-diagnose").click()
    says(tab, "#panel-diagnose", "µm RMS")
    good = (folder / "points.csv").read_text()
    replace(folder / "points.csv", good.replace("mx,my,mz", "mx,my,mx"))
    says(tab, "#panel-diagnose .trouble", "points.csv")
    assert "µm RMS" not in tab.locator("#panel-diagnose").inner_text()
    replace(folder / "points.csv", good)
    says(tab, "#panel-diagnose", "µm RMS")
    assert tab.locator(".notice.error").count() == 0  # nothing is wrong any more


def test_trouble_goes_with_its_cause(tab, folder):
    program = folder / "part.nc"
    good = program.read_text()
    replace(program, good.replace("G1 Z-8", "G1 Z#"))
    tab.locator(".notice.error").wait_for()
    replace(program, good)
    ready(tab)
    until(lambda: tab.locator(".notice.error").count() == 0)


def test_without_webgl_there_are_figures_and_words(tab, context):
    with browser_alone(context, WINDOW) as alone:
        page = alone.new_page()
        page.add_init_script("HTMLCanvasElement.prototype.getContext = () => null")
        page.goto(tab.url)
        ready(page)
        says(page, "#veil", "WebGL 2 is not available")
        says(page, "#figures", "RMS")
        for button in ("#report", "#play"):
            page.locator(button).click()
            assert "not drawn" in complaint(page)
        page.locator('#lines .line[data-line="9"]').click()
        says(page, "#line-foot", "Line 9")
        page.locator("#tab-diagnose").click()
        says(page, "#panel-diagnose", "µm RMS")
        page.locator(".options summary").click()
        page.locator("#grey").check()
        page.locator("#section").select_option("1")
        assert page.locator(".notice.error").count() == 0


# ---- in rounds


def test_all_is_added_in_rounds_with_a_step_back(tab, folder):
    open_job(tab, "part/job.toml")
    tab.locator("#tab-diagnose").click()
    tab.locator("#diagnose").click()
    tab.locator("#rounds").click()
    says(tab, "#undo", "+ backlash Y")
    ready(tab)
    says(tab, "#panel-diagnose .verdict", "nothing is missing")
    says(tab, "#panel-diagnose", "diagnose job.toml --add-all --out")
    assert tab.locator("#rounds").count() == 0  # nothing is left to add
    (made,) = (p for p in folder.glob("job-*.toml") if 'added = ["backlash Y"]' in p.read_text())
    assert tab.locator("#job-about").inner_text().startswith(made.name)
    tab.locator("#undo").click()
    until(lambda: tab.locator("#job-about").inner_text().startswith("job.toml"))
    ready(tab)
    tab.locator("#rounds").wait_for()  # the verdict of the first job, as it was
    assert made.is_file()  # no file goes away


def test_figures_of_the_job_before_are_not_shown_while_another_one_is_read(tab):
    open_job(tab, "part/job.toml")
    held, is_held = [], [True]
    tab.route("**/api/about", lambda route: held.append(route) if is_held[0] else route.continue_())
    tab.locator("#home").click()
    tab.locator(".jobs button", has_text="wider.toml").first.click()
    says(tab, "#job-about", "wider.toml")
    tab.locator("#veil").wait_for()
    assert not tab.locator("#figures").is_visible()
    is_held[0] = False
    for route in held:
        route.continue_()
    ready(tab)
    tab.unroute("**/api/about")
    assert tab.locator("#figures").is_visible()


# ---- what was written stays


def test_a_slider_that_is_moved_while_the_effects_come_stays(tab, folder):
    """The effects come after the part is drawn; a slider of before may be moved already."""
    open_job(tab, "part/job.toml")
    tab.locator("#tab-what-if").click()
    tab.get_by_label("Find an effect").fill("backlash y")
    slider = tab.get_by_label("backlash Y reversal")
    slider.wait_for()
    late, asked = [], []
    tab.route("**/api/effects", lambda route: late.append(route))
    tab.route("**/api/what-if", lambda route: asked.append(route))
    replace(folder / "job.toml", (folder / "job.toml").read_text() + "\n")
    until(lambda: tab.wait_for_timeout(20) or late)
    slider.fill("150")
    until(lambda: tab.wait_for_timeout(20) or asked)
    with tab.expect_response("**/api/effects"):
        late.pop().continue_()
    tab.wait_for_timeout(200)  # the page has drawn them
    asked.pop().continue_()
    says(tab, "#what-if-residual", "with the sliders")
    assert tab.locator(".tag.moved").inner_text() == "moved Y"
    tab.unroute("**/api/what-if")
    tab.unroute("**/api/effects")
    tab.get_by_role("button", name="Reset").click()
    tab.get_by_label("Find an effect").fill("")


def test_the_text_of_a_law_outlives_a_reload(tab):
    tab.locator("#tab-propose").click()
    tab.get_by_label("Python of the effect").fill("# half a law")
    tab.reload()
    ready(tab)
    assert tab.get_by_label("Python of the effect").input_value() == "# half a law"


def test_a_law_that_failed_is_undone_with_its_message_and_dropped(tab):
    tab.locator("#tab-propose").click()
    text, save = tab.get_by_label("Python of the effect"), tab.get_by_role("button", name="Save an")
    tab.get_by_label("File of the effect").fill("lean_y.py")
    text.fill(LAW)
    save.click()
    says(tab, ".loose", "lean_y.py")  # known to every command, and not added
    text.fill("x = (\n")
    save.click()
    tab.locator("#panel-propose .trouble").wait_for()
    tab.locator(".notice.error", has_text="lean_y.py").first.wait_for()
    says(tab, "#undo", "text of lean_y.py")
    tab.locator("#undo").click()
    tab.locator("#panel-propose .trouble").wait_for(state="detached")
    until(lambda: not tab.locator(".notice.error").count())
    until(lambda: text.input_value() == LAW)
    ready(tab)
    tab.locator(".loose button", has_text="Drop").click()
    tab.locator(".loose").wait_for(state="detached")
    says(tab, "#undo", "drop of lean_y.py")
    ready(tab)


def test_a_new_job_that_is_refused_keeps_its_form(tab, folder):
    tab.locator("#home").click()
    tab.get_by_text("A new job").click()
    form = tab.locator("form.new-job")
    for name, value in {"program": "part.nc", "machine": "machine.toml"}.items():
        form.locator(f"select[name={name}]").select_option(value)
    form.locator("[name=name]").fill("Prüfling 1")
    form.get_by_placeholder("X, Y, Z").first.fill("-200, -150, -200")
    form.locator("[name=diameter_mm]").fill("63,5 mm")
    form.locator("[name=length_mm]").fill("100,5")
    write = form.get_by_role("button", name="Write the job")
    write.click()
    assert "63,5 mm" in complaint(tab)
    form.locator("[name=diameter_mm]").fill("63,5")
    with tab.expect_request("**/api/new-job") as waiting:
        write.click()
    assert "Prufling-1" in complaint(tab)
    tool = waiting.value.post_data_json["tools"][0]
    assert (tool["diameter_mm"], tool["length_mm"]) == (63.5, 100.5)
    form.locator("[name=name]").fill("mine")
    form.get_by_placeholder("X, Y, Z").nth(1).fill("-30, -25, -20")
    write.click()
    assert "max_mm is missing" in complaint(tab) and not (folder / "mine.toml").exists()
    tab.get_by_role("button", name="Back to the open job").click()
    tab.locator("#home").click()
    until(lambda: form.locator("[name=name]").input_value() == "mine")


def test_a_form_stays_while_the_open_job_is_read_anew(tab, folder):
    before = (folder / "job.toml").read_text()
    tab.locator("#home").click()
    tab.locator("#start details.new").wait_for()
    name = tab.locator("form.new-job [name=name]")
    if not name.is_visible():  # it stays open over other tests
        tab.get_by_text("A new job").click()
    name.fill("half written")
    with tab.expect_response("**/api/about"):
        (folder / "job.toml").write_text(before + "# saved again\n")
    ready(tab)
    assert name.is_visible() and name.input_value() == "half written"
    with tab.expect_response("**/api/about"):
        (folder / "job.toml").write_text(before)
    ready(tab)
    tab.locator("#start .jobs button", has_text="job.toml").first.click()  # it is open already
    tab.locator("#bench").wait_for()
    assert not tab.locator("#start").is_visible()
