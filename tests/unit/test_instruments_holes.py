"""Holes measured as positions and diameters: a shifted tool shifts, a thick one widens."""

import numpy as np
import pytest

from tests.small_job import measurement, write_job
from vmach.diagnosis.diagnose import diagnose
from vmach.diagnosis.page.instrument_pictures import instrument_pictures
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.effects import set_up_effect
from vmach.errors import InputError
from vmach.instruments import read_instruments
from vmach.job import read_job

#: zero of the part on the machine of the small job
ZERO = np.array([-200.0, -150.0])
ERRORS = {
    "EXX": (lambda x: 5.0 * np.sin(x / 30.0), None),
    "EYX": (lambda x: -0.02 * x, None),
    "EZX": (lambda x: 4.0 * np.cos(x / 90.0), None),
}
PLACES = np.array([(x, y) for y in (-20.0, 0.0, 20.0) for x in (-30.0, 10.0, 50.0)])


def drilled(places, *, cycle=True):
    """A program that drills 10 mm deep at places, by a cycle or by plain moves."""
    lines = ["%", "G21 G17 G90", "T1 M6", "S3000 M3", "G54 G43 H1", "G0 X0 Y0 Z20"]
    for k, (x, y) in enumerate(places):
        if cycle:
            lines.append(f"{'G81 Z-10 R2 F300 ' if k == 0 else ''}X{x:.4f} Y{y:.4f}")
        else:
            lines += [f"G0 X{x:.4f} Y{y:.4f}", "Z2", "G1 Z-10 F300", "G0 Z5"]
    return "\n".join([*lines, *(["G80"] if cycle else []), "G0 Z20", "M5", "M30", "%", ""])


#: round a boss of 30 mm and inside a bore of 24 mm, with a tool of 10 mm
MILLED = """\
%
G21 G17 G90
T1 M6
S3000 M3
G54 G43 H1
G0 X-40 Y-20 Z20
G1 Z-5 F300
G3 X-40 Y-20 I20 J0 F600
G0 Z20
G0 X40 Y20
G1 Z-5 F300
G1 X47
G3 X47 Y20 I-7 J0
G1 X40
G0 Z20
M5
M30
%
"""
ROUND = "x,y,d,mx,my,md\n-20,-20,30,-20,-20,30\n40,20,24,40,20,24\n40,20,24,40,20,24\n"


def holes_job(folder, program, errors=None, *, table=None, **settings):
    """A job without any CAD, with holes measured where they should be unless a table is given."""
    told = {"u_um": 1.0} | settings
    text = write_job(folder, errors, more=measurement("holes", **told)).read_text()
    text = "\n".join(x for x in text.splitlines() if not x.startswith(("measured", "tool_length")))
    (folder / "job.toml").write_text(text + "\n")
    (folder / "part.nc").write_text(program)
    rows = "".join(f"{x},{y},-4,10,{x},{y},-4,10\n" for x, y in PLACES)
    (folder / "holes.csv").write_text(table or "x,y,z,d,mx,my,mz,md\n" + rows)
    return folder / "job.toml"


