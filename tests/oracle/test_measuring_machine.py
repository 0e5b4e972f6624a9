"""What the machine that measured a part adds: closed forms, and parts of a known device.

The experiments are those of `tests/hidden_effects`, which share no code with the program; clamping
and drift are written into their readings here.
"""

import csv
import json

import numpy as np
import pytest

from tests.hidden_effects import program_runs
from tests.hidden_effects.experiment import make_experiment
from tests.hidden_effects.verdict import judge
from tests.small_job import PROGRAM, measurement, pocket_points, write_job, write_points
from vmach.diagnosis.diagnose import diagnose
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.errors import InputError
from vmach.fit.noise.measuring_machine import (
    clampings,
    drift_of_device,
    stated_of_device,
    steady_drifts_of_device,
)
from vmach.nominal.points import read_points_csv

UM = 1e-3


def pocket_survey(folder, told="", **columns):
    """The survey of a pocket; `told` of the measuring machine, and further columns by name."""
    folder.mkdir(exist_ok=True)
    job = write_job(folder, {})
    job.write_text(job.read_text() + f"\n[measuring_machine]\n{told}\n")
    write_points(folder / "points.csv")
    add_columns(folder / "points.csv", **columns)
    return survey_job(job)


def add_columns(path, **columns):
    heading, *rows = path.read_text().splitlines()
    for name, values in columns.items():
        heading += f",{name}"
        rows = [f"{row},{value}" for row, value in zip(rows, values, strict=True)]
    path.write_text("\n".join([heading, *rows]) + "\n")


def added(survey, plain):
    """Covariance that a survey's device has beyond that of another one, (n, n) mm²."""
    own, other = (np.hstack([*stated_of_device(s).values()]) for s in (survey, plain))
    return own @ own.T - other @ other.T


def test_a_form_of_the_probing_is_a_wave_of_that_range(tmp_path):
    plain = pocket_survey(tmp_path / "plain")
    formed = pocket_survey(tmp_path / "formed", "probing_form_um = 2.0")
    more = added(formed, plain)
    _, _, normal = pocket_points()
    is_wall = normal[:, 2] == 0.0
    # half the square of the amplitude, which is half the range
    np.testing.assert_allclose(np.diag(more)[is_wall], (2.0 * UM) ** 2 / 8.0, rtol=1e-9)
    np.testing.assert_allclose(np.diag(more)[~is_wall], 0.0, atol=1e-18)
    # opposite walls: a wave that goes round twice is the same, three times the opposite
    east, west = (np.flatnonzero(normal[:, 0] == side)[0] for side in (1.0, -1.0))
    assert more[east, west] == pytest.approx(0.0, abs=1e-15)


def test_points_of_a_feature_have_what_is_stated_in_common(tmp_path):
    plain = pocket_survey(tmp_path / "plain")
    more = added(pocket_survey(tmp_path / "own", "feature_u_um = 0.7"), plain)
    feature, _, _ = pocket_points()
    same = feature[:, None] == feature
    np.testing.assert_allclose(more, (0.7 * UM) ** 2 * same, rtol=1e-9, atol=1e-18)


def test_a_clamping_shifts_and_turns_its_points_alone(tmp_path):
    half = len(pocket_points()[0]) // 2
    names = ["first"] * half + ["second"] * (len(pocket_points()[0]) - half)
    plain = pocket_survey(tmp_path / "plain")
    told = pocket_survey(tmp_path / "told", "clamping_u_um = 3.0", clamping=names)
    more = added(told, plain)
    np.testing.assert_allclose(more[:half, half:], 0.0, atol=1e-18)
    _, points, normal = pocket_points()
    arm = points - points.mean(axis=0)
    long = max(0.5 * np.ptp(points, axis=0).max(), 25.0)
    turned = np.cross(arm / long, normal)
    expected = (3.0 * UM) ** 2 * (normal @ normal.T + turned @ turned.T)
    np.testing.assert_allclose(more[:half, :half], expected[:half, :half], atol=1e-12)
    assert clampings(told).shape[1] == 0  # its size is known
    assert clampings(pocket_survey(tmp_path / "asked", clamping=names)).shape[1] == 12
    assert clampings(pocket_survey(tmp_path / "one", clamping=["a"] * len(names))).shape[1] == 0


