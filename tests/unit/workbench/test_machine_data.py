"""Machine data in What if, against predictions of machines that are written as files."""

import numpy as np
import pytest

from tests.measured_job import ERRORS
from tests.small_job import write_job_with_nominal
from vmach.api.points import predict, surface_points
from vmach.machine import Variant
from vmach.workbench.model.machine_changes import HANDLES, machine_cards
from vmach.workbench.model.part_model import load_part
from vmach.workbench.model.what_if import changed_mm, read_changes

RANGES = {"X": (-400.0, 0.0), "Y": (-300.0, 0.0)}
OFFSET = [3.0 * np.sin(0.9 * k) for k in range(HANDLES)]


@pytest.fixture(scope="module")
def part(measured_folder):
    return load_part(measured_folder / "job.toml")


def changed(part, wanted):
    changes = read_changes([wanted], part.job, part.effects)
    return 1e3 * changed_mm(part.surface, changes), changes


def predicted(folder, part, errors):
    """What the files of another machine make of the same points."""
    job = write_job_with_nominal(folder, errors)
    points = surface_points(part.surface.point_mm, part.surface.normal)
    return predict(job, points)


def drawn(name):
    """A drawn table, straight between its places, as a function of the position."""
    places = np.linspace(*RANGES[name[2]], HANDLES)
    return lambda position: np.interp(position, places, OFFSET)


def with_drawn(name):
    """The errors of the machine, with a drawn table added to one of them."""
    old, place = ERRORS.get(name, (lambda position: 0.0, (0.0, 0.0, 0.0)))
    place = None if name[1] in "ABC" else place
    return ERRORS | {name: (lambda position: old(position) + drawn(name)(position), place)}


def same_move(part, before, after):
    """Rows that the same move makes before and after: first order says no more."""
    same = after.is_cut & (after.line == before.line)
    return same & (after.line == part.surface.states.line)


@pytest.mark.parametrize("name", ["EXX", "ECX", "EZY", "EAX"])
def test_a_table_drawn_by_hand_does_what_a_file_would_do(part, measured_folder, tmp_path, name):
    points = surface_points(part.surface.point_mm, part.surface.normal)
    before = predict(measured_folder / "job.toml", points)
    after = predicted(tmp_path, part, with_drawn(name))
    found, changes = changed(part, {"component": name, "offset": OFFSET})
    same, wanted = same_move(part, before, after), after.deviation_um - before.deviation_um
    if name[1] in "ABC":  # a tilted tool cuts the floor with another side of its edge
        same &= np.abs(part.surface.normal[:, 2]) < 0.5
    # the file has rows every 10 mm, between which the bends of what was drawn are cut off
    assert same.mean() > 0.4 and np.abs(wanted[same]).max() > 0.1
    assert np.quantile(np.abs(found - wanted)[same], 0.9) < 0.02 * np.abs(wanted[same]).max() + 0.02
    anew = 1e3 * part.cut_anew([], changes[0].now)
    off = np.abs(anew - after.deviation_um)[after.is_cut]
    assert np.quantile(off, 0.95) < 0.02 * np.abs(wanted[same]).max() + 0.02


def test_a_reflector_that_stood_elsewhere(part, measured_folder, tmp_path):
    place = [10.0, 700.0, -120.0]
    points = surface_points(part.surface.point_mm, part.surface.normal)
    before = predict(measured_folder / "job.toml", points)
    after = predicted(tmp_path, part, ERRORS | {"EXX": (ERRORS["EXX"][0], place)})
    found, _ = changed(part, {"component": "EXX", "measured_at_mm": place})
    wanted = after.deviation_um - before.deviation_um
    same = same_move(part, before, after)
    assert np.abs(wanted[same]).max() > 0.3
    assert np.quantile(np.abs(found - wanted)[same], 0.9) < 0.01


def test_the_program_alone_knows_no_machine(part):
    changes = read_changes([{"component": "EXX", "offset": OFFSET}], part.job, part.effects)
    assert not changed_mm(part.surface, changes, Variant.NONE).any()


def test_cards_show_the_tables_of_the_machine(part):
    cards = {card["name"]: card for card in machine_cards(part.job.machine)}
    assert len(cards) == 18
    exx = cards["EXX"]
    curve, place = ERRORS["EXX"]
    at = np.array(exx["position_mm"])
    step_um = 2.0 / 30.0**2 * 10.0**2 / 8.0  # straight between rows of a sine every 10 mm
    assert exx["value"] == pytest.approx([curve(x) for x in at], abs=step_um)
    assert exx["measured_at_mm"] == list(place) and exx["unit"] == "um"
    assert not cards["EZZ"]["has_table"] and cards["EZZ"]["value"] == [0.0] * HANDLES
    assert cards["EBX"]["unit"] == "urad"


WRONG = [
    {"component": "EQX", "offset": OFFSET},
    {"component": "EXX", "offset": OFFSET[:-1]},
    {"component": "EXX", "offset": [None] * HANDLES},
    {"component": "EXX", "measured_at_mm": [1, 2]},
    {"component": ["EXX"], "offset": OFFSET},
]


@pytest.mark.parametrize("wrong", WRONG, ids=range(len(WRONG)))
def test_what_is_no_machine_data_is_refused(page, wrong):
    answer = page.post("/api/what-if", {"changes": [wrong], "shown": {}})
    assert answer.status_code == 400 and "accepted" in answer.json()["error"]


def test_a_drawn_table_is_shown_at_once_and_leaves_the_job_alone(page, measured_folder):
    before = (measured_folder / "machine.toml").read_bytes()
    change = {"component": "EXX", "offset": OFFSET}
    asked = {"changes": [change], "shown": {"quantity": "change"}}
    figures, _ = page.framed(page.post("/api/what-if", asked))
    assert figures["rms_um"] > 0.3
    figures, _ = page.framed(page.get("/api/exact"))
    assert figures["rms_um"] > 0.3
    page.framed(page.post("/api/what-if", {"changes": [], "shown": {}}))
    assert (measured_folder / "machine.toml").read_bytes() == before
