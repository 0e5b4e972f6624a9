"""Monte Carlo against JCGM 101's own examples, closed forms, GTC and simulated machines."""

from __future__ import annotations

from dataclasses import replace

import GTC
import numpy as np
import pytest
from scipy import stats
from scipy.spatial.distance import pdist

from tests.simulated_machines import trials, workshop
from tests.small_job import write_job
from vmach.machine import Variant
from vmach.machine.from_arrays import machine_from_arrays
from vmach.machine.measuring_uncertainty import MeasuringUncertainty
from vmach.run.pipeline import predict_points
from vmach.uncertainty.corrections import Corrections, Part
from vmach.uncertainty.coverage import numerical_tolerance, shortest_interval
from vmach.uncertainty.monte_carlo import Plan, propagate
from vmach.uncertainty.points import draw_points, point_corrections
from vmach.uncertainty.recut import recut
from vmach.uncertainty.tables import Pool, TableUncertainty
from vmach.uncertainty.volumetric import draw_accuracy
from vmach.volumetric import Volume, error_field

TWO_DIGITS = Plan(digits=2, most_draws=400_000, least_draws=400_000)


def drawn(model, plan=TWO_DIGITS, **more):
    return propagate(lambda random, m: model(random, m)[None], plan, **more)


@pytest.mark.parametrize(
    ("last", "u", "end", "agrees"),
    [
        # 9.2.3: four rectangular quantities with u = 1; analytic end 2 sqrt(3) (2 - (3/5)^(1/4))
        (1.0, 2.0, 2 * np.sqrt(3.0) * (2.0 - 0.6**0.25), 1),
        # 9.2.4, table 4: one of them ten times as wide; first order says 19.9, draws say 17.0
        (10.0, 10.1, 17.0, 0),
    ],
)
def test_additive_model_of_jcgm_101(last, u, end, agrees):
    half = np.sqrt(3.0) * np.array([1.0, 1.0, 1.0, last])

    def model(random, m):
        return random.uniform(-half[:, None], half[:, None], (4, m)).sum(axis=0)

    first = np.zeros(1), np.array([np.sqrt(3.0 + last**2)])
    plan = replace(TWO_DIGITS, digits=1) if agrees else TWO_DIGITS
    found = drawn(model, plan, first_order=first)
    assert found.u[0] == pytest.approx(u, rel=0.006)
    assert [-found.low[0], found.high[0]] == pytest.approx([end, end], rel=0.012)
    assert found.agrees[0] == agrees


@pytest.mark.parametrize(
    ("x", "mean", "u", "high"),
    [(0.0, 50.0, 50.0, -50.0 * np.log(0.05)), (0.010, 150.0, 112.0, 367.0)],
)
def test_comparison_loss_of_jcgm_101(x, mean, u, high):
    """9.4, in units of 1e-6: X1^2 + X2^2 with u = 0.005, the shortest interval begins at zero."""

    def model(random, m):
        first, second = x + 0.005 * random.standard_normal(m), 0.005 * random.standard_normal(m)
        return 1e6 * (first**2 + second**2)

    found = drawn(model, first_order=(np.array([1e6 * x**2]), np.array([1e4 * x])))
    assert [found.mean[0], found.u[0]] == pytest.approx([mean, u], rel=0.006)
    assert found.low[0] == pytest.approx(0.0, abs=3.0)
    assert found.high[0] == pytest.approx(high, rel=0.012)
    assert found.agrees[0] == 0


def test_the_numerical_tolerance_is_that_of_jcgm_101():
    """7.9.2: u = 0.000 35 g with two digits, 2 K with one; 9.96 reads 10 with two digits."""
    np.testing.assert_allclose(numerical_tolerance(np.array([0.00035]), 2), 5e-6)
    np.testing.assert_allclose(numerical_tolerance(np.array([2.0]), 1), 0.5)
    np.testing.assert_allclose(numerical_tolerance(np.array([9.96, 9.94]), 2), [0.5, 0.05])
    assert numerical_tolerance(np.zeros(1), 2) == 0.0


