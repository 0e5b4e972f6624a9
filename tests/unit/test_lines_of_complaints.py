"""What is wrong in a file is told with the line that has to be mended."""

import re

import pytest

from tests.small_job import write_job, write_job_with_nominal
from vmach.checkup import check_job
from vmach.errors import InputError
from vmach.history import history_of
from vmach.job import read_job
from vmach.machine.tables.error_table import MM_PER, read_error_table
from vmach.nominal.points import read_points_csv


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("position_mm,forward,backward\n0,1,2\n0,2,2\n5,6,6\n", 3),
        ("position_mm,forward,backward\n\n0,1,2\n", 3),
        ("position_mm,forward,backward\n5,,2\n-5,6,6\n", 2),
        ("run,position_mm,approach,deviation\n1,0,1,2\n1,5,1,6\n1,0,-1,2\n", 3),
        ("# a laser\nposition_mm,forward,backward\n", 2),
    ],
)
def test_an_error_table(tmp_path, text, line):
    (tmp_path / "table.csv").write_text(text)
    with pytest.raises(InputError) as caught:
        read_error_table(tmp_path / "table.csv", MM_PER, "um")
    assert caught.value.line == line


def test_a_quote_without_its_partner(tmp_path):
    path = write_job(tmp_path).with_name("points.csv")
    rows = path.read_text().splitlines()
    rows[4] = rows[4].replace("wall", '"wall').replace(',"wall', ',"wall', 1)
    path.write_text("\n".join(rows) + "\n")
    with pytest.raises(
        InputError, match=r"points\.csv:5: no row of a CSV file.*without its partner"
    ):
        read_points_csv(path)


def test_points_are_looked_at_beside_a_nominal_part(tmp_path):
    path = write_job_with_nominal(tmp_path)
    assert not any("points.csv" in str(found) for found in check_job(path))
    (tmp_path / "points.csv").write_text("id,x,y,z,i,j,k\n1,2,3\n")
    assert any("points.csv:2: 3 values in the row" in str(found) for found in check_job(path))


@pytest.mark.parametrize(
    ("file", "change", "message"),
    [
        ("machine.toml", ("[-400, 0]", "[-400, 0, 1]"), "[-400, 0, 1]; accepted: a list of 2"),
        ("job.toml", ("[stock]", '[[features]]\nname = ""\n[stock]'), "not empty"),
        ("job.toml", ("diameter_mm = 10", "flutes = 2.5\ndiameter_mm = 10"), "a whole number"),
    ],
)
def test_what_is_accepted_is_said_in_words_of_this_program(tmp_path, file, change, message):
    path = write_job(tmp_path)
    place = tmp_path / file
    place.write_text(place.read_text().replace(*change))
    with pytest.raises(InputError, match=rf"{file}:\d+: .*" + re.escape(message)):
        read_job(path)


FITTED = '[[fitted]]\neffect = "backlash"\ntarget = "X"\none_sigma = [{reversal_um = 0.1}]\n'


def test_what_is_open_of_an_effect_is_said_once(tmp_path):
    path = write_job(tmp_path, more="[effects.backlash.X]\nreversal_um = 1\n" + 2 * FITTED)
    with pytest.raises(InputError, match=r"job\.toml:20: \[\[fitted\]\] of backlash X is there"):
        read_job(path)


def test_a_job_of_the_history_that_is_gone(tmp_path):
    more = '[[history]]\nprevious = "a.toml"\n[[history]]\nadded = []\nprevious = "gone.toml"\n'
    path = write_job_with_nominal(tmp_path)
    path.write_text(path.read_text() + more)
    with pytest.raises(InputError, match=r"job\.toml:19: .* previous = 'gone\.toml': no such"):
        history_of(path)


def test_an_effect_that_has_nothing_to_act_on(tmp_path):
    path = write_job(tmp_path, more="[effects.fixture.G55]\n")
    told = [str(found) for found in check_job(path)]
    assert any("job.toml:14: " in text and "has nothing that it could act on" in text
               and "G54" in text for text in told)  # fmt: skip
