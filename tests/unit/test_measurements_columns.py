"""Files of instruments as people write them: comments, capitals, blanks; and slips in them."""

import numpy as np
import pytest

from tests.small_job import measurement, write_job
from vmach.errors import InputError
from vmach.instruments import read_instruments
from vmach.job import read_job
from vmach.measurements.columns import read_columns

LASER = measurement("laser", axis="X", at_mm=[-100, -100, -50])
HEAD = "run,position_mm,approach,t_s,deviation_um"
PLACES = (-300, -250, -200, -150, -100)
ROWS = [f"1,{x},1,{k},{k}.5" for k, x in enumerate(PLACES)]
ROWS += [f"1,{x},-1,{k + 5},{7 - k}.25" for k, x in enumerate(PLACES[::-1])]
WIDE = ["position_mm,forward_1,backward_1"] + [f"{x},{k}.5,{k + 3}" for k, x in enumerate(PLACES)]


def read(tmp_path, lines):
    job_path = write_job(tmp_path, more=LASER)
    (tmp_path / "laser.csv").write_text("\n".join(lines) + "\n")
    return read_instruments(read_job(job_path))[0]


@pytest.mark.parametrize("rows", [[HEAD, *ROWS], WIDE])
def test_comments_blanks_and_capitals_change_nothing(tmp_path, rows):
    plain = read(tmp_path, rows)
    noted = [
        "# XL-80, + is further along +",
        "",
        rows[0].title(),
        "# out",
        rows[1],
        "   ",
        *rows[2:],
    ]
    test = read(tmp_path, noted)
    np.testing.assert_array_equal(test.measured_mm, plain.measured_mm)
    np.testing.assert_array_equal(test.states.nose_mm, plain.states.nose_mm)


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        ([], r"laser\.csv: the file is empty; accepted: a heading run, position_mm"),
        (["# nothing"], r"laser\.csv: the file is empty"),
        ([HEAD], r"laser\.csv: no rows of data"),
        ([HEAD, ROWS[0].replace(".", ",")], r"laser\.csv:2: 6 cells; .* decimal comma"),
        (["#", HEAD, "", "1,-300"], r"laser\.csv:4: 2 cells; accepted: 5 as in line 2"),
        ([HEAD, "1,-300,forward,0,0.5"], r"laser\.csv:2: approach is 'forward'; accepted: 1 after"),
        ([HEAD, "1,-300,1,10:05:00,0.5"], r"laser\.csv:2: t_s is '10:05:00'; accepted: seconds"),
        (["#", WIDE[0] + ",mean", "1,2,3,4"], r"laser\.csv:2: header 'position_mm, forward_1"),
    ],
)
def test_slips_are_told_with_their_line_and_what_is_accepted(tmp_path, lines, said):
    with pytest.raises(InputError, match=said):
        read(tmp_path, lines)


def test_a_name_with_a_line_end_does_not_shift_the_lines_below(tmp_path):
    (tmp_path / "table.csv").write_text('run,x\n"a\nb",1\nc,two\n')
    with pytest.raises(InputError, match=r"table\.csv:4: x is 'two'"):
        read_columns(tmp_path / "table.csv", numbers=["x"], text=["run"])
