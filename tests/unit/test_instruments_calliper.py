"""Calliper lengths of a square: skew as the firmware of printers calculates it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tests.small_job import measurement, write_job
from vmach.diagnosis.named_fit import fit_named
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.errors import InputError
from vmach.importers import Questions
from vmach.importers.squareness import skew_of_square, square_sections
from vmach.instruments import read_instruments
from vmach.job import read_job

#: corners of a square of 80 mm, in workpiece coordinates: A, B, C, D
A, B, C, D = np.array([(-40.0, -40.0), (-40.0, 40.0), (40.0, 40.0), (40.0, -40.0)])
ENDS = [(A, D), (A, B), (A, C), (B, D)]


def firmware_skew(ac, bd, ad):
    """Marlin's Configuration.h, word for word as its comment gives it."""
    ab = math.sqrt(2 * ac * ac + 2 * bd * bd - 4 * ad * ad) / 2
    return math.tan(math.pi / 2 - math.acos((ac * ac - ab * ab - ad * ad) / (2 * ab * ad)))


def sheared(skew, scale=(1.0, 1.0)):
    """Lengths of the square where the machine makes (x, y) at (s x - skew y, t y)."""
    shear = np.array([[scale[0], -skew], [0.0, scale[1]]])
    return [float(np.linalg.norm(shear @ (q - p))) for p, q in ENDS]


def calliper_job(folder, lengths, errors=None, *, squareness="", more=""):
    job = write_job(folder, errors, squareness=squareness,
                    more=measurement("calliper", u_um=1) + more)  # fmt: skip
    rows = [f"{p[0]},{p[1]},{q[0]},{q[1]},{length!r}" for (p, q), length in
            zip(ENDS, lengths, strict=True)]  # fmt: skip
    (folder / "calliper.csv").write_text("x1,y1,x2,y2,length_mm\n" + "\n".join(rows) + "\n")
    job.write_text(job.read_text().replace('measured = "points.csv"\n', ""))
    return job


@pytest.mark.parametrize(
    "lengths", [(140.4, 142.8, 99.8), (141.6, 141.4, 99.8), (142.4, 140.5, 99.5)]
)
def test_the_formula_is_that_of_the_firmware(lengths):
    assert skew_of_square(*lengths) == pytest.approx(firmware_skew(*lengths), rel=1e-12)


@pytest.mark.parametrize("ec0y", [-900e-6, 34.1e-6, 2e-3])
def test_a_known_skew_comes_out_of_four_lengths(ec0y):
    """dx = -EC0Y y exactly: the cotangent of the angle at A is -EC0Y."""
    ad, _, ac, bd = sheared(ec0y)
    (section,) = square_sections("XY", (ac, bd, ad), Questions()).sections
    assert section.values["EC0Y"] == pytest.approx(1e6 * ec0y, rel=1e-6)
    assert -1e-6 * section.values["EC0Y"] == pytest.approx(firmware_skew(ac, bd, ad), rel=1e-9)


def test_no_square_has_these_lengths():
    with pytest.raises(InputError, match="a square with diagonals of 10 and 10 mm"):
        skew_of_square(10.0, 10.0, 30.0)


def test_what_the_machine_makes_is_what_callipers_read(tmp_path):
    """Tables and squareness of the machine file against the exact lengths of the sheared square."""
    errors = {"EXX": (lambda q: 0.3 * q, None), "EYY": (lambda q: -0.2 * q, None)}
    lengths = sheared(500e-6, (1.0003, 0.9998))
    job = calliper_job(tmp_path, lengths, errors, squareness="[squareness]\nEC0Y = 500\n")
    (test,) = read_instruments(read_job(job))
    assert test.predicted_mm == pytest.approx(test.measured_mm, abs=2e-5)  # second order
    assert np.abs(test.measured_mm).max() > 0.02


def test_a_fit_finds_the_skew_of_the_firmware(tmp_path):
    """All four lengths too long by 0.05 mm, the callipers' zero: it is left free.

    Readings of 1 um, so that the prior of the amplitude has no say.
    """
    lengths = [length + 0.05 for length in sheared(400e-6)]
    (skew,) = fit_named(survey_job(calliper_job(tmp_path, lengths)), ["squareness:C0Y"])
    ad, _, ac, bd = sheared(400e-6)
    found = skew.parameters["squareness_urad"]
    assert found == pytest.approx(-1e6 * firmware_skew(ac, bd, ad), rel=2e-3)


@pytest.mark.parametrize(
    "row, said",
    [("0,0,0.1,0,0.1", "calliper.csv:6: length_mm is 0.1 where"),
     ("0,0,40,0,44", "calliper.csv:6: length_mm is 44 where the places are 40 mm apart"),
     ("0,0,4000,0,4000", "calliper.csv:6"),
     ("0,0,40,0,nan", "calliper.csv:6: length_mm is 'nan'")],
)  # fmt: skip
def test_a_length_that_cannot_be_is_refused(row, said, tmp_path):
    job = calliper_job(tmp_path, sheared(0.0))
    with (tmp_path / "calliper.csv").open("a") as file:
        file.write(row + "\n")
    with pytest.raises(InputError, match=said):
        read_instruments(read_job(job))


@pytest.mark.parametrize("inch", [1.0, 25.4])
def test_lengths_in_inches_are_asked_about(tmp_path, inch):
    job = write_job(tmp_path, more=measurement("calliper", u_um=10))
    # across pocket and bore, which the program goes over from -15 to 41 mm
    ends = [((-14, -9), (40, 9)), ((-14, 9), (40, -9)), ((-14, -9), (40, -9)), ((-14, 9), (40, 9))]
    lines = ["x1,y1,x2,y2,length_mm"]
    for p, q in ends:
        length = round(float(np.hypot(q[0] - p[0], q[1] - p[1])) / inch, 6)
        lines.append(",".join(f"{v / inch:.6f}" for v in (*p, *q)) + f",{length}")
    (tmp_path / "calliper.csv").write_text("\n".join(lines) + "\n")
    (test,) = read_instruments(read_job(job))
    assert any("are they in inches" in note.text for note in test.notes) == (inch > 1.0)
