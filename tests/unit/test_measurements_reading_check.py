"""Files that no instrument wrote are refused or asked about, with file, line, value, accepted."""

import re

import numpy as np
import pytest

from tests.small_job import measurement, write_job
from vmach.errors import InputError
from vmach.instruments import read_instruments
from vmach.job import read_job

AXIS = measurement("laser", file="test.csv", axis="X", at_mm=[0, -100, -50])
DIAGONAL = measurement(
    "diagonal", file="test.csv", from_mm=[-350, -50, -250], to_mm=[-50, -250, -50]
)
BALLBAR = measurement("ballbar", file="test.csv", centre_mm=[-200, -150, -100], radius_mm=100)
DRIFT = measurement("drift", file="test.csv", at_mm=[-200, -150, -100])
TIP = measurement("tip", file="test.csv", frame="offset")


def rows_of(header, rows):
    return "\n".join([header, *(",".join(map(str, row)) for row in rows)])


def laser(change=lambda row: row, header="run,position_mm,approach,t_s,deviation_um"):
    places = np.linspace(-390.0, -10.0, 12)
    rows = [
        [k // 12 + 1, f"{x:.3f}", 1 if k < 12 else -1, 5.0 * k, 0.1 * (k % 3)]
        for k, x in enumerate([*places, *places[::-1]])
    ]
    return rows_of(header, [change(row) for row in rows])


def diagonal(change=lambda row: row):
    way = np.linspace(0.0, 400.0, 12)
    rows = [[1, x, 1, 5.0 * k, 0.1 * (k % 3)] for k, x in enumerate(way)]
    return rows_of("run,distance_mm,approach,t_s,deviation_um", [change(row) for row in rows])


def ballbar(change=lambda row: row):
    turn = np.linspace(0.0, 355.0, 72)
    rows = [["ccw", 1000, a, 0.5236 * k, 0.1 * (k % 3)] for k, a in enumerate(turn)]
    return rows_of("run,feed_mm_min,angle_deg,t_s,radius_um", [change(row) for row in rows])


def drift(change=lambda row: row):
    rows = [[60.0 * k, 8000, 0.1 * (k % 3), 0.1 * (k % 2), 0.1 * k] for k in range(60)]
    return rows_of("t_s,spindle_rpm,dx_um,dy_um,dz_um", [change(row) for row in rows])


def tip(change=lambda row: row):
    random = np.random.default_rng(3)
    rows = [
        [8.0 * k, *np.round(random.uniform(-250, -50, 3), 3), 0, 0, 0, 0.1 * (k % 3), k % 2, k % 5]
        for k in range(20)
    ]
    return rows_of("t_s,X,Y,Z,sx,sy,sz,dx_um,dy_um,dz_um", [change(row) for row in rows])


def with_cell(number, value):
    """The row with one cell put otherwise; `value` may be a function of the old one."""

    def change(row):
        row = list(row)
        row[number] = value(row[number]) if callable(value) else value
        return row

    return change


def read(folder, job, text):
    (folder / "test.csv").write_text(text)
    return read_instruments(read_job(write_job(folder, more=job)))


@pytest.mark.parametrize(
    ("job", "text", "message"),
    [
        (AXIS, laser(with_cell(2, 3)), r"csv:2: approach is 3; accepted: 1 after"),
        (DIAGONAL, diagonal(with_cell(2, 0.5)), r"csv:2: approach is 0.5; accepted: 1 after"),
        (TIP, tip(with_cell(5, -2)), r"csv:2: sy is -2; accepted: 1 after"),
        (DRIFT, drift(with_cell(1, 8_000_000)), r"csv:2: spindle_rpm is 8e\+06; accepted: 0 \.\."),
        (DRIFT, drift(with_cell(1, -8000)), r"csv:2: spindle_rpm is -8000; accepted: 0 \.\."),
        (AXIS, laser(with_cell(4, lambda v: v + 1e5)), r"csv:2: deviation_um is 100000 um, 24 of"),
        (BALLBAR, ballbar(with_cell(4, lambda v: v + 1e5)), r"csv:2: radius_um is 100000 um, 72"),
        (DRIFT, drift(with_cell(4, lambda v: v + 1e5)), r"csv:2: dz_um is 100000 um, 60 of 60"),
        (TIP, tip(with_cell(9, lambda v: v - 1e5)), r"csv:2: dz_um is -100000 um, 20 of 20"),
        (BALLBAR, ballbar(with_cell(4, 0)), r"csv:2: radius_um is 0 in all 72 rows; accepted"),
        (AXIS, laser(with_cell(4, 2.5)), r"csv:2: deviation_um is 2.5 in all 24 rows; accepted"),
        (DRIFT, drift(lambda r: [*r[:2], 0, 0, 0]), "dx_um, dy_um, dz_um is 0, 0, 0 in all 60"),
        (AXIS, laser(header="run,position_mm,approach,t_s,deviation_um,deviation_um",
                     change=lambda r: [*r, 0]),
         r"csv:1: column 'deviation_um' is there 2 times; accepted: every column once"),
        (AXIS, laser(with_cell(3, lambda t: f"1_0{t}")), r"csv:2: t_s is '1_00.0'; accepted: seco"),
        (AXIS, laser(with_cell(4, "\u0661\u0662")), "csv:2: deviation_um is '\u0661\u0662'; acc"),
        (DRIFT, drift(with_cell(0, lambda t: 1.7e9 + t)), r"t_s is 1700000000; .*calendar"),
    ],
)  # fmt: skip
def test_what_no_instrument_writes_is_refused(tmp_path, job, text, message):
    with pytest.raises(InputError, match=message):
        read(tmp_path, job, text)


@pytest.mark.parametrize(
    ("job", "text", "message"),
    [
        (AXIS, laser(with_cell(2, 0)), "approach is 0 in every row"),
        (DIAGONAL, diagonal(with_cell(2, 0)), "approach is 0 in every row"),
        (TIP, tip(), "sx, sy, sz is 0 in every row"),
        (AXIS, laser(with_cell(3, lambda t: 1000 * t)), "one reading takes 5000 s .*in seconds"),
        (DRIFT, drift(with_cell(0, lambda t: 1000 * t)), "983.3 h after the cold start"),
        (DRIFT, drift(with_cell(3, 0)), "dy_um is 0 in every row: was it measured"),
        (DRIFT, drift(lambda r: r).replace("60.0,8000,0.1,0.1,0.1", "0.0,8000,0.0,0.0,0.0"),
         "1 of 60 rows repeat the row before, the first in line 3"),
        (AXIS + AXIS, laser(), "the readings are those of test.csv: is one test named twice"),
    ],
)  # fmt: skip
def test_what_is_odd_is_asked_about(tmp_path, job, text, message):
    notes = [str(note) for note in read(tmp_path, job, text)[-1].notes]
    assert any(note.startswith("test.csv: ") for note in notes)
    assert any(re.search(message, note) for note in notes), notes


@pytest.mark.parametrize(
    ("job", "text"),
    [(AXIS, laser()), (DIAGONAL, diagonal()), (BALLBAR, ballbar()), (DRIFT, drift())],
)
def test_sound_files_pass_without_a_note(tmp_path, job, text):
    (test,) = read(tmp_path, job, text)
    assert test.notes == ()


@pytest.mark.parametrize(("rpm", "asked"), [(8, True), (0, False), (600, False)])
def test_thousands_of_turns_are_asked_about(tmp_path, rpm, asked):
    (test,) = read(tmp_path, DRIFT, drift(with_cell(1, rpm)))
    assert any("spindle_rpm is 8 at most: is it in" in note.text for note in test.notes) == asked


def tracker(turn_urad, moved_um):
    """Places of a tracker; readings of a frame that is turned, and of what moves the tool, um."""
    random = np.random.default_rng(11)
    places = np.round(random.uniform([-390, -290, -290], [-10, -10, -10], (60, 3)), 3)
    read = 1e-3 * np.cross(turn_urad, places) + moved_um(places)
    read += random.normal(0.0, 0.3, read.shape)
    rows = [[8.0 * k, *places[k], 0, 0, 0, *np.round(read[k], 4)] for k in range(60)]
    return rows_of("t_s,X,Y,Z,sx,sy,sz,dx_um,dy_um,dz_um", rows)


def out_of_square(places):
    """dx = -EC0Y y of 100 urad."""
    return np.column_stack([-0.1 * places[:, 1], np.zeros((len(places), 2))])


@pytest.mark.parametrize(
    ("turn", "moved", "asked"),
    [
        ((40, -60, 90), lambda p: 0.0 * p, True),
        ((0, 0, 0), lambda p: 0.0 * p, False),
        ((0, 0, 0), out_of_square, False),
    ],
)
def test_a_tracker_that_is_not_aligned_is_asked_about(tmp_path, turn, moved, asked):
    (test,) = read(tmp_path, TIP, tracker(turn, moved))
    said = [note.text for note in test.notes if 'is frame = "rigid" meant' in note.text]
    assert bool(said) == asked
    if asked:
        assert "turned by (-40, 60, -90) urad" in said[0]
    aligned = read(tmp_path, TIP.replace("offset", "rigid"), tracker(turn, moved))[0]
    assert not any("rigid" in note.text for note in aligned.notes)
