"""An effect of a user's own is checked when its file is loaded: what it says, and what it does."""

import inspect
import re
from pathlib import Path

import pytest
from typer.testing import CliRunner

from vmach.cli import app
from vmach.effects import catalogue, load_effect_file
from vmach.effects.declaration import check_declaration
from vmach.errors import InputError

pytestmark = pytest.mark.usefixtures("no_effects_added")

SOUND = """\
import numpy as np

from vmach.effects import Effect, along, inner, linear


class Twist(Effect):
    name = "twist"
    title = "twist of the bed"
    parameters = (linear("a_um", "size", usual=10.0), linear("b_um", "size", usual=10.0))
    targets = ("",)

    def displacement(self, path, target, a_um, b_um):
        x, y, _ = path.nose_mm.T
        return along("Z", 1e-6 * (a_um * x + b_um * y))
"""


def written(tmp_path, *changes):
    text = SOUND
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    file = tmp_path / "twist.py"
    file.write_text(text)
    return file


def test_a_sound_file_is_loaded_and_may_be_loaded_again(tmp_path):
    file = written(tmp_path)
    load_effect_file(file)
    again = load_effect_file(file)
    assert catalogue()["twist"] is again


@pytest.mark.parametrize(
    ("change", "line", "message"),
    [
        (('    name = "twist"\n', ""), 6, "class Twist: 'name' is missing; accepted: lower-case"),
        (('    title = "twist of the bed"\n', ""), 6, "'title' is missing"),
        (("parameters = (", "params = ("), 9, "unknown attribute 'params'"),
        (("parameters =", "_parameters ="), 6, "'parameters' is missing"),
        ((', linear("b_um", "size", usual=10.0))', ")"), 9, "parameters = a_um alone; accepted: a"),
        (('targets = ("",)', 'targets = ""'), 10, "targets = ''; accepted: a tuple of words"),
        (('targets = ("",)', 'targets = ("X")'), 10, "targets = 'X'"),
        (('targets = ("",)', "targets = ()"), 10, "targets = ()"),
        (('targets = ("",)', 'target = ("",)'), 10, "did you mean 'targets'?"),
        (('targets = ("",)', "rarity = 'rare'"), 10, "rarity = 'rare'; accepted: a number"),
        (('targets = ("",)', "is_sudden = 1"), 10, "is_sudden = 1; accepted: True or False"),
        (('"twist"', '"Twist"'), 7, "name = 'Twist'; accepted: lower-case"),
        (('"b_um", "size"', '"a_um", "size"'), 9, "two parameters are called a_um"),
        (("usual=10.0)", "usual=0.0)"), 9, "parameter a_um is accepted from -0.0 to 0.0"),
        (("target, a_um, b_um", "target, a_um"), 12, "does not fit its parameters"),
        (("def displacement", "def displacment"), 12, "did you mean 'displacement'?"),
        (('"twist"', '"backlash"'), 7, "there is an effect of this name already: "),
    ],
)
def test_what_a_class_says_is_checked(tmp_path, change, line, message):
    with pytest.raises(InputError) as caught:
        load_effect_file(written(tmp_path, change))
    assert message in str(caught.value)
    assert caught.value.line == line
    assert "twist" not in catalogue()


@pytest.mark.parametrize(
    ("law", "message"),
    [
        ("(a_um + 100) * x + b_um * y", r"with a_um, b_um = 0 it still moves by up to 0\.0"),
        ("(a_um * x + b_um * y) * np.random.rand()", "asked twice for the same, it differs by"),
        ("a_um**2 * x + b_um * y", "not proportional to a_um: at 2 times the usual size"),
        ("a_um * x + np.abs(b_um) * y", "not proportional to b_um: at -1 times the usual size"),
        ("np.clip(a_um, -50, 50) * x + b_um * y", "not proportional to a_um: at 30 times"),
        ("a_um * x + b_um * y + 0.01 * a_um * b_um", "its amplitudes together move by"),
        ("a_um * x / 0 + b_um * y", "values that are no numbers"),
        ("(a_um * x + b_um * y)[:3]", r"fails|gives an array"),
    ],
)
def test_what_a_law_does_is_checked(tmp_path, law, message):
    with pytest.raises(InputError, match=message) as caught:
        load_effect_file(written(tmp_path, ("(a_um * x + b_um * y)", f"({law})")))
    assert re.match(r".*twist\.py:(12|14): displacement\(\) of effect 'twist'", str(caught.value))


