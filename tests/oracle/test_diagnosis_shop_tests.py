"""What shops measure: the generator against definitions of standards, and what is said of it."""

import json

import numpy as np
import pytest

from tests.hidden_effects.program_runs import diagnose
from tests.hidden_effects.shop_tests import (
    circle_um,
    make_axis,
    make_ballbar,
    make_level,
    make_measured_plate,
    make_plate,
)

#: standard uncertainties within which a mean has to lie; chance alone exceeds them once in 16,000
SURE = 4.0


def test_plates_are_strained_as_is_told(tmp_path):
    """Scale along X and Y, and squareness: what a turn does not change of the linear part.

    The scatter of a plate may hold a linear part, of s / d at most by Cauchy and Schwarz. Over
    plates it has any sign, and the regression on what is told is one.
    """
    told, seen = [], []
    for seed in range(40):
        folder = tmp_path / str(seed)
        make_plate(folder, seed)
        truth = json.loads((folder / "truth.json").read_text())
        table = np.loadtxt(folder / "holes.csv", delimiter=",", skiprows=1)
        place, away = table[:, :2], table[:, 2:4] - table[:, :2]
        columns = np.column_stack([np.ones(len(place)), place])
        fitted = np.linalg.lstsq(columns, away, rcond=None)[0][1:].T
        told.append(_plain(np.array(truth["strain"])))
        seen.append(_plain(fitted))
    told, seen = np.array(told), np.array(seen)
    slope, u = _regression(told.ravel(), seen.ravel())
    assert u < 0.1 and slope == pytest.approx(1.0, abs=SURE * u)


def _plain(strain):
    return strain[0, 0], strain[1, 1], strain[0, 1] + strain[1, 0]


def _regression(x, y):
    """Slope through zero and its standard uncertainty."""
    slope = float(x @ y / (x @ x))
    return slope, float(np.sqrt(np.mean((y - slope * x) ** 2) / (x @ x)))


@pytest.mark.parametrize("seed", range(8))
def test_an_axis_has_the_mean_reversal_value_that_is_told(tmp_path, seed):
    """ISO 230-2: mean over the stops of the means from below less those from above, sign turned."""
    make_axis(tmp_path / "axis", seed)
    truth = json.loads((tmp_path / "axis" / "truth.json").read_text())
    rows = np.loadtxt(tmp_path / "axis" / "laser.csv", delimiter=",", skiprows=1)
    values = rows[:, 4]
    up, down = ([values[(rows[:, 2] == s) & (rows[:, 1] == p)] for p in np.unique(rows[:, 1])]
                for s in (1, -1))  # fmt: skip
    differences = np.array([d - u for u, d in zip(up, down, strict=True)])  # stop, run
    chance = differences - differences.mean(axis=1, keepdims=True)
    runs = differences.shape[1]
    u = np.sqrt(np.sum(chance**2) / (len(differences) * (runs - 1)) / differences.size)
    assert differences.mean() == pytest.approx(truth["reversal_um"], abs=SURE * u)


def _circle(**causes):
    """One circle of 100 mm radius, ccw, and its angles; what is not given is nothing."""
    angle = np.radians(np.arange(0.25, 360.0, 0.5))
    own = {"lost_um": np.zeros(2), "lean_urad": 0.0, "lag_rad": 0.0, "way": 1} | causes
    take_up = np.full(2, 1e-4)
    return angle, circle_um(
        angle, own["way"], 100.0, own["lost_um"], take_up, own["lean_urad"], own["lag_rad"]
    )


