"""What the audit of a machine finds, and that it is silent on a sound one."""

from __future__ import annotations

from dataclasses import replace
from datetime import date

import numpy as np
import pytest

from tests.machine_cases import make_machine
from vmach.machine import COMPONENT_NAMES, ComponentError, Variant, displacement
from vmach.machine.double_counting import double_counting
from vmach.machine.tables.interpolation import Extrapolation
from vmach.plausibility import machine_notes

POSITION = np.linspace(-500.0, 0.0, 11)


def waves(name, count, at=(-250.0, -250.0, -350.0)):
    """A component error without slope, of its own shape; 2 um or 10 urad."""
    x = POSITION / 500
    shape = np.sin(2 * np.pi * (x * (1 + count % 3) + count / 18))
    shape -= np.polyval(np.polyfit(x, shape, 1), x)
    angular = name[1] in "ABC"
    value = shape * (1e-5 if angular else 2e-3)
    return ComponentError(name, POSITION, value, value, None if angular else np.array(at))


@pytest.fixture
def sound():
    components = {name: waves(name, k) for k, name in enumerate(COMPONENT_NAMES)}
    machine = make_machine("t (C) Z Y b X' w", components, travel_mm=(-500.0, 0.0))
    sigma = np.zeros((3, 3))
    sigma[0, 2], sigma[0, 1], sigma[1, 0] = 14.569e-6, -24.362e-6, 66.697e-6
    return replace(machine, squareness_rad=sigma, reference_axes="ZY")


def changed(machine, name, **changes):
    components = dict(machine.components)
    components[name] = replace(components[name], **changes)
    return replace(machine, components=components)


def found(machine):
    return [(note.level, note.subject) for note in machine_notes(machine)]


def test_sound_machine_gives_no_notes(sound):
    assert machine_notes(sound) == ()


def test_squareness_of_the_thesis_contradicts_its_own_reference_frame(sound):
    # section 3.1: Z primary, Y secondary; section 5.1.1 then states EC0Y, EB0X and EA0Z
    sigma = np.zeros((3, 3))
    sigma[1, 2], sigma[0, 1], sigma[2, 0] = 14.569e-6, -24.362e-6, 13.757e-6
    machine = replace(sound, squareness_rad=sigma)
    assert found(machine) == [("contradiction", "EA0Z"), ("contradiction", "EC0Y")]
    assert "Z is the primary axis" in machine_notes(machine)[0].sentence
    assert "EA0Y, with the other sign" in machine_notes(machine)[0].sentence
    assert "EC0X, with the other sign" in machine_notes(machine)[1].sentence


def test_the_other_name_with_the_other_sign_is_the_same_part():
    # what the hint promises: the fields differ by a small rotation of the whole workpiece
    nose = np.random.default_rng(4).uniform(-500, 0, (50, 3))
    z_leans, y_leans = np.zeros((2, 3, 3))
    z_leans[2, 0], y_leans[1, 0] = 5e-5, -5e-5
    fields = [
        displacement(
            make_machine("t (C) Z Y b X' w", {}, squareness_rad=sigma), nose, np.zeros(3),
            Variant.ABBE,
        ).shift_mm
        for sigma in (z_leans, y_leans)
    ]  # fmt: skip
    rotation = np.cross([5e-5, 0.0, 0.0], nose)
    assert fields[0] - fields[1] == pytest.approx(rotation, abs=1e-15)


def test_one_right_angle_stated_twice(sound):
    sigma = sound.squareness_rad.copy()
    sigma[1, 2] = -14.569e-6
    machine = replace(sound, squareness_rad=sigma, reference_axes="")
    assert found(machine) == [("doubt", "EC0X")]


@pytest.mark.parametrize(
    ("name", "changes", "expected"),
    [
        ("EYX", {"forward": 1e-5 * POSITION, "backward": 1e-5 * POSITION}, "note"),
        ("EYX", {"forward": 1e-5 * POSITION, "backward": 1e-5 * POSITION, "slope_removed": True},
         "contradiction"),
        ("EXX", {"measured_at_mm": np.array([-250.0, 1900.0, -350.0])}, "doubt"),
        ("EXX", {"forward": 2.0 * np.sin(POSITION)}, "refused"),
        ("EXX", {"forward": 0.2 * np.sin(POSITION)}, "doubt"),
        ("EAX", {"forward": 1e-8 * np.sin(POSITION), "backward": np.zeros(11)}, "doubt"),
        ("EZZ", {"measured_at_mm": None}, "note"),
        ("EZZ", {"position_mm": POSITION * 0.9, "extrapolation": Extrapolation.HOLD}, "note"),
    ],
)  # fmt: skip
def test_each_kind_of_doubt(sound, name, changes, expected):
    assert found(changed(sound, name, **changes)) == [(expected, name)]


def test_values_copied_from_another_table(sound):
    copied = sound.components["EBX"]
    machine = changed(sound, "ECX", forward=-copied.forward, backward=-copied.backward)
    assert found(machine) == [("doubt", "EBX")]


def test_missing_tables_are_named_together(sound):
    rest = {n: c for n, c in sound.components.items() if n not in ("EAX", "EBY", "ECZ")}
    assert found(replace(sound, components=rest)) == [("note", "EAX EBY ECZ")]


def test_provenance_and_dates(sound):
    machine = changed(sound, "EAX", provenance="assumed", measured_on=date(2024, 3, 1))
    machine = changed(machine, "EAY", provenance="assumed", measured_on=date(2024, 3, 20))
    assert found(machine) == [("note", "EAX EAY")]
    machine = changed(machine, "EZZ", provenance="measured", measured_on=date(2024, 9, 1))
    assert found(machine) == [("doubt", "EAX EZZ"), ("note", "EAX EAY")]


def test_double_count_of_an_angle_by_hand():
    # pitch of 10 urad over the travel, reflector 400 mm below the nose: 4 um in X
    pitch = ComponentError("EBX", np.array([-500.0, 0.0]), *[np.array([0.0, 1e-5])] * 2)
    reading = ComponentError(
        "EXX", np.array([-500.0, 0.0]), *[np.array([0.0, -4e-3])] * 2, np.array([0.0, 0.0, -400.0])
    )
    machine = make_machine("t (C) Z Y b X' w", {"EBX": pitch, "EXX": reading})
    (share,) = double_counting(machine)
    assert (share.component, share.reading_mm) == ("EXX", pytest.approx(4e-3))
    assert share.share_mm == pytest.approx(4e-3)
    assert share.correlation == pytest.approx(1.0)
    # all of the reading is pitch: at the height of the reflector the tip is off by the reading
    # alone, and the conventional form says twice as much
    nose, tool = np.array([[0.0, 0.0, 0.0]]), np.array([0.0, 0.0, -400.0])
    assert displacement(machine, nose, tool, Variant.ABBE).shift_mm[0, 0] == pytest.approx(-4e-3)
    assert displacement(machine, nose, tool, Variant.HTM).shift_mm[0, 0] == pytest.approx(-8e-3)