def test_readings_stand_in_the_order_of_measuring(tmp_path):
    count = len(pocket_points()[0])
    order = np.random.default_rng(4).permutation(count)
    survey = pocket_survey(tmp_path, order=order)
    (part,) = survey.measurements
    assert part.id.tolist() == (np.argsort(order) + 1).astype(str).tolist()
    assert part.measured_at.tolist() == list(range(count))
    drift = drift_of_device(survey)
    variance = np.einsum("nk,nk->n", drift, drift)
    assert variance.min() > 0.8 and variance.max() < 1.0 + 1e-9  # of unit size, linear between


def test_a_steady_drift_is_a_straight_line_in_the_order_of_measuring(tmp_path):
    """Of unit variance along its axis, whatever the clock began with; none without a clock."""
    count = len(pocket_points()[0])
    seconds = np.random.default_rng(6).permutation(count)
    survey = pocket_survey(tmp_path / "told", measured_s=1.7e9 + 3.0 * seconds)
    drifts = steady_drifts_of_device(survey)
    assert len(drifts) == 3
    for axis, drift in enumerate(drifts.values()):
        line = np.sqrt(3.0) * np.linspace(-1.0, 1.0, count)
        np.testing.assert_allclose(drift[:, 0], line * survey.sensing[:, axis], atol=1e-6)
    assert np.mean(line**2) == pytest.approx(1.0, rel=0.05)
    untold = steady_drifts_of_device(pocket_survey(tmp_path / "untold"))
    assert not any(drift.any() for drift in untold.values())


def test_a_clock_may_count_from_1970(tmp_path):
    count = len(pocket_points()[0])
    survey = pocket_survey(tmp_path, measured_s=1.7e9 + 3.0 * np.arange(count))
    drift = drift_of_device(survey)
    assert np.einsum("nk,nk->n", drift, drift).max() < 1.0 + 1e-9 < 1.0 + drift.max()


def test_a_clock_and_an_order_are_one_too_many(tmp_path):
    write_points(tmp_path / "points.csv")
    count = range(len(pocket_points()[0]))
    add_columns(tmp_path / "points.csv", order=count, measured_s=count)
    with pytest.raises(InputError, match=r"points\.csv:1: both measured_s and order say when"):
        read_points_csv(tmp_path / "points.csv")


TWO_PARTS = PROGRAM.replace("M5\nM30", "G55\nG0 X0 Y0 Z5" + PROGRAM.split("Z5", 1)[1])
SHIFT_UM, NOISE_UM = np.array([25.0, -40.0, 30.0]), 0.5


def survey_of_two_parts(folder, clamping):
    """A pocket in G54 and one in G55; the second lies elsewhere by some 50 um where it was read."""
    folder.mkdir()
    job = write_job(folder, {})
    (folder / "part.nc").write_text(TWO_PARTS)
    text = job.read_text().replace("max_mm = [60", "max_mm = [160")
    job.write_text(
        text.replace("[stock]", "G55 = [-100, -150, -200]\n[stock]").replace(
            "schema = 1", 'schema = 1\nworkpiece_zero = "G54"'
        )
    )
    names, points, normals = pocket_points()
    rows, random = [], np.random.default_rng(12)
    for k, shift_um in enumerate([np.zeros(3), SHIFT_UM]):
        here = points + np.array([100.0 * k, 0.0, 0.0])
        away_um = normals @ shift_um + random.normal(size=len(here), scale=NOISE_UM)
        told = np.hstack([here, normals, here + UM * away_um[:, None] * normals])
        for name, row in zip(names, told, strict=True):
            cells = [len(rows) + 1, f"{name} {k}", *row, NOISE_UM, clamping[k]]
            rows.append(",".join(map(str, cells)))
    heading = "id,feature,x,y,z,i,j,k,mx,my,mz,u_um,clamping"
    (folder / "points.csv").write_text("\n".join([heading, *rows]) + "\n")
    return survey_job(job)


def test_parts_that_were_measured_one_by_one_say_nothing_of_their_work_offsets(tmp_path):
    """A part lies anyhow in each clamping; in one clamping the machine shifted it between them."""
    alone = diagnose(survey_of_two_parts(tmp_path / "alone", "ab"))
    assert alone.verdict == "nothing"
    (note,) = (n for n in alone.notes if n.place == "clampings")
    assert note.sentence.endswith("such as a wrong work offset: they are those of G54 and G55")
    (found,) = diagnose(survey_of_two_parts(tmp_path / "together", "aa")).findings
    assert found.effect.name in {"fixture", "datum_shift"}  # G55 follows G54: both say the same
    for axis, shift_um in zip("xyz", SHIFT_UM, strict=True):
        low, high = found.interval_95[f"shift_{axis}_um"]
        assert low < shift_um < high