def test_circles_show_what_iso_230_4_says_of_them():
    """Lost motion is a step where the axis turns; an axis that leans, and a drive that lags, ovals.

    An oval of squareness is the same both ways round, that of a lag turns with the direction.
    """
    angle, stepped = _circle(lost_um=np.array([8.0, 0.0]))
    # X turns at 0 and 180 degrees; the tool stays behind: outside while it still goes outwards
    assert stepped[0] - stepped[-1] == pytest.approx(8.0, abs=0.1)
    _, leaning = _circle(lean_urad=20.0)
    _, other_way = _circle(lean_urad=20.0, way=-1)
    # a right angle that is 20 urad off makes diagonals of 200 mm differ by 20e-6 of that
    assert np.ptp(leaning) == pytest.approx(2.0, rel=1e-3)
    assert leaning == pytest.approx(other_way)
    _, lagging = _circle(lag_rad=4e-5)
    _, turned = _circle(lag_rad=4e-5, way=-1)
    assert lagging == pytest.approx(-turned)
    # by hand: where X is ahead by 20e-6 rad and Y behind by as much
    moved = np.hypot(100.0 * np.cos(angle + 2e-5), 100.0 * np.sin(angle - 2e-5)) - 100.0
    assert lagging == pytest.approx(1e3 * moved, abs=1e-3)


def _said(folder):
    """Labels of each effect that is said, with its rivals; and the report."""
    report, _ = diagnose(folder)
    own = [e for e in report["effects"] if e["effect"] != "unknown"]
    return [{f"{e['effect']} {e['target'] or ''}".strip(), *e["rivals"]} for e in own], report


@pytest.mark.parametrize("seed", [14000, 14003])
def test_lost_motion_is_told_by_a_ballbar_that_warms(tmp_path, seed):
    """A radius that drifts is of the instrument, and no doubt about the steps where axes turn."""
    make_ballbar(tmp_path / "ballbar", seed)
    truth = json.loads((tmp_path / "ballbar" / "truth.json").read_text())
    said, report = _said(tmp_path / "ballbar")
    assert len(said) == len(truth["hidden"])
    assert all(any(set(names) & one for one in said) for names in truth["hidden"])
    assert report["verdict"] in ("named", "class")
    assert "length of the instrument as it warms" in report["of_measurement_um"]


def test_a_drill_that_cuts_too_large_is_told(tmp_path):
    make_plate(tmp_path / "plate", 14001)
    said, _ = _said(tmp_path / "plate")
    (size,) = (one for one in said if "tool_radius T1" in one)
    assert "probe_radius" in size


@pytest.mark.parametrize("seed", [14001, 14002, 14003])
def test_a_level_reads_a_pitch(tmp_path, seed):
    """Straight, a bump, or none (ISO 230-1, angular error motions, by levels)."""
    make_level(tmp_path / "level", seed)
    truth = json.loads((tmp_path / "level" / "truth.json").read_text())
    said, report = _said(tmp_path / "level")
    assert len(said) == len(truth["hidden"])
    assert all("component EBX" in one for one in said)
    assert truth["hidden"] or report["verdict"] == "nothing"


def test_what_remains_is_told_in_parts(tmp_path):
    """Lost motion that varies along an axis is what remains of it, not scatter."""
    make_axis(tmp_path / "axis", 9403)
    _, report = _said(tmp_path / "axis")
    parts = report["remains_by_um"]
    assert list(parts.values()) == sorted(parts.values(), reverse=True)
    assert report["verdict"] not in ("partly", "unknown") or parts
    assert all(0.0 < size <= 1.5 * report["remains_um"] for size in parts.values())


def _squareness(folder, seed, *, by_rows):
    """Ends of its interval and what is true, urad; and whether a note says that drift is alike."""
    make_measured_plate(folder, seed, by_rows=by_rows)
    truth = json.loads((folder / "truth.json").read_text())
    _, report = _said(folder)
    (own,) = (e for e in report["effects"] if e["effect"] == "squareness")
    is_told = any("squareness C0Y looks like a steady drift" in note for note in report["notes"])
    return *own["interval_95"]["squareness_urad"], truth["lean_urad"], is_told


@pytest.mark.parametrize("seed", [17203, 17204, 17205])
def test_a_squareness_is_known_no_better_than_the_drift_that_looks_like_it(tmp_path, seed):
    """Row by row a drift is a shear: no reading tells them apart. By chance it is none."""
    low, high, true, is_told = _squareness(tmp_path / "rows", seed, by_rows=True)
    assert low < true < high and is_told
    surer = _squareness(tmp_path / "chance", seed, by_rows=False)
    assert surer[1] - surer[0] < 0.75 * (high - low)
    assert not surer[3]