def test_an_effect_that_turns_the_tool_says_so(tmp_path):
    turned = (
        'return along("Z", 1e-6 * (a_um * x + b_um * y))',
        "turn = 1e-9 * np.outer(a_um * x + b_um * y, [1.0, 0.0, 0.0])\n"
        "        return RigidDisplacement(0 * turn, turn)",
    )
    imported = (
        "import numpy as np",
        "import numpy as np\nfrom vmach.machine import RigidDisplacement",
    )
    file = written(tmp_path, turned, imported)
    with pytest.raises(InputError, match=r"it turns the tool.*accepted: turns_tool = True"):
        load_effect_file(file)
    file = written(
        tmp_path, turned, imported, ('targets = ("",)', 'targets = ("",)\n    turns_tool = True')
    )
    load_effect_file(file)


def test_a_second_file_with_the_same_name_is_refused(tmp_path):
    load_effect_file(written(tmp_path))
    other = tmp_path / "other.py"
    other.write_text(SOUND)
    with pytest.raises(InputError, match=r"other\.py:7: .*of this name in .*twist\.py"):
        load_effect_file(other)


def test_a_file_of_the_package_may_be_checked():
    file = Path(inspect.getfile(type(catalogue()["scale"])))
    assert load_effect_file(file).title == catalogue()["scale"].title


def test_every_effect_of_the_catalogue_says_what_it_has_to():
    for effect in catalogue().values():
        check_declaration(type(effect))


def test_the_command_says_what_an_effect_looks_like(tmp_path):
    """A rise along X is a squareness of X, or a straightness; a bend over Y is neither."""
    slope = written(tmp_path, (', linear("b_um", "size", usual=10.0)', ","), (", b_um", ""),
                    ("a_um * x + b_um * y", "a_um * x"))  # fmt: skip
    found = CliRunner().invoke(app, ["effects", "check", str(slope)])
    assert found.exit_code == 0, found.output
    assert "a_um: size; amplitude, usual 10" in found.stdout
    assert "hard to tell from squareness B0X, which leaves 0 % of twist" in found.stdout
    assert "note: 'source' is empty" in found.stdout and "no unit" not in found.stdout


def test_a_factor_that_is_missing_is_asked_about(tmp_path):
    with pytest.raises(InputError, match=r"at its usual size it moves the tool by .* 1 um is 1e-3"):
        load_effect_file(written(tmp_path, ("1e-6 *", "1e-3 *")))
    little = written(tmp_path, ("1e-6 *", "1e-12 *"))
    found = CliRunner().invoke(app, ["effects", "check", str(little)])
    assert "it moves nothing on the trial part" in found.stdout


@pytest.mark.parametrize(
    ("word", "accepted"), [("law", "a few words"), ("source", r"equation \(NUMBER\)")]
)
def test_an_effect_of_the_package_states_its_equation(tmp_path, word, accepted):
    file = written(tmp_path)
    kind = type(load_effect_file(file))
    for other in {"shows_as", "law", "usual_size", "confirm", "cure"} - {word}:
        setattr(kind, other, "said")
    with pytest.raises(InputError, match=rf"twist\.py:6: .*{word} = ''; accepted: {accepted}"):
        check_declaration(kind, file, is_printed=True)


def test_the_core_knows_no_single_effect():
    """Outside the laws nothing imports one, but for what several rooms share."""
    root = Path(__file__).parents[2] / "vmach"
    imports = re.compile(r"from vmach\.effects\.laws\.(\S+) import")
    wrong = [
        f"{path.relative_to(root)}: {found}"
        for path in root.rglob("*.py")
        if "laws" not in path.parts
        for found in imports.findall(path.read_text(encoding="utf-8"))
        if found != "heat.wandering"
    ]
    assert not wrong
