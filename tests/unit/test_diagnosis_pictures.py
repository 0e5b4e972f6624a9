"""Pictures of a diagnosis against sums written out here: classes, chances, places of the marks."""

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2, norm

from tests.small_job import (
    measurement,
    pocket_points,
    write_job,
    write_nominal_stl,
    write_points,
)
from tests.unit.test_diagnosis_verdicts import lost_motion, tip_job
from vmach.diagnosis.diagnose import diagnose
from vmach.diagnosis.page.covariate_panels import covariate_panels
from vmach.diagnosis.page.heading import quantity
from vmach.diagnosis.page.instrument_pictures import instrument_pictures
from vmach.diagnosis.page.residual_map import residual_map
from vmach.diagnosis.residuals import Residuals
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.fit.base import Base
from vmach.fit.marginal_likelihood import Effects, Posterior
from vmach.fit.noise.discrepancy import members_of
from vmach.fit.noise.feature_noise import FeatureNoise
from vmach.fit.sizes import Sizes
from vmach.nominal import read_nominal
from vmach.report.page.svg_plot import Frame, number_text, ticks

ERRORS = {"EXX": (lambda x: 3.0 * np.sin(x / 40.0), (0, 0, -100))}


def measured_part(folder):
    """The survey of a pocket that is 8 um too short in X, with 0.5 um of noise."""
    job = write_job(folder, ERRORS)
    names, points, normals = pocket_points()
    short = np.isin(names, ["wall +X", "wall -X"])
    away_um = 0.5 * np.random.default_rng(3).standard_normal(len(points)) + 4.0 * short
    write_points(folder / "points.csv", points + 1e-3 * away_um[:, None] * normals)
    return survey_job(job)


def residuals_of(survey):
    members = members_of(survey)
    single = FeatureNoise(survey.u_mm, survey.group, np.ones(len(survey)))
    base = Base(survey, single, members)
    sizes = Sizes(1.0, (0.0,) * len(members.names))
    return Residuals(survey, Posterior(base, sizes, Effects(base.no_columns)), None)


@pytest.fixture(scope="module")
def part(tmp_path_factory):
    return residuals_of(measured_part(tmp_path_factory.mktemp("part")))


@pytest.fixture(scope="module")
def lost(tmp_path_factory):
    """A diagnosis that names the lost motion of X."""
    return diagnose(survey_job(tip_job(tmp_path_factory.mktemp("tip"), lost_motion)))


def dense_covariance(residuals, extra=None):
    noise = residuals.noise
    size = noise.sizes.each[noise.base.member_of]
    members = noise.base.members.every_mm * np.where(size > 0.025, size, 0.0)  # the least is none
    causes = members if extra is None else np.hstack([members, extra])
    u_mm = noise.sizes.factor * residuals.survey.u_mm
    return np.diag(u_mm**2) + causes @ causes.T


def alignment(survey):
    """The matrix that takes an alignment by weighted least squares off the readings."""
    weighted = survey.nuisance / survey.u_mm[:, None]
    hat = survey.nuisance @ np.linalg.pinv(weighted) / survey.u_mm
    return np.eye(len(survey)) - hat


def generalised_sum(columns, readings, covariance):
    """Smallest sum of squares of readings in a covariance, with columns free."""
    root = np.linalg.cholesky(covariance)
    white, target = np.linalg.solve(root, columns), np.linalg.solve(root, readings)
    left = target - white @ np.linalg.lstsq(white, target, rcond=1e-10)[0]
    return left @ left, np.linalg.matrix_rank(white, tol=1e-6 * np.linalg.norm(white, 2))


def test_means_of_classes_and_their_bars(part):
    off = alignment(part.survey)
    aligned, covariance = off @ part.survey.residual_mm, off @ dense_covariance(part) @ off.T
    panels = covariate_panels(part)
    assert {panel.covariate.by for panel in panels} >= {"feature", "axis position", "direction"}
    for panel in panels:
        for number in range(len(panel.covariate)):
            own = np.flatnonzero(panel.covariate.number == number)
            found = panel.means["before"]
            assert found.mean_mm[number] == pytest.approx(aligned[own].mean(), abs=1e-12)
            spread = np.sqrt(max(covariance[np.ix_(own, own)].mean(), 0.0))
            assert found.u_mm[number] == pytest.approx(spread, rel=1e-6, abs=1e-9)
        assert set(panel.chance) == set(panel.means) == {"before"}


