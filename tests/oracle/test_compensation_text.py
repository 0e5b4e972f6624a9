"""The text of compensated programs: everything but the numbers stays as the user has it."""

import re

import numpy as np
import pytest

from tests.oracle.test_compensation_programs import SCALE, job_with
from vmach.compensation import compensate
from vmach.errors import InputError
from vmach.job import read_job

#: at machine X the error is 200 ppm of X (offset 100 mm): everything moves, nothing bends
BENT = (
    SCALE + "[effects.cyclic_pitch.X]\namplitude_um = 4\npitch_mm = 40\nphase_rad = 0.3\n"
    "[effects.scale.Y]\nscale_ppm = -150\n"
)


def text_of(tmp_path, body, effects=SCALE, **options):
    job, found = job_with(tmp_path, body, effects)
    return (
        compensate(job, found, **options)
        .text.decode("latin-1")
        .removeprefix("(Odd Spacing )\nG21 G17 G90 G94\nG54\nT1 M6\nS3000 M3\n")
    )


def corrected(x):
    """q with q (1 + s) = q_nominal; the workpiece zero is at machine X 100."""
    return (x + 100.0) / (1.0 + 200e-6) - 100.0


def without_numbers(text):
    return re.sub(r"(?<=[A-Za-z=])[ \t]*[+-]?[\d.]+", "#", text)


@pytest.mark.parametrize(
    ("word", "number"),
    [
        pytest.param("X30", "29.974", id="a point is always written"),
        pytest.param("X30.", "29.974", id="point"),
        pytest.param("X+30.0", "+29.974", id="sign"),
        pytest.param("x 30.0", "29.974", id="blank and case"),
        pytest.param("X030.", "29.974", id="leading zeros"),
        pytest.param("X3 0.", "29.974", id="blank inside"),
        pytest.param("X-.5", "-.52", id="bare point"),
        pytest.param("X-0.500", "-0.520", id="trailing zeros"),
    ],
)
def test_numbers_look_as_the_user_writes_them(tmp_path, word, number):
    text = text_of(tmp_path, f"G1 Z-1. F200\n{word} (c)\nM30\n")
    letter = re.match(r"[A-Za-z]\s*(?=[+\-.\d])", word).group()
    line = text.splitlines()[-2]
    assert line == f"{letter}{number} (c)"
    value = float(word.replace(" ", "")[1:])
    assert abs(float(number) - corrected(value)) <= 0.5e-3 + 1e-9


PROGRAM = (
    "%\r\nO0042 (Odd  Spacing )\r\nG21 G17 G90 G94\r\nT1 M6\r\nG0 X 0. Y 0.\r\nG43H1Z5.\r\n"
    "n5 G1Z-1.F200\r\n\tN10\tg1 x30. Y+10 (keep X1 Y2) ; and Z3\r\n"
    "/ N20 X40.0 M8\r\n\r\n(MSG, hello)\r\nN30 G01 X 50. (a) Y2. (b)\r\nG4P1.5\r\nM30\r\n%"
)


def test_all_but_the_numbers_stays(tmp_path):
    job, effects = job_with(tmp_path, "", SCALE)
    job.program.write_bytes(PROGRAM.encode("latin-1"))
    text = compensate(job, effects).text.decode("latin-1")
    assert without_numbers(text) == without_numbers(PROGRAM)
    assert text.endswith("\r\nM30\r\n%")
    for kept in ("(keep X1 Y2) ; and Z3", "(MSG, hello)", "(a) Y2. (b)", "M8", "G4P1.5"):
        assert kept in text