def foretold_um(job, effect=None):
    """Foretold deviations of holes, a row each."""
    job = read_job(job)
    effects = [] if effect is None else [set_up_effect(*effect, job=job)]
    (test,) = read_instruments(job, effects=effects)
    return 1e3 * test.predicted_mm.reshape(-1, len(test) // len(set(x.split()[0] for x in test.id)))


@pytest.mark.parametrize("cycle", [True, False])
def test_a_drilled_hole_lies_where_the_tip_was(tmp_path, cycle):
    """The tables act as displacements of the tool; X carries the workpiece ("relative")."""
    found = foretold_um(holes_job(tmp_path, drilled(PLACES, cycle=cycle), ERRORS))
    x = PLACES[:, 0] + ZERO[0]
    # between the points of a table, 10 mm apart, a straight line
    places = np.arange(-400.0, 1.0, 10.0)
    for k, name in enumerate(("EXX", "EYX", "EZX")):
        curve = ERRORS[name][0]
        np.testing.assert_allclose(found[:, k], np.interp(x, places, curve(places)), atol=1e-6)
    np.testing.assert_allclose(found[:, 3], 0.0, atol=1e-6)


def test_a_thick_drill_widens_and_shifts_nothing(tmp_path):
    job = holes_job(tmp_path, drilled(PLACES))
    found = foretold_um(job, ("tool_radius", "T1", {"radius_um": 7.0}))
    np.testing.assert_allclose(found, np.tile([0.0, 0.0, 0.0, 14.0], (len(PLACES), 1)), atol=1e-9)


def test_a_warm_part_is_too_small_when_it_is_cold(tmp_path):
    """Every length shrinks by the same share, a hole of 10 mm as well."""
    job = holes_job(tmp_path, drilled(PLACES))
    found = foretold_um(job, ("workpiece_temperature", "", {"expansion_ppm": 100.0}))
    np.testing.assert_allclose(found[:, :2], -0.1 * PLACES, atol=1e-9)
    np.testing.assert_allclose(found[:, 3], -1.0, atol=1e-9)


def test_a_thick_mill_widens_a_bore_and_thins_a_boss(tmp_path):
    job = holes_job(tmp_path, MILLED, table=ROUND)
    found = foretold_um(job, ("tool_radius", "T1", {"radius_um": 7.0}))
    np.testing.assert_allclose(found[:, 2], [-14.0, 14.0], atol=1e-9)
    np.testing.assert_allclose(found[:, :2], 0.0, atol=1e-9)


def test_round_a_bore_displacements_are_averaged(tmp_path):
    """x = a X over a circle of radius R: its centre at a X, its mean diameter larger by a R."""
    job = holes_job(tmp_path, MILLED, table=ROUND)
    found = foretold_um(job, ("scale", "X", {"scale_ppm": 100.0}))
    centre = np.array([-20.0, 40.0]) + ZERO[0]
    np.testing.assert_allclose(found[:, 0], 0.1 * centre, atol=1e-9)
    np.testing.assert_allclose(found[:, 1], 0.0, atol=1e-9)
    np.testing.assert_allclose(found[:, 2], 0.1 * np.array([20.0, 7.0]), atol=1e-9)
    # what steps where an axis turns moves the four quadrants apart, and the centre not at all
    stepped = foretold_um(job, ("backlash", "X", {"reversal_um": 20.0}))
    np.testing.assert_allclose(stepped, 0.0, atol=1e-9)


def plate(folder, *, seed=3, stretch=-34e-6, lean=64e-6, bump_um=2.0, screw_um=0.0, u_um=1.0):
    """650 holes of one clamping: stretched, leaning, 3.7 um of scatter that is not white.

    Of the scatter a part is common to rows of 26 holes, a part smooth over the plate. X may have a
    pitch error of 10 mm.
    """
    random = np.random.default_rng(seed)
    x, y = np.meshgrid(np.linspace(-280.0, 280.0, 26), np.linspace(-220.0, 220.0, 25))
    order = random.permutation(x.size)  # of drilling: time is no place
    place = np.round(np.column_stack([x.ravel(), y.ravel()]), 4)
    scatter = 2.4 * random.standard_normal(place.shape)
    row = random.permutation(np.arange(x.size) // 26)  # which holes share their chance
    scatter += 2.0 * random.standard_normal((25, 2))[row]
    turn = place @ np.array([[0.9, 0.3], [0.4, 1.0]]) * np.pi / 90.0
    scatter += bump_um * np.sqrt(2.0) * np.cos(turn + random.uniform(0.0, 6.0, 2))
    true = place * stretch + np.column_stack([-lean * place[:, 1], 0.0 * place[:, 0]])
    scatter[:, 0] += screw_um * np.sin(2.0 * np.pi * place[:, 0] / 10.0)
    turned = 2e-5 * np.column_stack([-place[:, 1], place[:, 0]])  # as the part lay on the device
    read = place + true + turned + [0.03, -0.02] + 1e-3 * scatter
    rows = [f"{a!r},{b!r},{c!r},{d!r}" for a, b, c, d in np.hstack([place, read]).tolist()]
    table = "x,y,mx,my\n" + "\n".join(rows) + "\n"
    job = holes_job(folder, drilled(place[order]), table=table, u_um=u_um)
    machine = (folder / "machine.toml").read_text()
    for old, new in (("[-400, 0]", "[-700, 0]"), ("[-300, 0]", "[-600, 0]")):
        machine = machine.replace(old, new, 1)
    (folder / "machine.toml").write_text(machine)
    job.write_text(job.read_text().replace("G54 = [-200, -150,", "G54 = [-350, -300,"))
    return job, float(scatter.std())


def test_a_plate_shows_its_scale_and_squareness(tmp_path):
    """Two scales and a warm part are one class; what is left has its size said."""
    job, scatter_um = plate(tmp_path)
    found = diagnose(survey_job(job))
    assert found.verdict in ("class", "partly")
    by_name = {f.name: f for f in found.findings}
    stretch = by_name.pop("workpiece_temperature")
    assert "scale" in stretch.rivals.names
    assert stretch.parameters["expansion_ppm"] == pytest.approx(34.0, abs=4.0)
    lean = by_name.pop("squareness")
    assert lean.parameters["squareness_urad"] == pytest.approx(64.0, abs=6.0)
    assert not by_name
    assert found.rms_um["after"] == pytest.approx(scatter_um, rel=0.05)
    assert found.residuals.survey.measurements[0].on_part
    (picture,) = instrument_pictures(found.residuals)
    assert picture.title == "Holes, bores and bosses: holes.csv" and len(picture.plots) == 4


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ("x,y,mx\n1,2,1\n", r"holes\.csv:1: column 'my' is missing"),
        ("x,y,mx,my\n-30,-20,-30,-20\n10,-20,12,-20\n", r"holes\.csv:3: mx is 12 where x is 10"),
        ("x,y,mx,my\n1,1,1,1\n2,2,2,2\n", r"holes\.csv:2: 0 of 2 holes are in the program"),
        ("x,y,mx,my,u_um\n-30,-20,-30,-20,0\n", r"holes\.csv:2: u_um is 0; accepted"),
        ("x,y,mx,my,u_um\n-30,-20,-30,-20,1e-300\n", r"holes\.csv:2: u_um is 1e-300; accepted"),
        (
            "x,y,mx,my\n" + 3 * "-30,-20,-30.001,-20\n",
            r"holes\.csv: 2 readings of different places",
        ),
    ],
)
def test_what_is_wrong_is_told_with_its_line(tmp_path, table, message):
    job = holes_job(tmp_path, drilled(PLACES), table=table)
    with pytest.raises(InputError, match=message):
        read_instruments(read_job(job))