def test_the_shortest_interval_is_that_of_brute_force():
    values = np.sort(np.random.default_rng(1).gamma(1.5, size=(3, 200)), axis=1)
    low, high = shortest_interval(values, 0.9)
    for row, a, b in zip(values, low, high, strict=True):
        pairs = [(y - x, x) for x in row for y in row if np.mean((row >= x) & (row <= y)) > 0.9]
        assert (b - a, a) == min(pairs)


def test_it_goes_on_until_the_digits_stand_and_ends_where_it_must():
    one = Corrections.of([Part("x", np.array([[1.04e-3], [9.9e-3]]))], 2)

    def values(random, m):
        return one.values_mm(one.draw(random, m))

    coarse, fine = (propagate(values, Plan(digits=d, most_draws=60_000)) for d in (1, 3))
    assert coarse.stands.all() and (coarse.draws < 60_000).all()
    assert not fine.stands.any() and (fine.draws == 60_000).all()


def test_an_uncertainty_from_few_readings_has_a_t_distribution():
    """JCGM 101, 6.4.9.2, and one chi-square for all readings of a pool (their sum is as wide)."""
    pool = Pool("few", 8.0)
    both = Corrections.of([Part("x", np.full((1, 2), np.sqrt(0.5)), pool)], 1)
    found = propagate(lambda random, m: both.values_mm(both.draw(random, m)), TWO_DIGITS)
    end = stats.t.ppf(0.975, 8)
    assert [-found.low[0], found.high[0]] == pytest.approx([end, end], rel=0.015)


STATED = (
    "\n[uncertainty]\nreading_um = 0.7\nreading_urad = 1.5\nsquareness_urad = 2.0\n"
    "positioning_um_per_m = 3.0\nmeasured_at_mm = 4.0\n"
)