def test_inserted_blocks_are_numbered_where_the_program_numbers_all(tmp_path):
    head = "N10 G21 G90 G54\nN20 T1 M6\nN30 G0 X0. Y0. Z5.\n"
    body = head + "N40 G1 Z-1. F200\nN50 X90. Y90.\nN60 M30\n"
    job, effects = job_with(tmp_path, "", BENT)
    job.program.write_text(body)
    lines = compensate(job, effects).text.decode().splitlines()
    numbers = [int(re.match(r"N(\d+) ", line)[1]) for line in lines]
    assert len(lines) > 12
    assert len(set(numbers)) == len(numbers)
    assert max(numbers) <= 99999
    assert numbers[:5] == [10, 20, 30, 40, 50]
    assert [n for n in numbers if 50 < n < 60] == list(range(51, 60))


def test_block_numbers_end_at_99999(tmp_path):
    body = "N99990 G21 G90 G54\nN99991 T1 M6\nN99992 G0 X0. Y0. Z5.\nN99993 G1 Z-1. F200\n"
    job, effects = job_with(tmp_path, "", BENT)
    job.program.write_text(body + "N99998 X90. Y90.\nN99999 M30\n")
    lines = compensate(job, effects).text.decode().splitlines()
    numbers = [int(m[1]) for m in (re.match(r"N(\d+)", line) for line in lines) if m]
    assert len(numbers) == 6 < len(lines)


def test_blocks_behind_a_slash_have_one_too(tmp_path):
    text = text_of(tmp_path, "G1 Z-1. F200\n/X90. Y90.\nX0.\nM30\n", BENT)
    lines = text.splitlines()
    first, last = lines.index(next(s for s in lines if s[0] == "/")), lines.index("M30")
    skipped = [line for line in lines if line.startswith("/")]
    assert len(skipped) > 5
    assert lines[first : first + len(skipped)] == skipped
    # the motion is said anew behind them, for the control may have skipped them
    assert re.match(r"G1 |X\S+ G1|X\S+ Y\S+ G1", lines[first + len(skipped)])
    assert first + len(skipped) < last


def test_stops_come_after_the_last_point(tmp_path):
    text = text_of(tmp_path, "G1 Z-1. F200\nX90. M8 M0\nM30\n", BENT)
    lines = text.splitlines()
    at = [k for k, line in enumerate(lines) if "M0" in line]
    assert len(at) == 1
    assert lines[at[0] + 1] == "M30"
    assert "M8" in next(s for s in lines if s.startswith("X")), (
        "coolant goes on where the block begins"
    )


def test_inverse_time_feeds_keep_the_speed(tmp_path):
    text = text_of(tmp_path, "G1 Z-1. F200\nG93 X90. F4.\nG94 X0. F100\nM30\n", BENT)
    lines = text.splitlines()
    begin = next(k for k, s in enumerate(lines) if "G93" in s)
    end = next(k for k, s in enumerate(lines) if "G94" in s)
    place, minutes = corrected(0.0), 0.0
    for line in lines[begin:end]:
        there = float(re.search(r"X(\S+)", line)[1])
        feed = float(re.search(r"F(\S+)", line)[1])
        assert abs(there - place) * feed == pytest.approx(360.0, rel=3e-3)  # 90 mm in 1/4 min
        place, minutes = there, minutes + 1.0 / feed
    assert minutes == pytest.approx(0.25, rel=1e-3)


@pytest.mark.parametrize("step_mm", [1e-3, 1e-4])
def test_residual_of_rounding_is_within_its_bound(tmp_path, step_mm):
    """Half a step in three axes on lines; on arcs the centre is rounded too.

    An end is off by half a step in each axis. Across an arc both ends then leave at most sqrt(2)/2
    steps in the plane. Its centre, rounded to the nearest point, is off by d of at most sqrt(2)/2
    steps; the part of d towards the middle of the arc moves that by d (1 - cos(theta / 2)), theta
    the arc's angle, at most 181 degrees. The best of several centres is no worse.
    """
    body = "G1 Z-1. F200\nG2 X60. Y0. I30. J0. F500\nG3 X30. Y-20. R25.\nG1 X0. Y0.\nM30\n"
    job, effects = job_with(tmp_path, body, BENT)
    found = compensate(job, effects, resolution_mm=step_mm)
    in_plane = 0.5 * 2**0.5 * (1.0 + 1.0 - np.cos(np.radians(181.0 / 2)))
    bound = step_mm * np.hypot(in_plane, 0.5)
    assert found.after.largest_mm <= found.unrounded.largest_mm + bound
    assert found.after.largest_mm > 0.2 * step_mm, "rounding is felt"


