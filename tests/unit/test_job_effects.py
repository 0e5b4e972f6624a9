"""Effects of a job: values that are each within their bounds, and together make no effect."""

import re

import pytest

from tests.small_job import write_job
from vmach.checkup import check_job
from vmach.effects import read_effects
from vmach.errors import InputError
from vmach.job import read_job

#: line of the first key behind the header of the effect
FIRST = 15


@pytest.mark.parametrize(
    ("more", "line", "message"),
    [
        ("position_mm = [-400, 0, -200]\ncorrection_um = [0, 2, 1]\n", FIRST, "has -200 behind 0"),
        ("position_mm = [-400, 0, 0]\ncorrection_um = [0, 2, 1]\n", FIRST, "each once"),
        ("position_mm = [-400, 0]\ncorrection_um = [0, 2, 1]\n", FIRST + 1, "has 3 values and"),
        ("position_mm = []\ncorrection_um = []\n", FIRST, "position_mm = []"),
        ("position_mm = -400\ncorrection_um = 1\n", FIRST, "accepted: a list of"),
    ],
)
def test_a_correction_curve_is_refused_with_its_line(tmp_path, more, line, message):
    path = write_job(tmp_path, more="[effects.component.EXX]\n" + more)
    job = read_job(path)
    with pytest.raises(InputError, match=re.escape(message)) as caught:
        read_effects(job.effects, file=job.path, job=job)
    assert caught.value.line == line
    told = [str(finding) for finding in check_job(path)]
    assert any(f"job.toml:{line}: " in text and message in text for text in told)


def test_one_target_written_in_both_forms_is_refused(tmp_path):
    """Both took effect, one on top of the other."""
    both = '[effects.scale]\ntarget = "Z"\nscale_ppm = -12\n[effects.scale.%s]\nscale_ppm = 3\n'
    job = read_job(write_job(tmp_path, more=both % "Z"))
    with pytest.raises(InputError, match="'scale' has the target 'Z' twice") as caught:
        read_effects(job.effects, file=job.path, job=job)
    assert caught.value.line == FIRST + 2
    job = read_job(write_job(tmp_path, more=both % "X"))
    assert len(read_effects(job.effects, file=job.path, job=job)) == 2


def test_one_number_is_no_list(tmp_path):
    job = read_job(write_job(tmp_path, more="[effects.backlash.X]\nreversal_um = [1, 2]\n"))
    with pytest.raises(InputError, match=r"reversal_um = \[1\.0, 2\.0\]; accepted: one number"):
        read_effects(job.effects, file=job.path, job=job)
