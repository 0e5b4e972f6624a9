"""Every program of a corpus, compensated: LinuxCNC accepts it and makes the intended path.

The environment variable VMACH_GCODE_CORPUS names a folder of programs with FILE.canon17 beside
those that LinuxCNC accepts; LinuxCNC itself must be installed. ``bench_compensation.py`` prints
the same as a table.
"""

import os

import pytest

from tests.oracle.compensation_corpus import compensated, corpus_programs, judged, write_job
from tests.oracle.linuxcnc_interpreter import is_installed

CORPUS = os.environ.get("VMACH_GCODE_CORPUS")
PROGRAMS = corpus_programs(CORPUS) if CORPUS else []
#: what the program may say of a program that it does not compensate
NO_THREE_AXIS_CUT = ("turns to", "moves no tool")

pytestmark = pytest.mark.skipif(
    not (CORPUS and is_installed()), reason="VMACH_GCODE_CORPUS or LinuxCNC is missing"
)


@pytest.mark.parametrize("path", PROGRAMS, ids=lambda p: p.name)
def test_linuxcnc_makes_the_intended_path(path, tmp_path):
    outcome = judged(tmp_path, path)
    if outcome.refusal:
        assert any(words in outcome.refusal for words in NO_THREE_AXIS_CUT), outcome.refusal
        return
    assert outcome.linuxcnc is None
    assert outcome.wrong == []
    assert outcome.path.worst_ratio <= 1.0


@pytest.mark.parametrize("path", PROGRAMS, ids=lambda p: p.name)
def test_without_errors_every_byte_stays(path, tmp_path):
    write_job(tmp_path, path, effects="", errors=False)
    try:
        found, _ = compensated(tmp_path)
    except ValueError as error:
        assert any(words in str(error) for words in NO_THREE_AXIS_CUT), str(error)
        return
    assert found.text == path.read_bytes()