def test_an_inch_program_has_one_decimal_more_where_the_control_reads_it(tmp_path):
    body = "G1 Z-1. F200\nG20 X3. F20\nM30\n"
    job, effects = job_with(tmp_path, body, SCALE)
    text = compensate(job, effects).text.decode()
    assert re.search(r"X2\.9\d{4}\b", text)
    for_fanuc = compensate(job, effects, dialect="fanuc").text.decode()
    assert re.search(r"X2\.9\d{3}\b", for_fanuc)


def test_radius_stays_radius_where_it_says_enough(tmp_path):
    text = text_of(tmp_path, "G1 Z-1. F200\nG3 X40. Y0. R40. F500\nM30\n", BENT)
    arcs = [s for s in text.splitlines() if "R" in s or "I" in s]
    assert arcs
    assert all("R" in s and "I" not in s for s in arcs)


def test_half_circle_by_radius_gets_a_centre(tmp_path):
    equal = SCALE + "[effects.scale.Y]\nscale_ppm = 200.0\n"
    text = text_of(tmp_path, "G1 Z-1. F200\nG3 X40. Y0. R20. F500\nM30\n", equal)
    line = next(s for s in text.splitlines() if s.startswith("G3"))
    assert re.fullmatch(r"G3 X\S+( Y\S+)? F500 I\S+ J\S+|G3 X\S+( Y\S+)? I\S+ J\S+ F500", line)


def test_arcs_that_bend_the_other_way_change_their_sense(tmp_path):
    """An arc of 50 m radius over 60 mm is 9 um deep; the error bends it by more."""
    bow = "[effects.cyclic_pitch.Y]\namplitude_um = 40\npitch_mm = 150\nphase_rad = 0.0\n"
    body = "G1 Z-1. F200\nG2 X30. Y30. I35370. J-35340. F500\nM30\n"
    job, effects = job_with(tmp_path, body, bow)
    found = compensate(job, effects)
    assert found.after.largest_mm < 2e-3


def test_axes_never_said_get_no_word(tmp_path):
    """Where Z stands before its first word is known to the control's offsets alone."""
    tilted = "[effects.scale.Z]\nscale_ppm = 500.0\n"
    job, effects = job_with(tmp_path, "", SCALE + tilted)
    job.program.write_text("G21 G90 G54\nT1 M6\nG0 X0. Y0.\nX10.\nG43 H1 Z5.\nG1 X20. F100\nM30\n")
    lines = compensate(job, effects).text.decode().splitlines()
    assert not any("Z" in line for line in lines[:4])
    assert "Z" in lines[4]


def test_a_move_from_an_unknown_place_gets_no_points(tmp_path):
    """The tool is wherever it was left: a point on the way would send it anywhere."""
    job, effects = job_with(tmp_path, "", BENT)
    job.program.write_text("G21 G90 G54\nT1 M6\nG0 Z5.\nG0 Y0.\nG1 X90. Y90. F100\nX0. Y0.\nM30\n")
    found = compensate(job, effects)
    lines = found.text.decode().splitlines()
    assert re.fullmatch(r"G1 X89\.\d+ Y\S+ F100", lines[4])
    assert re.match(r"X\S+", lines[5])
    assert 5 in found.uncorrected
    assert "where it begins" in found.uncorrected[5][1]
    assert len(lines) > 7, "the way back gets points"