def test_chances_are_those_of_a_fit_with_and_without_the_classes(part):
    # the whitening leaves out what changes a variance by less than one per cent
    survey, covariance = part.survey, dense_covariance(part)
    plain, rank = generalised_sum(survey.nuisance, survey.residual_mm, covariance)
    for panel in covariate_panels(part):
        classes = np.hstack([survey.nuisance, panel.covariate.is_in])
        fitted, richer = generalised_sum(classes, survey.residual_mm, covariance)
        expected = chi2.sf(plain - fitted, richer - rank) if richer > rank else 1.0
        assert np.log(panel.chance["before"].p) == pytest.approx(
            np.log(expected), rel=0.02, abs=0.02
        )


def test_the_clearest_dependence_comes_first(part):
    panels = covariate_panels(part)
    chances = [panel.chance["before"] for panel in panels]
    assert chances[0].p < 1e-9
    deviates = [chance.deviate for chance in chances]
    assert deviates == sorted(deviates, reverse=True)
    for chance in chances:
        if 1e-9 < chance.p < 1.0:
            assert chance.deviate == pytest.approx(norm.isf(chance.p), abs=0.05)
    feature = next(panel for panel in panels if panel.covariate.by == "feature")
    clearest = np.argsort(-feature.means["before"].clear)[:2]
    assert {feature.covariate.words[k] for k in clearest} == {"feature wall +X", "feature wall -X"}


def test_after_the_effect_the_classes_are_noise(lost):
    residuals = lost.residuals
    panels = {panel.covariate.title: panel for panel in covariate_panels(residuals)}
    direction = panels["direction of X"]
    assert direction.chance["before"].p < 1e-9 < direction.chance["after"].p
    off = alignment(residuals.survey)
    left = off @ (residuals.survey.residual_mm - lost.residuals.explained_mm)
    means = direction.means["after"]
    for number in range(len(direction.covariate)):
        own = np.flatnonzero(direction.covariate.number == number)
        assert means.mean_mm[number] == pytest.approx(left[own].mean(), abs=1e-12)
        assert abs(means.mean_mm[number]) < 4 * means.u_mm[number]
    assert lost.rms_um["after"] == pytest.approx(1e3 * np.sqrt(np.mean(left**2)))


def test_what_a_law_leaves_open_widens_the_bars_after_it(lost):
    survey, fit = lost.residuals.survey, lost.residuals.fit
    slack = 1e-3 * np.random.default_rng(5).standard_normal((len(survey), 2)).cumsum(axis=0)
    open_law = replace(lost.residuals, fit=replace(fit, slack_mm=slack))
    off = alignment(survey)
    before, after = dense_covariance(open_law), dense_covariance(open_law, slack)
    weights = np.random.default_rng(6).standard_normal((3, len(survey)))
    for covariance, is_after in ((before, False), (after, True)):
        expected = np.sqrt(np.diag(weights @ off @ covariance @ off.T @ weights.T))
        found = open_law.class_u_mm(weights, after=is_after)
        np.testing.assert_allclose(found, expected, rtol=1e-6)
    alone = np.sqrt(np.diag(off @ slack @ slack.T @ off.T))
    np.testing.assert_allclose(open_law.open_mm, alone, rtol=1e-6)


def dots(svg, kind):
    """Pixels of the dots of one kind, (n, 2)."""
    (path,) = re.findall(rf'<path class="dots {kind}[ a-z]*" d="([^"]*)"', svg)
    return np.array(re.findall(r"M([\d.]+) ([\d.]+)h0", path), dtype=float)


