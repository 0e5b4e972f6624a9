"""Grid points of the ends, against closed forms and brute force."""

from itertools import product

import numpy as np
import pytest

from tests.oracle.compensation_choice import best_sequence
from tests.oracle.test_compensation_programs import job_with
from tests.oracle.test_compensation_surface import STOCK
from tests.small_job import write_job_with_nominal
from vmach.compensation import compensate
from vmach.compensation.aim.surface import check_surface, read_surface
from vmach.compensation.grid.choice import Course, Points
from vmach.effects import read_effects
from vmach.job import read_job

AMPLITUDE, PITCH = 6e-3, 40.0
WAVE = (
    f"[effects.cyclic_pitch.X]\namplitude_um = {1e3 * AMPLITUDE}\npitch_mm = {PITCH}\n"
    "phase_rad = 0.0\n"
)


def written_places(text):
    """X and Y of the blocks between two comments."""
    place, found = {"X": np.nan, "Y": np.nan}, []
    inside = text.decode("latin-1").split("(from)")[1].split("(to)")[0]
    for line in inside.strip().splitlines():
        for word in line.split():
            if word[0] in place:
                place[word[0]] = float(word[1:])
        found.append((place["X"], place["Y"]))
    return np.array(found)


def x_error(x):
    """Closed form of the wave at workpiece X; machine X is that + 100."""
    return AMPLITUDE * np.sin(2.0 * np.pi * (x + 100.0) / PITCH)


@pytest.mark.parametrize("slope", [0.1, 0.125, 0.375])
def test_inserted_ends_of_an_oblique_line_find_grid_points_on_it(tmp_path, slope):
    body = f"G1 Z-1. F200\nX10. Y0.\n(from)\nX90. Y{80.0 * slope:.3f}\n(to)\nX0. Y0.\nM30\n"
    job, effects = job_with(tmp_path, body, WAVE)
    found = compensate(job, effects)
    x, y = written_places(found.text)[:-1].T
    assert len(x) > 4
    across = (y - slope * (x + x_error(x) - 10.0)) / np.hypot(1.0, slope)
    # rows of grid points along the line are 0.001 / hypot(p, q) mm apart for a slope of p / q;
    # the nearest one to the wanted place, which is in the tolerance of 0.0001 mm, is taken
    p, q = {0.1: (1, 10), 0.125: (1, 8), 0.375: (3, 8)}[slope]
    row = 1e-3 / np.hypot(p, q)
    assert np.abs(across).max() < 1e-4 + 0.5 * row + 2e-5


def test_ends_of_a_level_line_are_placed_where_it_crosses_the_grid(tmp_path):
    # along X the error in Y is a wave: half of its places are more than 0.25 um off the grid
    wave = WAVE.replace("cyclic_pitch.X", "cyclic_pitch.Y")
    body = "G1 Z-1. F200\nX10. Y0.\n(from)\nX12. Y80.\n(to)\nX0. Y0.\nM30\n"
    job, effects = job_with(tmp_path, body, wave)
    found = compensate(job, effects)
    x, y = written_places(found.text)[:-1].T
    wanted = y + AMPLITUDE * np.sin(2.0 * np.pi * (y + 50.0) / PITCH)
    across = x - 10.0 - wanted / 40.0
    assert np.abs(across).mean() < 1.2e-4


def random_choice(seed, *, ends=5, tries=3, probes=4):
    """A course with probes on every piece, and points for its ends, without meaning."""
    rng = np.random.default_rng(seed)
    count = ends * probes
    parameter = (np.arange(count) + 0.5) / probes % 1.0 / 2.0
    moved = np.arange(ends) % 2  # two pieces to a move
    parameter += 0.5 * np.repeat(moved, probes)
    course = Course(
        normal=rng.normal(size=(count, 3)),
        base=rng.normal(size=count),
        weight=rng.uniform(0.5, 2.0, count),
        parameter=parameter,
        only_below=rng.random(count) < 0.3,
        begin=np.where(moved == 1, -1, probes * np.arange(ends)),
        start=np.where(moved == 1, 0.5, 0.0),
        stays=rng.uniform(0.0, 0.1, ends),
        still=np.where(rng.random((ends, 3)) < 0.2, 0.5, 0.0),
        large=0.3,
    )

    def table(rows, columns):
        place = 0.4 * rng.normal(size=(rows, columns, 3))
        return Points(
            parameter=np.repeat(np.where(moved == 1, 1.0, 0.5)[:rows, None], columns, axis=1),
            bound=np.repeat(probes * (np.arange(rows) + 1)[:, None], columns, axis=1),
            at_end=place,
            at_start=0.9 * place,
            off=0.5 * place,
            corrected=place,
        )

    points = table(ends, tries)
    exact = Points(*(np.zeros_like(a[:1, :1]) for a in points))
    return course, exact, points


