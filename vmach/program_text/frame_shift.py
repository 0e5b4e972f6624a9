"""Zeros that a program sets where the tool stands: a corrected tool takes them along."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from gcode import WORK_OFFSETS, Program, Step

__all__ = ["FrameShift", "mirrored_moves", "rotation_of_moves", "turned_about_z", "zero_settings"]

_SYSTEMS = {name: number for number, name in enumerate(WORK_OFFSETS, 1)}
_G92 = {"G92", "G92.1", "G92.2", "G92.3"}
_SET_HERE, _SET_PLAINLY = 20, 2
_OF_INTEREST = _SYSTEMS.keys() | _G92 | {"G10", "G52"}


def rotation_of_moves(program: Program) -> np.ndarray:
    """Angle about Z, rad, by which the axes of every move are turned, (N,).

    That of the work system and that of a programmable frame (ROT, CYCL DEF 10) together.
    """
    angle_deg = _in_force(program, "set_xy_rotation", 0) + _in_force(program, "set_turn", 0)
    return np.radians(angle_deg)


def mirrored_moves(program: Program) -> np.ndarray:
    """Moves in the mirror image of X or Y of a programmable frame, (N,) bool."""
    return (_in_force(program, "set_turn", 1) < 0.0) | (_in_force(program, "set_turn", 2) < 0.0)


def _in_force(program: Program, event: str, place: int) -> np.ndarray:
    """One value of the last event before every move, (N,); zero before the first."""
    count = len(program.moves)
    row, told = program.record.events_of(event)
    value = np.concatenate([[0.0], told[:, place] if len(row) else []])
    return np.repeat(value, np.diff(np.concatenate([[0], np.minimum(row, count), [count]])))


def zero_settings(program: Program) -> list[tuple[Step, float]]:
    """Lines that set or choose a zero, where any sets it at the tool; angle in force then, rad."""
    if not program.language.is_rs274:
        return []
    found = [
        s
        for s in program.outline
        if isinstance(s, Step) and s.blocks and not _OF_INTEREST.isdisjoint(s.g_names)
    ]
    if not any(_sets_here(step) for step in found):
        return []
    turns = program.record.said_events(["set_xy_rotation"])
    last = np.searchsorted(np.maximum.accumulate(turns.line), [s.line for s in found], "right")
    degrees = np.array([0.0, *(turns.told[k][1] for k in turns.which)])[last]
    return list(zip(found, np.radians(degrees).tolist(), strict=True))


def _sets_here(step: Step) -> bool:
    codes = step.g_names
    return "G92" in codes or ("G10" in codes and step.words.get("L") == _SET_HERE)


@dataclass(frozen=True)
class FrameShift:
    """How far the control's zeros are from where the user's program has them, mm.

    G92 and G10 L20 make the tool's present place read as their words say. A tool that stands
    off its nominal place by a correction shifts the zero by that correction.

    Attributes
    ----------
    system : int
        Work system in force, 1 for G54.
    g92_mm, stored_mm : (3,) float64
        Of the offset by G92 in force and of the one that G92.3 calls back; axes of the program.
    systems_mm : mapping of int to (3,) float64
        Of the work systems; axes of the machine.
    """

    system: int = 1
    g92_mm: np.ndarray = field(default_factory=lambda: np.zeros(3))
    stored_mm: np.ndarray = field(default_factory=lambda: np.zeros(3))
    systems_mm: Mapping[int, np.ndarray] = field(default_factory=dict)

    def total_mm(self, angle_rad: float) -> np.ndarray:
        """Shift of the zero in force, machine axes, (3,), where the program is turned about Z."""
        own = self.systems_mm.get(self.system, np.zeros(3))
        return turned_about_z(self.g92_mm, angle_rad) + own

    def after(self, step: Step, carried_mm: np.ndarray, angle_rad: float) -> FrameShift:
        """The shift after a line.

        Parameters
        ----------
        step : Step
        carried_mm : (3,) float64
            Where the tool stands, from its nominal place; machine axes.
        angle_rad : float
            By which the program is turned about Z.
        """
        codes = step.g_names
        named = np.array([axis in step.words for axis in "XYZ"])
        chosen = next((_SYSTEMS[code] for code in codes if code in _SYSTEMS), self.system)
        shift = replace(self, system=chosen)
        if "G10" in codes:
            here = carried_mm - turned_about_z(shift.g92_mm, angle_rad)
            return shift._with_system(step, named, here)
        if codes & (_G92 | {"G52"}):
            own = shift.systems_mm.get(chosen, np.zeros(3))
            return shift._with_offset(codes, named, turned_about_z(carried_mm - own, -angle_rad))
        return shift

    def _with_system(self, step: Step, named: np.ndarray, here: np.ndarray) -> FrameShift:
        form, number = step.words.get("L"), int(step.words.get("P", 0)) or self.system
        if form not in (_SET_HERE, _SET_PLAINLY):
            return self
        before = self.systems_mm.get(number, np.zeros(3))
        own = np.where(named, here if form == _SET_HERE else 0.0, before)
        return replace(self, systems_mm={**self.systems_mm, number: own})

    def _with_offset(self, codes: set[str], named: np.ndarray, here: np.ndarray) -> FrameShift:
        if codes & {"G92", "G52"}:
            offset = np.where(named, here if "G92" in codes else 0.0, self.g92_mm)
            return replace(self, g92_mm=offset, stored_mm=offset)
        if "G92.3" in codes:
            return replace(self, g92_mm=self.stored_mm)
        stored = np.zeros(3) if "G92.1" in codes else self.stored_mm
        return replace(self, g92_mm=np.zeros(3), stored_mm=stored)


def turned_about_z(vector: np.ndarray, angle_rad: np.ndarray | float) -> np.ndarray:
    """Vectors (..., 3) turned about Z."""
    if not (angle_rad.any() if isinstance(angle_rad, np.ndarray) else angle_rad):
        return vector
    cos, sin = np.cos(angle_rad), np.sin(angle_rad)
    x, y, z = np.moveaxis(vector, -1, 0)
    return np.stack([cos * x - sin * y, sin * x + cos * y, z], axis=-1)
