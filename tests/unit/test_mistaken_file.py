"""A file named by mistake is told by what it is, not by what its parser stumbles over."""

import tomllib
from pathlib import Path

import pytest

from vmach.errors import InputError
from vmach.files.mistaken_file import mistaken_for
from vmach.job import read_job
from vmach.machine import read_machine
from vmach.study.study import read_study

SAMPLE = Path(__file__).resolve().parents[2] / "samples" / "iso10791_7"
SLOT = Path(__file__).resolve().parents[2] / "samples" / "missing_effect"
READERS = {
    "job file": read_job,
    "machine file": read_machine,
    "study file": read_study,
}


@pytest.mark.parametrize(
    "file, wanted, says, hint",
    [
        (SAMPLE / "part.nc", "job file", "an NC program", SAMPLE / "job.toml"),
        (SAMPLE / "part.nc", "machine file", "an NC program", SAMPLE / "machine.toml"),
        (SLOT / "measured.csv", "job file", "a table", SLOT / "job.toml"),
        (SLOT / "measured.csv", "study file", "a table", None),
        (SAMPLE / "job.toml", "machine file", "a job file", SAMPLE / "machine.toml"),
        (SAMPLE / "job.toml", "study file", "a job file", None),
        (SAMPLE / "machine.toml", "job file", "a machine file", None),
    ],
)
def test_what_it_is_and_which_file_is_meant(file, wanted, says, hint):
    with pytest.raises(InputError) as caught:
        READERS[wanted](file)
    message = str(caught.value)
    assert says in message
    assert f"accepted: a {wanted}" in message
    assert (str(hint) in message) if hint else ("is it" not in message)


@pytest.mark.parametrize("what, file", [("job file", "job.toml"), ("machine file", "machine.toml")])
def test_a_file_of_the_right_kind_is_no_mistake(what, file):
    READERS[what](SAMPLE / file)


@pytest.mark.parametrize("text", ["name = 'x'\nprogramm = 'a.nc'\n", "schema = 1\n"])
def test_a_misspelt_key_is_left_to_the_schema(text):
    assert mistaken_for(Path("job.toml"), text, tomllib.loads(text), what="machine file") is None


def test_text_that_is_nothing_known_is_left_to_the_parser():
    assert mistaken_for(Path("a.txt"), "Dear colleague\n", None, what="job file") is None