def cost_of(course, points, choice):
    """What the doc of `Course` says, in plain words: no code shared."""
    total, before = 0.0, None
    for k, j in enumerate(choice):
        on = slice(4 * k, 4 * k + 4)
        start = np.zeros(3) if before is None else points.at_start[k - 1, before]
        share = (course.parameter[on] - (0.5 if k % 2 else 0.0)) / 0.5
        place = start + share[:, None] * (points.at_end[k, j] - start)
        left = course.base[on] + (course.normal[on] * place).sum(axis=1)
        counts = (left < 0.0) | ~course.only_below[on]
        total += (course.weight[on] * (left**2 + course.large * left**8))[counts].sum()
        came = np.zeros(3) if before is None else points.corrected[k - 1, before]
        total += course.stays[k] * (points.off[k, j] ** 2).sum()
        total += (course.still[k] * (points.corrected[k, j] - came) ** 2).sum()
        before = j
    return total


@pytest.mark.parametrize("seed", range(8))
def test_the_best_sequence_is_that_of_brute_force(seed):
    course, exact, points = random_choice(seed)
    choices = list(product(range(3), repeat=5))
    costs = [cost_of(course, points, choice) for choice in choices]
    assert tuple(best_sequence(course, exact, points)) == choices[int(np.argmin(costs))]


def test_rounding_for_the_part_leaves_less_on_it(tmp_path):
    bent = WAVE + "[effects.scale.Y]\nscale_ppm = -150\n"
    leaning = "G1 Z-8. F400\nX5. Y5.\nX75. Y8.\nX71. Y55.\nX8. Y52.\nX5. Y5.\nG0 Z5.\nM30\n"
    job_with(tmp_path, leaning, bent)
    (tmp_path / "job.toml").write_text((tmp_path / "job.toml").read_text() + STOCK)
    job = read_job(tmp_path)
    effects = read_effects(job.effects, file=job.path, job=job)
    surface = read_surface(job, with_aim=True)
    left = []
    for points in (None, surface.aim):
        found = compensate(job, effects, round_points=points)
        left.append(np.abs(check_surface(job, found.text, surface, effects=effects).after_mm))
    assert left[1].mean() < left[0].mean()
    assert left[1].max() < 0.6e-3


def test_axes_that_stand_get_no_word_where_nothing_is_cut(tmp_path):
    body = "G1 Z-1. F200\nX33.3 Y20.\nY40.\nG0 Z5.\nX0. Y0.\nG1 Z-2.\nM30\n"
    job, effects = job_with(tmp_path, body, WAVE)
    lines = compensate(job, effects).text.decode("latin-1").splitlines()
    assert "Y40." in lines
    assert "G0 Z5." in lines


def test_a_small_full_circle_stays_two_arcs_wherever_its_inserted_end_goes(tmp_path):
    """Radius 1 mm: a way of 0.2 mm along the path is 11 degrees, and arcs end at 190."""
    errors = {
        "EXX": (lambda x: 20 + 0.03 * x, (0, 0, -100)),
        "EYX": (lambda x: 6 * np.sin(x / 50), (0, 0, -100)),
        "EBX": (lambda x: 0.05 * x, None),
    }
    job = read_job(write_job_with_nominal(tmp_path, errors))
    surface = read_surface(job, with_aim=True)
    found = compensate(job, round_points=surface.aim)
    assert found.arcs == found.arcs_kept == 1
    assert found.after.largest_mm < 2e-3


def test_the_grid_points_do_not_depend_on_how_many_ends_are_compared_at_once(tmp_path, monkeypatch):
    body = "G1 Z-1. F200\nX10. Y0.\nX90. Y8.\nX0. Y0.\nM30\n"
    job, effects = job_with(tmp_path, body, WAVE)
    together = compensate(job, effects).text
    # stretches whose ends are all inserted, and some without such
    monkeypatch.setattr("vmach.compensation.grid.rounding._AT_ONCE", 3)
    assert compensate(job, effects).text == together
