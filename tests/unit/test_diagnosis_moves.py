"""The search goes on from what was chosen too early, or is two parts of one cause."""

from dataclasses import replace

import numpy as np

from tests.small_job import JOB, write_job
from tests.unit.test_diagnosis_verdicts import tip_job
from vmach.diagnosis.inference.moves import search, search_beyond
from vmach.diagnosis.inference.prepare import prepare_weighing
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.effects import catalogue
from vmach.fit.evidence import WIDTHS


def dent_and_play(q, side, time):
    """A dent of 20 um in the positioning of X, and 6 um of lost motion there."""
    x_um = 20.0 * np.exp(-(((q[:, 0] + 200.0) / 60.0) ** 2)) - 3.0 * side[:, 0]
    return np.stack([x_um, 0.0 * x_um, 0.0 * x_um], axis=1)


def test_the_size_of_a_curve_that_was_chosen_too_early_is_chosen_afresh(tmp_path):
    effects = [catalogue()["component"], catalogue()["backlash"]]
    survey = survey_job(tip_job(tmp_path, dent_and_play, count=150))
    weighing = prepare_weighing(survey, effects)
    curve, play = (weighing.index_of(label) for label in ("component EXX", "backlash X"))
    small = weighing.small()
    early = replace(weighing.term(curve, small), width=WIDTHS[0])
    here = weighing.extend(weighing.explain([early], small.posterior.sizes), play)
    found = search_beyond(weighing, here)
    assert found.labels == here.labels == {"component EXX", "backlash X"}
    assert next(t for t in found.terms if t.label == "component EXX").width > WIDTHS[0]
    assert found.score > here.score + 5.0


#: slots along X of 10 mm, in an order of chance; the first eight are cut by tool 1, the others by 2
SLOTS_MM = 14.0 * np.random.default_rng(3).permutation(12) - 77.0
FIRST_LOW, SHIFT_UM = 2, -15.0
#: denser in the middle: the pause into which the moment falls is none of the longest
PLACES_MM = 18.0 * np.linspace(-1.0, 1.0, 12) * np.abs(np.linspace(-1.0, 1.0, 12))


def slots_with_another_datum(folder):
    """The survey of slots whose zero in Z was set anew in the middle of the third of them."""
    job = write_job(folder)
    tool = '[tools.2]\nshape = "flat"\ndiameter_mm = 10\nlength_mm = 100\n'
    stock = "min_mm = [-30, -25, -20]\nmax_mm = [60, 25, 0]"
    job.write_text((JOB + tool).replace(stock, "min_mm = [-30, -90, -20]\nmax_mm = [60, 90, 0]"))
    lines, rows = ["G21 G17 G90 G94 G40 G54"], []
    random = np.random.default_rng(4)
    for k, y in enumerate(SLOTS_MM):
        if k in (0, 8):
            number = 1 + k // 8
            lines += ["G0 Z50", f"T{number} M6", "S6000 M3", f"G43 H{number} Z50"]
        lines += [f"G0 X-20 Y{y:g}", "G0 Z2", "G1 Z-4 F300", "G1 X20 F600", "G0 Z2"]
        for x in PLACES_MM:
            low_um = SHIFT_UM * (k > FIRST_LOW or (k == FIRST_LOW and x > 0.0))
            for place, normal, away_um in (
                ((x, y, -4.0), (0, 0, 1), low_um),
                ((x, y + 5.0, -2.0), (0, -1, 0), 0.0),
                ((x, y - 5.0, -2.0), (0, 1, 0), 0.0),
            ):
                read = np.add(place, np.multiply(normal, 1e-3 * (away_um + random.normal())))
                cells = [len(rows) + 1, f"slot {k} {normal}".replace(",", ""), *place, *normal]
                rows.append(",".join(map(str, [*cells, *read, 1.0])))
    (folder / "part.nc").write_text("\n".join([*lines, "G0 Z50", "M30"]) + "\n")
    heading = "id,feature,x,y,z,i,j,k,mx,my,mz,u_um"
    (folder / "points.csv").write_text("\n".join([heading, *rows]) + "\n")
    return survey_job(job)


def test_one_moment_takes_the_place_of_two_effects_that_are_its_parts(tmp_path):
    """The moments at which a shift is tried first may lie far from the one that was."""
    weighing = prepare_weighing(slots_with_another_datum(tmp_path))
    slip, length = (weighing.index_of(label) for label in ("tool_slip T1", "tool_length T2"))
    two = weighing.extend(weighing.extend(weighing.nothing(), slip), length)
    found = search_beyond(weighing, two)
    assert found.labels == {"datum_shift"}
    assert found.score > two.score


def play_that_grows(q, side, time):
    """Lost motion in X by place along Y: nothing that the candidates below could say."""
    return np.outer(0.05 * side[:, 0] * q[:, 1], [1.0, 0.0, 0.0])


def test_effects_that_fill_a_discrepancy_are_led_on_unless_something_else_is_far_ahead(tmp_path):
    effects = [catalogue()["component"], catalogue()["backlash"]]
    weighing = prepare_weighing(survey_job(tip_job(tmp_path, play_that_grows, count=150)), effects)
    here, asked = search(weighing, weighing.nothing()), []

    def far_ahead(weighing, explanation):
        asked.append(explanation.score)
        return 1000.0

    behind = search_beyond(weighing, here, far_ahead)
    assert asked
    assert max(asked) == behind.score
    tried = len(weighing.tried)
    assert search_beyond(weighing, here).score >= behind.score
    assert len(weighing.tried) > tried
