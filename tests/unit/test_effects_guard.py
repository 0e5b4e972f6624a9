"""Whatever an effect of a user does wrong is one error with its file and line, once loaded."""

import re

import numpy as np
import pytest

from vmach.effects import catalogue, load_effect_file
from vmach.effects.read_only import read_only
from vmach.effects.trial_path import trial_path
from vmach.errors import InputError

pytestmark = pytest.mark.usefixtures("no_effects_added")

SOUND = """\
import sys
import numpy as np
from vmach.effects import Effect, along, inner, linear
from vmach.machine import RigidDisplacement
class Twist(Effect):
    name = "twist"
    title = "twist of the bed"
    parameters = (linear("a_um", "size", usual=10.0),)
    targets = ("",)
    turns_tool = True
    slack_share = 0.1
    def displacement(self, path, target, a_um):
        turn = 1e-9 * a_um * path.nose_mm
        return 1e-6 * a_um * path.nose_mm
"""
#: lines of the law's first row, and of the first row behind the class
LAW, MORE = 13, 15


def written(tmp_path, law="", more=""):
    text = SOUND if not law else SOUND[: SOUND.index("        turn")] + f"        {law}\n\n"
    (tmp_path / "twist.py").write_text(text + more)
    return tmp_path / "twist.py"


def refused(file, line, message):
    with pytest.raises(InputError, match=re.escape(message)) as caught:
        load_effect_file(file)
    assert (caught.value.file, caught.value.line) == (file, line)
    assert "twist" not in catalogue()


def test_a_sound_effect_is_loaded(tmp_path):
    assert load_effect_file(written(tmp_path)).name == "twist"


@pytest.mark.parametrize(
    ("law", "line", "message"),
    [
        ("sys.exit(0)", LAW, "displacement() of effect 'twist' fails: SystemExit(0)"),
        ("return 1e-9j * a_um * path.nose_mm", LAW - 1, "an array of complex128"),
        ("return (1e-9 * a_um * path.nose_mm).astype(object)", LAW - 1, "an array of object"),
        ("return path.nose_mm.astype(str)", LAW - 1, "an array of <U"),
        ("return None", LAW - 1, "an array of ()"),
        ("return [[1.0], [1.0, 2.0]]", LAW - 1, "rows of different lengths"),
        ("return RigidDisplacement(0 * path.nose_mm[0], 0 * path.nose_mm)", LAW - 1, "of (3,)"),
        ("return RigidDisplacement(0 * path.nose_mm, 0 * path.time_s)", LAW - 1, "shift_mm and"),
        ("return RigidDisplacement(0 * path.nose_mm, np.nan * path.nose_mm)", LAW - 1, "no numb"),
        ("return RigidDisplacement(0.0, None)", LAW - 1, "an array of ()"),
        ("return self.displacement(path, target, a_um)", LAW, "RecursionError"),
        ("path.nose_mm[0] += 1; return 1e-6 * a_um * path.nose_mm", LAW, "read-only"),
        ("path.states.move[0] = 1; return 1e-6 * a_um * path.nose_mm", LAW, "read-only"),
        ("path.moves.end_mm[:] = 0; return 1e-6 * a_um * path.nose_mm", LAW, "read-only"),
        ("path.corner[1][:] = 0; return 1e-6 * a_um * path.nose_mm", LAW, "read-only"),
        ("path.of_tool('diameter_mm')[:] = 0; return path.nose_mm", LAW, "read-only"),
        ("path.lever('EXX').shift_mm[:] = 0; return path.nose_mm", LAW, "read-only"),
        ("return 1e-6 * a_um * path.nose_mm * path.normal", LAW, "belong to no surface"),
    ],
)
def test_a_law(tmp_path, law, line, message):
    refused(written(tmp_path, law), line, message)


@pytest.mark.parametrize(
    ("more", "line", "message"),
    [
        ("    def __init__(self):\n        1 / 0\n", 1, "__init__() of effect 'twist' fails"),
        ("    def __init__(self, size):\n        pass\n", 0, "made without arguments"),
        ("    def possible_targets(self, job):\n        1 / 0\n", 1, "ZeroDivisionError"),
        ("    def possible_targets(self, job):\n        pass\n", 0, "gives None; accepted: a tu"),
        ("    def possible_targets(self, job):\n        return 'X'\n", 0, "gives 'X'"),
        ("    def not_testable(self, path, target):\n        1 / 0\n", 1, "not_testable() of"),
        ("    def not_testable(self, path, target):\n        return 3\n", 0, "why not, in words"),
        (
            "    def columns(self, path, target, inner):\n        return np.ones(3)\n",
            0,
            "(P, 3, K)",
        ),
        ("    def slack_pattern(self, p, t, q):\n        1 / 0\n", 1, "slack_pattern() of effect"),
        ("    def slack_pattern(self, p, t, q):\n        return np.ones(2)\n", 0, "of (2,)"),
        ("    def slack_pattern(self, p, t, q):\n        return np.nan * p.nose_mm\n", 0, "no num"),
        ("    def unforeseen(self, p, t, q):\n        1 / 0\n", 1, "unforeseen() of effect"),
        ("    def unforeseen(self, p, t, q):\n        return p.nose_mm\n", 0, "(P, 3, K) mm"),
        ("    def shows_on(self, states):\n        return None\n", 0, "True or False"),
        ("    def needed(self, target):\n        return None\n", 0, "a tuple of words"),
        ("    def inner_grid(self, path, target):\n        yield 1\n", 0, "a dict from names"),
        ("    def inner_grid(self, path, target):\n        yield 1 / 0\n", 1, "inner_grid() of"),
        ("    def settle(self, c, inner):\n        1 / 0\n", 1, "settle() of effect"),
        ("    @property\n    def amplitudes(self):\n        1 / 0\n", 2, "ZeroDivisionError"),
        ("sys.exit(0)\n", 0, "cannot be loaded: SystemExit: 0"),
    ],
)
def test_everything_else_that_an_effect_may_write(tmp_path, more, line, message):
    refused(written(tmp_path, more=more), MORE + line, message)


def test_columns_that_are_none_of_its_amplitudes(tmp_path):
    more = "    def columns(self, path, target, inner):\n"
    more += "        return np.zeros((len(path), 3, 2))\n"
    refused(written(tmp_path, more=more), LAW - 1, "columns() gives 2 columns; accepted: one for")


def test_a_law_that_is_no_function(tmp_path):
    refused(written(tmp_path, more="    displacement = 3\n"), MORE, "displacement is no function")


def test_a_file_may_have_any_name(tmp_path):
    file = written(tmp_path).rename(tmp_path / "twist")
    assert load_effect_file(file).name == "twist"


def test_what_was_compiled_of_a_file_before_is_not_taken(tmp_path):
    file = written(tmp_path)
    load_effect_file(file)
    assert not (tmp_path / "__pycache__").exists()


def test_a_path_that_is_read_only_is_the_same_path():
    path = trial_path()
    seen = read_only(path)
    assert isinstance(seen, type(path)) and len(seen) == len(path)
    assert read_only(seen) is seen
    np.testing.assert_array_equal(seen.states[:5].nose_mm, path.nose_mm[:5])
    np.testing.assert_array_equal(seen.radial_depth_mm, path.radial_depth_mm)
    assert seen.warmth_of_axis(0, 900.0, 0.5).shape == (len(path),)
    assert path.nose_mm.flags.writeable