def test_dots_lie_where_the_readings_are(part):
    panels = {panel.covariate.title: panel for panel in covariate_panels(part)}
    panel = panels["position of X, mm"]
    pixels = dots(panel.svg, "before")
    x, y = part.survey.paths[0].nose_mm[:, 0], part.before_mm
    assert len(pixels) == len(x)
    inside = np.abs(y) < np.quantile(np.abs(y), 0.9)
    for values, column in ((x, pixels[:, 0]), (y, pixels[:, 1])):
        slope, start = np.polyfit(values[inside], column[inside], 1)
        np.testing.assert_allclose(column[inside], start + slope * values[inside], atol=0.11)
    assert np.polyfit(y[inside], pixels[inside, 1], 1)[0] < 0  # more material is further up


def test_a_row_for_every_class_up_to_what_fits(part):
    feature = next(p for p in covariate_panels(part) if p.covariate.by == "feature")
    assert feature.svg.count('class="name end"') == len(feature.covariate) - feature.hidden_rows


def test_map_carries_the_residuals_at_the_points(part, tmp_path):
    write_nominal_stl(tmp_path / "part.stl")
    on_cad = residual_map(part, read_nominal(tmp_path / "part.stl").mesh)
    discs = residual_map(part, None)
    for found in (on_cad, discs):
        np.testing.assert_allclose(found.points.point_mm, pocket_points()[1], atol=0.02)
        np.testing.assert_array_equal(found.points["before"].deviation_mm, part.before_mm)
        (still,) = found.stills().values()
        assert still.getpixel((0, 0)) == (255, 255, 255, 255)
        assert len(np.unique(np.asarray(still).reshape(-1, 4), axis=0)) > 50
    sides = len(discs.mesh.vertices_mm) // len(part.survey)
    middle = discs.mesh.vertices_mm.reshape(-1, sides, 3).mean(axis=1)
    np.testing.assert_allclose(middle, discs.points.point_mm, atol=1e-9)
    colours = discs.mesh.colourings["before"].value_mm.reshape(-1, sides)
    np.testing.assert_array_equal(colours, np.tile(part.before_mm[:, None], sides))


def test_without_a_part_there_is_no_map(lost):
    assert residual_map(lost.residuals, None) is None


INSTRUMENTS = (
    measurement("ballbar", plane="YZ", centre_mm=[-200, -150, -100], radius_mm=80)
    + measurement("laser", axis="Y", at_mm=[-200, 0, -100])
    + measurement("drift", at_mm=[-200, -150, -100])
)


@pytest.fixture(scope="module")
def instruments(tmp_path_factory):
    """Readings without noise on a perfect machine: a clover of 5 um, a line, a growth in Z."""
    folder = tmp_path_factory.mktemp("instruments")
    text = write_job(folder, more=INSTRUMENTS).read_text().replace('measured = "points.csv"\n', "")
    (folder / "job.toml").write_text(text)
    angle = np.arange(0.0, 360.0, 5.0)
    clover = 7.0 + 5.0 * np.cos(3 * np.radians(angle))
    rows = [f"ccw,1000,{a},{100 + a / 5},{r}" for a, r in zip(angle, clover, strict=True)]
    (folder / "ballbar.csv").write_text(
        "\n".join(["run,feed_mm_min,angle_deg,t_s,radius_um", *rows])
    )
    y = np.arange(-290.0, 0.0, 20.0)
    there = [f"1,{p},1,{5 * k},{0.02 * p}" for k, p in enumerate(y)]
    back = [f"1,{p},-1,{100 + 5 * k},{0.02 * p + 3}" for k, p in enumerate(y[::-1])]
    heading = "run,position_mm,approach,t_s,deviation_um"
    (folder / "laser.csv").write_text("\n".join([heading, *there, *back]))
    grown = [f"{60 * k},6000,0,0,{0.5 * k}" for k in range(30)]
    (folder / "drift.csv").write_text("\n".join(["t_s,spindle_rpm,dx_um,dy_um,dz_um", *grown]))
    survey = survey_job(folder / "job.toml")
    return instrument_pictures(residuals_of(survey))