def moved_again(rows, place):
    """The second half of the part, clamped again: shifted and turned by some micrometres."""
    is_second = place[:, 0] > np.median(place[:, 0])
    turn = np.cross([5e-6, -8e-6, 12e-6], place - place.mean(axis=0))
    clamping = np.where(is_second, "second", "first")
    return is_second[:, None] * (UM * np.array([4.0, -3.0, 5.0]) + turn), "clamping", clamping


def drifted(rows, place):
    """Features in an order of chance, while the device drifts by some micrometres."""
    feature = np.array([row["feature"] for row in rows])
    names = np.unique(feature)
    turn = dict(zip(names, np.random.default_rng(5).permutation(len(names)), strict=True))
    order = np.argsort(np.argsort([turn[name] for name in feature], kind="stable"))
    wave = 6.0 * UM * np.sin(4.0 * order / len(rows))
    return wave[:, None] * [1.0, 0.3, -0.6], "order", order


@pytest.mark.parametrize(("effects", "seed"), [([], 7310001), (["backlash"], 7310002)])
@pytest.mark.parametrize("moved", [moved_again, drifted])
def test_what_the_device_did_is_told_from_what_the_machine_did(tmp_path, moved, effects, seed):
    make_experiment(tmp_path, effects=effects, seed=seed)
    file = tmp_path / "part_measured.csv"
    with file.open(newline="") as text:
        rows = list(csv.DictReader(text))
    shift, name, told = moved(rows, np.array([[float(row[a]) for a in "xyz"] for row in rows]))
    for row, own, value in zip(rows, shift, told, strict=True):
        row |= {f"m{a}": repr(float(row[f"m{a}"]) + float(own[k])) for k, a in enumerate("xyz")}
        row[name] = str(value)
    with file.open("w", newline="") as text:
        writer = csv.DictWriter(text, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)
    report, _ = program_runs.diagnose(tmp_path)
    found = judge(report, json.loads((tmp_path / "truth.json").read_text()))
    assert found.outcome == "right", found.said
    assert report["remains_um"] < 0.4
    assert any("counted as of the measurement" in note for note in report["notes"])


def test_a_device_that_is_hardly_known_may_be_what_was_seen(tmp_path):
    """A scale of -22 ppm within twice the uncertainty of the device's own: no axis is blamed."""
    make_experiment(tmp_path, effects=["scale"], seed=7410001)
    plain, _ = program_runs.diagnose(tmp_path)
    assert [effect["effect"] for effect in plain["effects"]] == ["scale"]
    job = tmp_path / "job.toml"
    job.write_text(job.read_text() + "\n[measuring_machine]\nscale_u_ppm = 10.0\n")
    report, _ = program_runs.diagnose(tmp_path)
    assert report["verdict"] == "nothing"
    (note,) = (note for note in report["notes"] if "counted as of the measurement" in note)
    assert "scales and squareness of the measuring machine: 1." in note


def lasered_job(folder, **told):
    """A true axis over 380 mm, measured by a laser that reads 30 ppm too much."""
    more = measurement("laser", axis="X", at_mm=[-200, -150, -150], u_um=0.3, **told)
    job = write_job(folder, {"EXX": (lambda x: 0.0 * x, (0, 0, -100))}, more=more)
    kept = [line for line in job.read_text().splitlines() if not line.startswith("measured")]
    job.write_text("\n".join(kept) + "\n")
    random, lines = np.random.default_rng(9), ["run,position_mm,approach,t_s,deviation_um"]
    place = np.linspace(-380.0, 0.0, 20)
    for k, (x, way) in enumerate((x, w) for w in (1, -1) for x in place[::w]):
        lines.append(f"1,{x},{way},{8.0 * k},{30e-3 * x + 0.3 * random.standard_normal():.3f}")
    (folder / "laser.csv").write_text("\n".join(lines) + "\n")
    return job


def test_a_laser_whose_scale_is_hardly_known_blames_no_axis(tmp_path):
    (tmp_path / "plain").mkdir()
    plain = diagnose(survey_job(lasered_job(tmp_path / "plain")))
    assert [finding.name for finding in plain.findings] == ["scale"]
    survey = survey_job(lasered_job(tmp_path, scale_u_ppm=20.0))
    found = diagnose(survey)
    assert found.verdict == "nothing"
    assert any("scale of the instrument: 3." in note.sentence for note in found.notes)
    (column,) = stated_of_device(survey)["scale of the instrument"].T
    place = survey.paths[0].nose_mm[:, 0]
    np.testing.assert_allclose(column - column[0], 20e-6 * (place - place[0]), atol=1e-15)
