"""Floors that two passes made alike: what happened between them decides which one counts.

The oracle knows when each pass crossed a floor, and keeps the lower of two heights.
"""

from __future__ import annotations

import numpy as np
import pytest

from tests.small_job import write_job
from vmach.diagnosis.inference.own_contacts import over_own_contacts
from vmach.diagnosis.inference.prepare import prepare_weighing
from vmach.diagnosis.named_fit import fit_named
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.effects import EffectInstance, catalogue

NOISE_UM = 0.5
#: Y of grooves that the first round alone cuts, that both cut, and that the second alone cuts
FIRST, TWICE, LAST = (-36.0,), (-24.0, -12.0, 0.0), (12.0, 24.0)
GROOVES = (*FIRST, *TWICE, *LAST)
PLACES = (-25.0, -15.0, -5.0, 5.0, 15.0, 25.0)
STEP_UM = 9.0


def _groove(y):
    return f"G0 X-30 Y{y:g}\nG1 Z-2 F300\nG1 X30 F600\nG0 Z5\n"


PROGRAM = (
    "%\nG21 G17 G90 G94 G40\nT1 M6\nS6000 M3\nG54 G43 H1\nG0 Z5\n"
    + "".join(map(_groove, (*FIRST, *TWICE)))
    + "G4 P20\n"
    + "".join(map(_groove, (*TWICE, *LAST)))
    + "M5\nM30\n%\n"
)


def write_points(folder, height_um):
    """Points on the middle of all floors, `height_um` of each groove and place."""
    rows = ["id,feature,x,y,z,i,j,k,mx,my,mz,u_um"]
    for y in GROOVES:
        for x in PLACES:
            point = f"{x},{y},-2.0,0,0,1,{x},{y},{-2.0 + 1e-3 * height_um(y):.7f}"
            rows.append(f"{len(rows)},groove {y:g},{point},{NOISE_UM}")
    (folder / "points.csv").write_text("\n".join(rows))


@pytest.fixture
def surveyed(tmp_path):
    path = write_job(tmp_path)
    (tmp_path / "part.nc").write_text(PROGRAM)

    def survey(height_um):
        write_points(tmp_path, height_um)
        return survey_job(path)

    return survey


def _between(survey):
    """A moment after the first round and before the second, s."""
    path = survey.paths[0]
    moves = path.moves
    dwell = int(np.argmax(moves.duration_s))
    assert moves.duration_s[dwell] == pytest.approx(20.0)
    return float(moves.start_s[dwell] + 10.0)


@pytest.mark.parametrize(
    ("name", "target", "by_um"),
    [
        ("tool_chip", "T1", {"radius_um": 0.0, "length_um": STEP_UM}),
        ("tool_slip", "T1", {"slip_um": -STEP_UM}),
        ("tool_slip", "T1", {"slip_um": STEP_UM}),
        ("datum_shift", "", {"shift_x_um": 0.0, "shift_y_um": 0.0, "shift_z_um": STEP_UM}),
        ("datum_shift", "", {"shift_x_um": 0.0, "shift_y_um": 0.0, "shift_z_um": -STEP_UM}),
    ],
)
def test_the_lower_of_two_passes_makes_a_floor(surveyed, name, target, by_um):
    survey = surveyed(lambda y: 0.0)
    step = {**by_um, "time_s": _between(survey)}
    effect = EffectInstance(catalogue()[name], target, step, survey.job)
    moved = survey.made_beside([effect])
    found = 1e3 * moved.foretold_mm([effect])
    raised = -by_um["slip_um"] if name == "tool_slip" else [*by_um.values()][-1]
    true = [_height_um(y, raised) for y in GROOVES for _ in PLACES]
    np.testing.assert_allclose(found, true, atol=1e-6)


@pytest.mark.parametrize("raised_um", [STEP_UM, -STEP_UM])
def test_a_moment_is_fitted_over_passes_that_hold_whatever_it_is(surveyed, raised_um):
    """A tool that slips between the rounds: into its holder, or out of it."""
    random = np.random.default_rng(3)
    survey = surveyed(lambda y: _height_um(y, raised_um) + NOISE_UM * random.standard_normal())
    weighing = prepare_weighing(survey, [catalogue()["tool_slip"]])
    found = weighing.extend(weighing.nothing(), weighing.index_of("tool_slip T1"))
    weighing, found = over_own_contacts(weighing, found)
    path, between_s = weighing.survey.paths[0], _between(survey)
    is_twice = np.isin(path.on_part_mm[:, 1].round(), TWICE)
    assert np.all((path.time_s[is_twice] < between_s) == (raised_um > 0.0))
    (slip,) = fit_named(survey, ["tool_slip:T1"])
    # it may have been at any moment between those of what it left alone and of what it moved
    moved = path.on_part_mm[:, 1].round() >= (LAST[0] if raised_um > 0.0 else TWICE[0])
    before_s, after_s = path.time_s[~moved].max(), path.time_s[moved].min()
    middle_s, spread_s = 0.5 * (before_s + after_s), (after_s - before_s) / np.sqrt(12.0)
    assert slip.parameters["time_s"] == pytest.approx(middle_s, abs=0.2)
    assert slip.u["time_s"] == pytest.approx(spread_s, rel=0.02)
    assert slip.parameters["slip_um"] == pytest.approx(-raised_um, abs=1.0)


def _height_um(y, raised_um):
    """The lower of what both passes leave, where there are two."""
    heights = [0.0] * (y in (*FIRST, *TWICE)) + [raised_um] * (y in (*TWICE, *LAST))
    return min(heights)
