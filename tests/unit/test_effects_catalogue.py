"""Every effect of the catalogue keeps the promises that a fit and a job rely on."""

from __future__ import annotations

import re
import sys
from importlib import import_module, invalidate_caches
from pathlib import Path

import numpy as np
import pytest

from tests.small_job import write_job
from vmach.effects import Circumstances, catalogue, load_effect_file, read_effects, set_up_effect
from vmach.effects.skeleton import write_skeleton
from vmach.errors import InputError
from vmach.job import read_job
from vmach.machine import RigidDisplacement
from vmach.path.preparation import prepare
from vmach.path.toolpath import PathStates

UNITS = {"um", "urad", "ppm", "mm", "s", "ms", "ms2", "rad", "m", "exponent", "share"}


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    """States with normals all over a small job whose machine has an angle on every axis."""
    folder = tmp_path_factory.mktemp("job")
    errors = {f"EA{axis}": (lambda x: 10 * np.sin(x / 40), None) for axis in "XYZ"} | {
        f"E{kind}{axis}": (lambda x: 3 * np.cos(x / 60), (10.0, -20.0, 30.0))
        for axis in "XYZ"
        for kind in "XYZ"
    }
    job = read_job(write_job(folder, errors))
    nodes = prepare(job).path.nodes
    random = np.random.default_rng(3)
    normal = random.standard_normal((len(nodes), 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    contact = np.column_stack([-5 * normal[:, :2], random.uniform(0, 8, len(nodes))])
    states = PathStates(
        nodes.moves, nodes.tool_lengths_mm, nodes.move, nodes.parameter, contact, normal
    )
    return Circumstances(states, job)


def at_contact(moved, path):
    return moved.at(path.contact_mm) if isinstance(moved, RigidDisplacement) else moved


@pytest.mark.parametrize("name", list(catalogue()))
def test_effect_is_linear_and_vanishes_with_its_amplitudes(name, path):
    effect = catalogue()[name]
    random = np.random.default_rng(5)
    for target in effect.possible_targets(path.job):
        if effect.not_testable(path, target) is not None:
            continue
        inner = next(iter(effect.inner_grid(path, target)))
        columns = effect.columns(path, target, inner)
        assert columns.shape[:2] == (len(path), 3)
        assert np.isfinite(columns).all()
        if name == "component":
            continue
        coefficients = random.standard_normal(columns.shape[2])
        settled = effect.settle(coefficients, inner)
        moved = at_contact(effect.displacement(path, target, **settled), path)
        np.testing.assert_allclose(columns @ coefficients, moved, atol=1e-12)
        nothing = {**settled, **{p.name: 0.0 for p in effect.amplitudes if p.name in settled}}
        still = at_contact(effect.displacement(path, target, **nothing), path)
        np.testing.assert_allclose(still, 0.0, atol=1e-15)


@pytest.mark.parametrize("name", list(catalogue()))
def test_effect_declares_units_bounds_and_words(name):
    effect = catalogue()[name]
    assert re.fullmatch(r"[a-z]+(_[a-z]+)*", name)
    assert effect.parameters and effect.title and effect.usual_size
    assert effect.confirm and effect.cure
    for parameter in effect.parameters:
        assert parameter.name.rsplit("_", 1)[-1] in UNITS, parameter.name
        assert parameter.low < parameter.high and parameter.usual > 0 and parameter.meaning


def test_component_correction_acts_as_its_table_would(path):
    """A correction of one table equals the displacement of a machine with that table changed."""
    job = path.job
    knots = [-400.0, -250.0, -150.0, 0.0]
    values = [0.0, 8.0, -6.0, 3.0]
    effect = set_up_effect(
        "component", "EAX", {"position_mm": knots, "correction_urad": values}, job=job
    )
    moved = effect.displacement(path.states)
    arm = path.tool_mm + job.machine.chain.arm_masks[0] * path.nose_mm
    angle = 1e-6 * np.interp(path.nose_mm[:, 0], knots, values)
    reference = np.array([10.0, -20.0, 30.0])
    turned = np.cross(np.column_stack([angle, 0 * angle, 0 * angle]), arm - reference)
    np.testing.assert_allclose(moved.shift_mm, turned, atol=1e-12)


def test_a_mismatch_is_of_axes_that_move_together(path):
    """Where Z stands while X and Y move, XY, XZ and YZ would be the same to every surface."""
    mismatch, velocity = catalogue()["servo_mismatch"], path.velocity_mm_per_s
    level = np.flatnonzero(velocity[:, 2] == 0.0)
    states = path.states
    on_level = PathStates(
        states.moves,
        states.tool_lengths_mm,
        states.move[level],
        states.parameter[level],
        states.contact_mm[level],
        states.normal[level],
    )
    seen = Circumstances(on_level, path.job)
    assert mismatch.not_testable(seen, "XY") is None
    assert mismatch.not_testable(seen, "XZ") == "X and Z never move together"


def test_job_tables_become_effects(tmp_path):
    more = "[effects.backlash.X]\nreversal_um = 6\n[effects.backlash.Y]\nreversal_um = 3\n"
    more += '[effects.scale]\ntarget = "Z"\nscale_ppm = 12\n[effects.probe_radius]\nradius_um = 1\n'
    job = read_job(write_job(tmp_path, more=more))
    found = read_effects(job.effects, file=job.path)
    assert [e.label for e in found] == ["backlash X", "backlash Y", "scale Z", "probe_radius"]
    assert found[0].parameters["reversal_um"] == 6.0


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ("[effects.backlsh]\nreversal_um = 6\n", "did you mean 'backlash'"),
        ("[effects.backlash.Q]\nreversal_um = 6\n", "accepted: X, Y, Z"),
        ("[effects.backlash.X]\nreversal_mm = 6\n", "no parameter 'reversal_mm'"),
        ("[effects.backlash.X]\n", "'reversal_um' is missing"),
        ("[effects.backlash.X]\nreversal_um = 1e9\n", "out of bounds"),
        ("[effects.backlash.X]\nreversal_um = 'much'\n", "no number"),
        ("[effects]\nbacklash = 3\n", "accepted: a table"),
    ],
)
def test_wrong_tables_are_refused_with_the_line(tmp_path, more, message):
    job = read_job(write_job(tmp_path, more=more))
    with pytest.raises(InputError, match=re.escape(message)) as caught:
        read_effects(job.effects, file=job.path)
    assert caught.value.line is not None