def test_ballbar_is_drawn_round_its_circle(instruments):
    (picture,) = [p for p in instruments if p.title.startswith("Ballbar")]
    ((title, svg),) = picture.plots
    assert title == "ccw 1000 mm/min"
    assert re.findall(r">\+([XYZ])<", svg) == ["Y", "Z"]
    pixels = dots(svg, "measured") - 150.0
    angle = np.radians(np.arange(0.0, 360.0, 5.0))
    np.testing.assert_allclose(
        np.arctan2(-pixels[:, 1], pixels[:, 0]) % (2 * np.pi), angle, atol=2e-3
    )
    radius = np.linalg.norm(pixels, axis=1)
    # the mean radius is free; three leaves of the same size are left
    outside = radius - radius.mean()
    np.testing.assert_allclose(outside, outside.max() * np.cos(3 * angle), atol=0.15)


def test_laser_line_is_drawn_for_each_side(instruments):
    (picture,) = [p for p in instruments if p.title.startswith("Laser")]
    assert [title for title, _ in picture.plots] == ["positions approached forwards", "backwards"]
    forwards, backwards = (dots(svg, "measured") for _, svg in picture.plots)
    assert len(forwards) == len(backwards) == 15
    order = np.argsort(backwards[:, 0])
    np.testing.assert_allclose(forwards[:, 0], backwards[order, 0])
    gap = forwards[:, 1] - backwards[order, 1]
    assert gap.min() > 10 and np.ptp(gap) < 0.25  # 3 um of lost motion, everywhere alike


def test_drift_is_drawn_against_time(instruments):
    (picture,) = [p for p in instruments if p.title.startswith("Drift")]
    still, _, growing = (dots(svg, "measured") for _, svg in picture.plots)
    assert np.ptp(still[:, 1]) < 0.11
    assert (np.diff(growing[:, 1]) < 0).all() and (np.diff(growing[:, 0]) > 0).all()


def test_tool_tip_is_drawn_as_measured_against_predicted(lost):
    (picture,) = instrument_pictures(lost.residuals)
    assert [title for title, _ in picture.plots] == [f"component {axis}" for axis in "XYZ"]
    along_x = picture.plots[0][1]
    spread = {}
    for state in ("before", "after"):
        pixels = dots(along_x, state)
        spread[state] = np.std(pixels[:, 0] + pixels[:, 1])  # across the diagonal
    assert spread["after"] < 0.5 * spread["before"]


@pytest.mark.parametrize(("low", "high"), [(-5.0, 5.0), (0.0, 0.003), (-941.0, -12.0)])
def test_ticks_are_round_and_inside(low, high):
    found = ticks(low, high)
    assert 2 <= len(found) <= 7
    assert found.min() >= low - 1e-9 and found.max() <= high + 1e-9
    step = np.diff(found)
    np.testing.assert_allclose(step, step[0])
    assert f"{step[0]:.0e}"[0] in "125"


def test_numbers_for_people():
    assert [number_text(v, signed=True) for v in (2.5, -3.0, 0.0)] == ["+2.5", "−3", "0"]


def test_what_lies_outside_a_frame_is_drawn_on_its_edge():
    frame = Frame((0.0, 10.0), (-1.0, 1.0), left=0.0, right=0.0, top=0.0, bottom=0.0)
    assert frame.columns(np.array([-5.0, 5.0, 50.0])).tolist() == [0.0, 210.0, 420.0]
    assert frame.rows(np.array([2.0, 0.0, -2.0])).tolist() == [0.0, 110.0, 220.0]


@pytest.mark.parametrize(
    ("name", "value", "interval", "shown"),
    [
        ("reversal_um", 7.0662, (6.7812, 7.3512), ("7.07", "6.78", "7.35", "µm")),
        ("time_constant_s", 2704.3, (920.9, 7934.0), ("2700", "900", "7900", "s")),
        ("squareness_urad", -52.97, (-55.23, -50.7), ("−53.0", "−55.2", "−50.7", "µrad")),
        ("work_share", 0.04, (0.01, 0.29), ("0.04", "0.01", "0.29", "")),
    ],
)
def test_values_have_the_digits_that_their_interval_leaves(name, value, interval, shown):
    assert quantity(name, value, interval) == shown