def test_a_full_turn_from_an_unknown_height_is_refused(tmp_path):
    head = "G21 G90 G54\nT1 M6\nG0 X40. Y10.\n"
    job, effects = job_with(tmp_path, "", BENT)
    job.program.write_text(head + "G3 X80. Z-1. I20. F100\nX80. I20.\nM30\n")
    assert "\nG3 X" in compensate(job, effects).text.decode()
    job.program.write_text(head + "G3 X40. Y10. Z-1. I20. F100\nX80. I20.\nM30\n")
    stated = "begins at a position that the program does not state"
    with pytest.raises(InputError, match=stated) as caught:
        compensate(job, effects)
    assert caught.value.line == 4


def test_an_arc_behind_a_block_that_may_be_skipped_stays_an_arc(tmp_path):
    text = text_of(tmp_path, "T1 M6\n/G0 X40. Y30. Z1.\nG2 X60. Y30. I10. J0. F100\nM30\n", BENT)
    line = text.splitlines()[-2]
    x, i = (float(re.search(rf"{letter}(-?[\d.]+)", line)[1]) for letter in "XI")
    assert line.startswith("G2 ")
    assert abs(x - 60.0) < 0.05
    assert abs(i - 10.0) < 0.01


def test_a_tool_change_and_a_skipped_block_say_nothing(tmp_path):
    body = "G1 Z-1. F200\nT1 M6\nG0 X90.\nG0 Y0. Z5.\n/Y20.\nG1 X0.\nM30\n"
    job, effects = job_with(tmp_path, body, BENT)
    lines = compensate(job, effects).text.decode().splitlines()
    after = lines.index("T1 M6", 5) + 1
    assert re.fullmatch(r"G0 X\S+", lines[after])
    assert re.search(r"Y", lines[after + 1])


def test_program_without_tool_change_has_the_only_tool(tmp_path):
    job, effects = job_with(tmp_path, "", SCALE)
    job.program.write_text("G21 G90 G54\nG0 X0. Y0. Z5.\nG1 X30. F100\nM30\n")
    assert "X29.974" in compensate(job, effects).text.decode()
    two = job.path.read_text() + '[tools.2]\nshape = "flat"\ndiameter_mm = 8\nlength_mm = 90\n'
    job.path.write_text(two)
    with pytest.raises(InputError, match="moves no tool"):
        compensate(read_job(job.path), effects)


def test_a_zero_set_at_the_tool_goes_along_with_it(tmp_path):
    """The tool stands at the rounded place when G92 calls it zero; all counts from there."""
    text = text_of(tmp_path, "G1 Z-1. F200\nX90.\nG92 X0.\nX-30.\nG92.1\nX30.\nM30\n")
    there, away, back = (float(x) for x in re.findall(r"^X(-?\d+\.\d+)", text, re.M))
    assert abs(there - corrected(90.0)) <= 0.5e-3 + 2e-6
    assert abs(away - (corrected(60.0) - there)) <= 0.5e-3 + 2e-6
    assert abs(back - corrected(30.0)) <= 0.5e-3 + 2e-6


@pytest.mark.parametrize(
    ("body", "dialect", "line", "said"),
    [
        ("G1 Z-1. F200\nX30.\nM30\n", "klingon", None, "klingon"),
        ("G1 Z-1. F200\nX30.\nM30\n", "heidenhain", None, "not translated"),
        ("G1 Z-1. F200\nG64 P0.01\nX30.\nM30\n", "haas", 9, "G64 P"),
        ("G1 Z-1. F200\nG61.1\nX30.\nM30\n", "fanuc", 9, "G61.1"),
        ("M3\nG84 X1. Y1. Z-3. R2. F100\nG80\nM30\n", "haas", 9, "another thing on haas"),
    ],
)
def test_other_dialects_are_refused(tmp_path, body, dialect, line, said):
    job, effects = job_with(tmp_path, body, SCALE)
    with pytest.raises(InputError, match=said) as caught:
        compensate(job, effects, dialect=dialect)
    assert caught.value.line == line