@pytest.mark.usefixtures("no_effects_added")
def test_skeleton_is_a_working_effect(tmp_path, path):
    file = write_skeleton("bed_slope", tmp_path)
    effect = load_effect_file(file)
    assert catalogue()["bed_slope"] is effect
    moved = effect.displacement(path, "", rise_um_per_m=1000.0)
    np.testing.assert_allclose(moved[:, 2], 1e-3 * path.nose_mm[:, 0])
    with pytest.raises(InputError, match="already"):
        write_skeleton("bed_slope", tmp_path)


def test_the_catalogue_is_the_callers_own_copy():
    catalogue().clear()
    assert "backlash" in catalogue()


@pytest.mark.parametrize("name", ["Bed", "2x", "backlash", "a-b"])
def test_skeleton_refuses_bad_names(tmp_path, name):
    with pytest.raises(InputError):
        write_skeleton(name, tmp_path)


def test_broken_effect_file_is_a_user_error(tmp_path):
    file = tmp_path / "broken.py"
    file.write_text("raise RuntimeError('no')\n")
    with pytest.raises(InputError, match="cannot be loaded"):
        load_effect_file(file)
    file.write_text("x = 1\n")
    with pytest.raises(InputError, match="0 effects"):
        load_effect_file(file)
    file.write_text("\nx = (\n")
    with pytest.raises(InputError, match=r"broken\.py:2: .*was never closed: 'x = \('"):
        load_effect_file(file)


def test_a_law_in_a_file_beside_the_user_is_told_with_its_line(tmp_path, monkeypatch):
    """The command line is given a relative name."""
    monkeypatch.chdir(tmp_path)
    Path("mine.py").write_text("\n\nraise RuntimeError('no')\n")
    with pytest.raises(InputError, match=r"^mine\.py:3: "):
        load_effect_file("mine.py")


#: an effect of one's own; its law is still to come
MINE = """\
from vmach.effects import Effect, along, linear
class Mine(Effect):
    name = title = 'mine'
    parameters = (linear('size_um', 'size', usual=1.0),)
    targets = ('',)
    usual_size = confirm = cure = ''
    def displacement(self, path, target, size_um):
        """


def test_a_package_whose_effect_cannot_be_loaded_is_named(tmp_path, monkeypatch):
    monkeypatch.setattr(sys, "dont_write_bytecode", True)  # it is written anew within a second
    about = tmp_path / "shop_effects-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: shop-effects\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text("[vmach.effects]\nmine = shop_effects:Mine\n")
    monkeypatch.syspath_prepend(tmp_path)
    module = import_module("vmach.effects.catalogue")
    module._installed.cache_clear()
    with pytest.raises(InputError, match=r"mine = shop_effects:Mine.*the package shop-effects"):
        catalogue()
    law = "return along('Z', 1e-3 * size_um + 0 * path.time_s)"
    (tmp_path / "shop_effects.py").write_text(MINE + law)
    invalidate_caches()
    assert catalogue()["mine"].title == "mine"
    for change, message in (
        (("    usual_size =", "    usual_sice ="), r"effects\.py:6: .*'usual_sice'.*'usual_size'"),
        (("'mine'", "'backlash'"), r"name = 'backlash' is that of vmach\.effects\.laws\.servo"),
    ):
        (tmp_path / "shop_effects.py").write_text((MINE + law).replace(*change))
        monkeypatch.delitem(sys.modules, "shop_effects")
        invalidate_caches()
        module._installed.cache_clear()
        with pytest.raises(InputError, match=message):
            catalogue()
    module._installed.cache_clear()


@pytest.mark.usefixtures("no_effects_added")
@pytest.mark.parametrize(
    ("law", "line", "message"),
    [
        ("return path.nothing", 8, "AttributeError"),
        ("return path.nose_mm[0]", 7, "an array of (3,)"),
        ("return float('nan') * path.nose_mm", 7, "no numbers"),
    ],
)
def test_a_law_that_fails_is_told_by_file_and_line(tmp_path, law, line, message):
    file = tmp_path / "mine.py"
    file.write_text(MINE + law)
    with pytest.raises(InputError, match=re.escape(message)) as caught:
        load_effect_file(file)
    assert (caught.value.file, caught.value.line) == (file, line)
