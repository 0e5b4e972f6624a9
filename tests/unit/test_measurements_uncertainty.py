"""A stated uncertainty that is wrong in one row, or of one test of several, is asked about.

What is wrong is known here: every reading is noise of a known standard deviation.
"""

import numpy as np
import pytest

from tests.small_job import measurement, pocket_points, write_job
from vmach.base.note import Kind, Level
from vmach.checkup import check_job
from vmach.diagnosis.diagnose import diagnose
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.instruments import measure_part, read_instruments
from vmach.job import read_job
from vmach.path.preparation import prepare

NOISE_UM = 0.5


def measured(folder, u_um):
    """The file of the small job's points, each 0.5 um off by chance, with these uncertainties."""
    _, points, normals = pocket_points()
    noise = NOISE_UM * np.random.default_rng(2).standard_normal((len(points), 1))
    rows = np.hstack([points, normals, points + 1e-3 * noise * normals])
    lines = ["id,x,y,z,i,j,k,mx,my,mz,u_um"]
    lines += [f"{k},{','.join(map(repr, row.tolist()))},{u_um[k]}" for k, row in enumerate(rows)]
    (folder / "points.csv").write_text("\n".join(lines) + "\n")


@pytest.mark.parametrize(
    ("value", "said"),
    [
        ("1e-6", "u_um is 1e-06 um where the median is 0.5 um; accepted: 0.05 .. 5 um in this "
                 "file (hint: is it in um? This row weighs as much as 2.5e+11 others)"),
        ("5000", "u_um is 5000 um where the median is 0.5 um; accepted: 0.05 .. 5 um in this "
                 "file (hint: is it in um? 1e+08 such rows weigh as much as one other)"),
    ],
)  # fmt: skip
def test_one_row_of_another_uncertainty_is_doubted_with_its_line(tmp_path, value, said):
    job = write_job(tmp_path)
    u_um = ["0.5"] * len(pocket_points()[0])
    u_um[10] = value
    measured(tmp_path, u_um)
    part, _ = measure_part(prepare(read_job(job)), tmp_path / "points.csv")
    (note,) = [n for n in part.notes if n.kind is Kind.UNCERTAINTY]
    assert note.level is Level.DOUBT
    assert str(note) == f"points.csv:12: doubt: {said}"
    # the search names effects by that row; the doubt has to stand beside them
    assert str(note) in map(str, diagnose(survey_job(job)).notes)
    assert any("points.csv:12" in str(found) for found in check_job(job))


def test_uncertainties_that_differ_as_features_do_are_not_doubted(tmp_path):
    job = write_job(tmp_path)
    measured(tmp_path, np.random.default_rng(1).uniform(0.2, 1.5, len(pocket_points()[0])))
    part, _ = measure_part(prepare(read_job(job)), tmp_path / "points.csv")
    assert not [n for n in part.notes if n.kind is Kind.UNCERTAINTY]


def test_a_hole_of_another_uncertainty_is_doubted(tmp_path):
    program = ["G21 G17 G90", "T1 M6", "S3000 M3", "G54 G43 H1", "G0 X0 Y0 Z20"]
    rows = ["x,y,mx,my,u_um"]
    for k, (x, y) in enumerate((x, y) for y in (-20, 0, 20) for x in (-30, 10, 50)):
        program.append(f"{'G81 Z-10 R2 F300 ' if k == 0 else ''}X{x} Y{y}")
        rows.append(f"{x},{y},{x + 1e-4 * k},{y},{0.02 if k == 4 else 1}")
    job = write_job(tmp_path, more=measurement("holes"))
    (tmp_path / "part.nc").write_text("\n".join([*program, "G80", "M30", ""]))
    (tmp_path / "holes.csv").write_text("\n".join(rows) + "\n")
    (test,) = read_instruments(read_job(job))
    (note,) = [n for n in test.notes if n.kind is Kind.UNCERTAINTY]
    assert str(note).startswith("holes.csv:6: doubt: u_um is 0.02 um where the median is 1 um")


def two_lasers(folder, stated_um):
    """A job with lasers along X and Y on an exact machine, of noise alone."""
    random, sections = np.random.default_rng(4), []
    for axis, far in (("X", 380.0), ("Y", 280.0)):
        places = np.linspace(-far, -10.0, 15)
        there_and_back = np.concatenate([places, places[::-1]] * 2)
        rows = ["run,position_mm,approach,t_s,deviation_um"]
        for k, place in enumerate(there_and_back):
            noise = NOISE_UM * random.standard_normal()
            rows.append(f"{k // 30 + 1},{place},{1 if k // 15 % 2 == 0 else -1},{5 * k},{noise}")
        (folder / f"{axis}.csv").write_text("\n".join(rows) + "\n")
        told = {"file": f"{axis}.csv", "axis": axis, "at_mm": [-200, -150, -100]}
        sections.append(measurement("laser", **told, u_um=stated_um[axis]))
    path = write_job(folder, more="\n".join(sections))
    lines = [line for line in path.read_text().splitlines() if not line.startswith("measured")]
    path.write_text("\n".join(lines))
    return path


@pytest.mark.parametrize(
    ("stated_um", "said"),
    [
        ({"X": 0.1, "Y": 0.5}, "X.csv: its readings scatter 5 times more than its u_um says"),
        ({"X": 0.5, "Y": 2.5}, "Y.csv: its readings scatter 5 times less than its u_um says"),
        ({"X": 0.5, "Y": 0.5}, None),
        ({"X": 0.1, "Y": 0.1}, None),  # of all, which is said of all
    ],
)
def test_one_test_of_another_uncertainty_is_asked_about(tmp_path, stated_um, said):
    notes = diagnose(survey_job(two_lasers(tmp_path, stated_um))).notes
    asked = [n for n in notes if n.kind is Kind.SCATTER and n.level is Level.QUESTION and n.file]
    if said is None:
        assert not asked
        return
    (note,) = asked
    start, _, rest = str(note).partition(" scatter ")
    assert start == said.partition(" scatter ")[0]
    number, _, end = rest.partition(" times ")
    assert float(number) == pytest.approx(5.0, rel=0.25)  # of 60 readings
    assert end.startswith(said.partition(" times ")[2])