def test_corrections_of_two_walls_against_gtc(tmp_path):
    """EXX and EBX straight, so that nothing bends; GTC carries the covariance of two points.

    ``X'`` carries the workpiece: the arm of its angle goes from the reflector R to the tip.
    """
    at = (-50.0, 10.0, -120.0)
    errors = {"EXX": (lambda x: 0.02 * x, at), "EBX": (lambda x: 0.1 * x, None)}
    folder = tmp_path
    job = write_job(folder, errors, squareness=STATED)
    _, prediction = predict_points(job, folder / "points.csv")
    rows = np.flatnonzero(np.abs(prediction.normals[prediction.is_cut][:, 0]) == 1.0)[[0, 5]]
    states = prediction.states[rows]
    found = point_corrections(prediction, rows).signature_mm

    knots = np.arange(-400.0, 1.0, 10.0)
    length = [GTC.ureal(2e-5 * x, 0.7e-3) for x in knots]
    angle = [GTC.ureal(1e-7 * x, 1.5e-6) for x in knots]
    scale, place, lean = GTC.ureal(0, 3e-6), GTC.ureal(at[2], 4.0), GTC.ureal(0, 2e-6)

    def between(table, x):
        k = int((x + 400.0) // 10.0)
        share = (x - knots[k]) / 10.0
        return (1 - share) * table[k] + share * table[k + 1]

    points = []
    for nose, contact, normal in zip(
        states.nose_mm, states.contact_mm, prediction.normals[prediction.is_cut][rows], strict=True
    ):
        # the tip below the nose by 100 mm; X' carries the workpiece past Y and Z of the tool
        arm = nose[2] - 100.0 + contact[2] - place
        error = between(length, nose[0]) + (nose[0] + 400.0) * scale
        # the line of Y leans: C turns a way along Y into one along -X
        error = error + between(angle, nose[0]) * arm - lean * nose[1]
        points.append(float(normal[0]) * error)
    expected = [[GTC.get_covariance(a, b) for a in points] for b in points]
    np.testing.assert_allclose(found @ found.T, expected, rtol=1e-3)


def test_tables_apart_by_direction_and_lines_beyond_them_against_gtc():
    """Every direction has readings of its own; a line that goes on carries both its points."""
    knots, u_um = np.arange(-300.0, -99.0, 50.0), 0.8
    there = np.array([-200.0, -185.0, -185.0, -185.0, -360.0, -40.0, -40.0])
    way = np.array([1, 1, -1, 0, 1, 1, -1])
    plain = machine_from_arrays(
        "m", travel_mm={a: (-400.0, 0.0) for a in "XYZ"}, extrapolation="linear",
        errors={"EZX": (knots, 0.01 * knots, 0.01 * knots + 3.0)},
    )  # fmt: skip
    stated = MeasuringUncertainty(u_um * 1e-3, 1e-12, 1e-12)
    machine = replace(plain, uncertainty=stated, separate_directions=True)
    nose, ways = np.zeros((2, len(there), 3))
    nose[:, 0], ways[:, 0] = there, way
    causes = TableUncertainty.of(machine).causes(machine, nose, 0 * nose, Variant.HTM, ways)
    found = np.hstack([1e3 * c.lever.shift_mm[:, 2:] * c.size for c in causes])

    # the mean of two independent readings has the stated uncertainty
    both = [[GTC.ureal(0, np.sqrt(2.0) * u_um) for _ in knots] for _ in "fb"]
    mean = [0.5 * (f + b) for f, b in zip(*both, strict=True)]
    expected = []
    for x, sign in zip(there, way, strict=True):
        table = {1: both[0], -1: both[1], 0: mean}[sign]
        k = int(np.clip((x + 300.0) // 50.0, 0, len(knots) - 2))
        share = (x - knots[k]) / 50.0
        expected.append((1 - share) * table[k] + share * table[k + 1])
    covariance = [[GTC.get_covariance(a, b) for a in expected] for b in expected]
    np.testing.assert_allclose(found @ found.T, covariance, rtol=1e-6, atol=1e-6)


def test_a_line_beyond_a_curved_table_is_as_uncertain_as_the_curve_is_bent():
    """A table of a parabola without noise: the line misses it by f'' s (s + h) / 2 at s beyond."""
    knots, second = np.arange(-300.0, -99.0, 50.0), 2e-3
    machine = replace(
        machine_from_arrays(
            "m", travel_mm={a: (-400.0, 0.0) for a in "XYZ"}, extrapolation="linear",
            errors={"EZX": (knots, 0.5 * second * knots**2)},
        ),
        uncertainty=MeasuringUncertainty(1e-12, 1e-12, 1e-12),
    )  # fmt: skip
    nose = np.array([[-20.0, 0.0, 0.0], [-400.0, 0.0, 0.0]])
    line = 1e3 * machine.components["EZX"].evaluate(nose[:, 0])
    causes = TableUncertainty.of(machine).causes(machine, nose, 0 * nose, Variant.HTM)
    found = np.hstack([1e3 * c.lever.shift_mm[:, 2:] * c.size for c in causes])
    missed = 0.5 * second * nose[:, 0] ** 2 - line
    np.testing.assert_allclose(np.linalg.norm(found, axis=1), np.abs(missed), rtol=1e-6)


def test_curved_effects_against_draws_of_the_law_itself(tmp_path):
    """Spindle growth with an uncertain size and time constant, both of which the draws bend."""
    more = (
        "[effects.spindle_growth.Z]\ngrowth_um = 40\ntime_constant_s = 60\nspeed_exponent = 0.7\n"
        '[[fitted]]\neffect = "spindle_growth"\ntarget = "Z"\n'
        "one_sigma = [{growth_um = 8.0}, {time_constant_s = 6.0}]\n"
    )
    job = write_job(tmp_path, more=more)
    _, prediction = predict_points(job, tmp_path / "points.csv")
    floor = int(np.flatnonzero(prediction.normals[prediction.is_cut][:, 2] > 0.99)[-1])
    warm_s = prediction.states.time_s[floor] - 5.0  # the spindle turns after the tool change
    random = np.random.default_rng(4)
    size = 40.0 + 8.0 * random.standard_normal(100_000)
    time_s = 60.0 + 6.0 * random.standard_normal(100_000)
    law = size * (6000 / 8000) ** 0.7 * -np.expm1(-warm_s / time_s)
    parameters = point_corrections(prediction, np.array([floor]))
    own = [k for k, label in enumerate(parameters.labels) if label.endswith("parameters")]
    assert len(own) == 2
    only = replace(parameters, signature_mm=np.where(
        np.isin(np.arange(len(parameters.labels)), own), parameters.signature_mm, 0.0))  # fmt: skip
    moved = propagate(lambda r, m: only.values_mm(only.draw(r, m)), TWO_DIGITS)
    at_size = 40.0 * (6000 / 8000) ** 0.7 * -np.expm1(-warm_s / 60.0)
    sign = np.sign(prediction.deviation_mm[prediction.is_cut][floor])
    expected = sign * 1e-3 * (law - at_size)
    assert moved.u[0] == pytest.approx(expected.std(), rel=0.03)
    assert moved.mean[0] == pytest.approx(expected.mean(), abs=0.03 * expected.std())
    ends = shortest_interval(np.sort(expected)[None], 0.95)
    assert moved.low[0] == pytest.approx(ends[0][0], abs=0.12 * expected.std())
    assert moved.high[0] == pytest.approx(ends[1][0], abs=0.12 * expected.std())


def test_draws_confirm_first_order_and_rank_what_it_comes_from(tmp_path):
    errors = {"EXX": (lambda x: 0.02 * x, (0, 0, 0)), "EBX": (lambda x: 0.1 * x, None)}
    job = write_job(tmp_path, errors, squareness="\n[uncertainty]\nreading_um = 3.0\n")
    points, prediction = predict_points(job, tmp_path / "points.csv")
    found = draw_points(prediction, Plan(most_draws=200_000))
    np.testing.assert_allclose(found.drawn.u, found.first_order_u_mm, rtol=0.02, atol=1e-9)
    assert (found.drawn.agrees != 0).all()
    walls = np.abs(prediction.normals[prediction.is_cut][:, 0]) == 1.0
    assert set(found.largest()[walls]) == {"EXX readings"}
    total = sum(found.share.values())
    np.testing.assert_allclose(total[found.first_order_u_mm > 0], 1.0)
    again = draw_points(prediction, Plan(most_draws=200_000))
    np.testing.assert_array_equal(found.drawn.low, again.drawn.low)
    straight = recut(points, prediction, Plan())
    assert straight.not_straight_mm < 1e-4 and not straight.changed.any()
    every = point_corrections(prediction, np.arange(int(prediction.is_cut.sum())))
    np.testing.assert_allclose(every.u_mm, found.first_order_u_mm)


def test_points_that_change_state_are_counted(tmp_path):
    """A floor point 2 um from the wall is under the wall in about half of all draws."""
    errors = {"EXX": (lambda x: 0.0 * x, (0, 0, 0))}
    job = write_job(tmp_path, errors, squareness="\n[uncertainty]\nreading_um = 20.0\n")
    (tmp_path / "edge.csv").write_text(
        "id,feature,x,y,z,i,j,k\nedge,floor,19.998,0,-8,0,0,1\nmiddle,floor,0,0,-8,0,0,1\n"
    )
    points, prediction = predict_points(job, tmp_path / "edge.csv")
    assert prediction.is_cut.all()
    found = recut(points, prediction, Plan(seed=2))
    assert found.changed[1] == 0 and 1 <= found.changed[0] < found.draws


def test_intervals_hold_the_truth_of_simulated_machines(tmp_path):
    """95 % of 150 machines, within three standard deviations of such a count."""
    place, plan = workshop(tmp_path, at_positions=True), Plan(most_draws=20_000)
    inside, count = 0, 150
    for number, trial in enumerate(trials(place, count, seed=11)):
        row = number % len(trial.true_mm)
        found = point_corrections(trial.predicted, np.array([row]))
        ends = propagate(lambda r, m, c=found: c.values_mm(c.draw(r, m)), plan)
        off = trial.true_mm[row] - trial.predicted.deviation_mm[trial.predicted.is_cut][row]
        inside += bool(ends.low[0] <= off <= ends.high[0])
    assert abs(inside / count - 0.95) < 3 * np.sqrt(0.95 * 0.05 / count)


def test_volumetric_accuracy_against_machines_with_corrections():
    """Squareness and length scale alone: 1,500 machines that have them, every pair of points."""
    travel = {"X": (-400.0, 0.0), "Y": (-300.0, 0.0), "Z": (-300.0, 0.0)}
    knots = {"EXX": np.array([-400.0, 0.0]), "EYY": np.array([-300.0, 0.0])}

    def machine(square, scale):
        errors = {n: (k, 1e-3 * scale * (k - k[0])) for n, k in knots.items()}
        return machine_from_arrays("m", travel_mm=travel, errors=errors, squareness_urad=square)

    def largest(one):
        errors = error_field(one, volume, np.zeros(3), Variant.HTM).error_mm
        return pdist(errors).max()

    volume = Volume(np.array([-400.0, -300.0, -300.0]), np.zeros(3), (3, 3, 3))
    stated = MeasuringUncertainty(1e-12, 1e-12, 4e-6, 9e-6)
    known = replace(machine({"EC0Y": 12.0}, 0.0), uncertainty=stated)
    field = error_field(known, volume, np.zeros(3), Variant.HTM)
    found = draw_accuracy(known, field, np.zeros(3), Variant.HTM, Plan())
    random = np.random.default_rng(8)
    brute = np.sort([
        largest(machine({"EC0Y": 12.0 + 4 * a, "EB0X": 4 * b, "EA0Y": 4 * c}, 9.0 * d))
        for a, b, c, d in random.standard_normal((1500, 4))
    ])  # fmt: skip
    assert found.stated_mm[0] == pytest.approx(largest(known))
    error = brute.std() / np.sqrt(len(brute))
    assert found.drawn.mean[0] == pytest.approx(brute.mean(), abs=3.0 * error)
    assert found.drawn.mean[0] > 1.1 * found.stated_mm[0]  # a largest difference grows with doubt
    assert found.drawn.u[0] == pytest.approx(
        brute.std(), abs=3.0 * error
    )  # more than its own error
    ends = shortest_interval(brute[None], 0.95)
    assert found.drawn.low[0] == pytest.approx(ends[0][0], abs=0.2 * brute.std())
    assert found.drawn.high[0] == pytest.approx(ends[1][0], abs=0.2 * brute.std())
    assert found.missed_mm == pytest.approx(0.0, abs=1e-12)


def test_shares_of_the_doubt_in_the_volumetric_accuracy():
    """The worst pair lies 400 mm apart along X and 300 along Y, and its errors differ along X.

    By 4 urad of squareness that is 1.2 um, by 9 um/m of scale 3.6 um; Z does not count.
    """
    travel = {"X": (-400.0, 0.0), "Y": (-300.0, 0.0), "Z": (-300.0, 0.0)}
    errors = {"EXX": (np.array([-400.0, 0.0]), np.array([0.0, 0.004]))}
    one = machine_from_arrays("m", travel_mm=travel, errors=errors, squareness_urad={"EC0Y": 12.0})
    stated = MeasuringUncertainty(1e-12, 1e-12, 4e-6, 9e-6)
    known = replace(one, uncertainty=stated)
    volume = Volume(np.array([-400.0, -300.0, -300.0]), np.zeros(3), (3, 3, 3))
    field = error_field(known, volume, np.zeros(3), Variant.HTM)
    found = draw_accuracy(known, field, np.zeros(3), Variant.HTM, Plan())
    assert list(found.share)[:2] == ["scale of positioning", "EC0Y"]  # the largest first
    assert list(found.share.values())[:2] == pytest.approx([12.96 / 14.4, 1.44 / 14.4], abs=1e-9)
    assert sum(found.share.values()) == pytest.approx(1.0)