def test_clamping_and_order_of_holes_stand_by_their_readings(tmp_path):
    rows = [f"{x},{y},{x},{y},{'ab'[k % 2]},{-k}\n" for k, (x, y) in enumerate(PLACES)]
    table = "x,y,mx,my,clamping,order\n" + "".join(rows)
    (test,) = read_instruments(read_job(holes_job(tmp_path, drilled(PLACES), table=table)))
    count = len(PLACES)
    backwards = np.repeat(np.arange(count)[::-1], 2)
    assert test.measured_at.tolist() == (-backwards).tolist()
    assert test.clamping.tolist() == ["ab"[k % 2] for k in backwards]
    place = test.states.nose_mm[::2, :2] - test.states.nose_mm[0, :2]
    np.testing.assert_allclose(place, PLACES[::-1] - PLACES[-1], atol=1e-9)


def test_a_hole_that_was_measured_twice_counts_by_its_mean(tmp_path):
    away = 1e-3 * np.random.default_rng(6).normal(size=(2, len(PLACES)))
    rows = [
        f"{x},{y},{x + a},{y}\n" for once in away for (x, y), a in zip(PLACES, once, strict=True)
    ]
    job = holes_job(tmp_path, drilled(PLACES), table="x,y,mx,my\n" + "".join(rows))
    (test,) = read_instruments(read_job(job))
    np.testing.assert_allclose(test.measured_mm[::2], away.mean(axis=0), atol=1e-12)
    np.testing.assert_allclose(test.measured_mm[1::2], 0.0, atol=1e-12)


def test_what_leaves_nothing_open_adds_no_columns_to_holes(tmp_path):
    (test,) = read_instruments(read_job(holes_job(tmp_path, drilled(PLACES))))
    nothing = np.zeros((len(test.seen_states), 3, 0))
    assert test.sensed(nothing).shape == (len(test), 0)


@pytest.mark.parametrize("seed", [1, 2, 3, 4])
def test_a_smooth_field_leaves_scale_and_squareness_to_be_shown(tmp_path, seed):
    """What bends over the plate by 3 um is beyond them: they are its linear part (ISO 230-1)."""
    job, _ = plate(tmp_path, seed=seed, bump_um=3.0)
    found = diagnose(survey_job(job))
    shown = {name for f in found.findings for name in f.rivals.names} | {
        f.name for f in found.findings
    }
    assert {"workpiece_temperature", "squareness"} <= shown


def test_scatter_beyond_what_is_stated_hides_no_pitch_error(tmp_path):
    """Holes scatter by 3 um where 0.4 um are stated: a pitch error of 2.5 um is shown yet."""
    found = diagnose(survey_job(plate(tmp_path, screw_um=2.5, u_um=0.4, bump_um=0.5)[0]))
    (pitch,) = [f for f in found.findings if f.name == "cyclic_pitch"]
    assert pitch.target == "X" and pitch.status in ("shown", "class")
    assert pitch.parameters["amplitude_um"] == pytest.approx(2.5, abs=0.6)
    assert found.remains_um > 2.0


def test_holes_that_the_program_does_not_make_are_left_out_and_said(tmp_path):
    rows = "".join(f"{x},{y},{x},{y}\n" for x, y in [*PLACES, (7.0, 7.0)])
    job = holes_job(tmp_path, drilled(PLACES), table="x,y,mx,my\n" + rows)
    (test,) = read_instruments(read_job(job))
    assert len(test) == 2 * len(PLACES)
    (note,) = [n for n in test.notes if "makes no hole" in n.sentence]
    assert "(1 of 10): lines 11" in note.sentence
