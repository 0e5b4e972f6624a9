"""Does a law do what its class says: in proportion to its amplitudes, nothing without them?"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from itertools import islice
from pathlib import Path

import numpy as np

from vmach.effects.effect import Effect, at_contact, label_of
from vmach.effects.guard import line_of
from vmach.errors import InputError
from vmach.machine import RigidDisplacement
from vmach.path.circumstances import Circumstances

__all__ = ["check_law", "largest_displacement_mm"]

#: no effect moves the tool as far at its usual size (mm)
_TOO_FAR_MM = 1.0
#: times the usual size at which a law is tried; a fit goes up to 30
_TRIED = (2.0, 30.0, -1.0)
#: what rounding may leave of a proportion, as a share of the largest displacement; and in mm
_ROUNDING, _ROUNDING_MM = 1e-6, 1e-12
#: combinations of inner values at which an effect is asked for all it can tell
_MOST_INNER = 60


def check_law(effect: Effect, path: Circumstances, *, file: Path | None = None) -> None:
    """Refuse a law that is not proportional to its amplitudes, on any target of a path.

    An effect with columns of its own is held against these.

    Parameters
    ----------
    effect : Effect
    path : Circumstances
        Where it is tried.
    file : Path, optional
        Where the law stands.

    Raises
    ------
    InputError
        With the line of the law, the parameter, and by how much it is off.
    """
    for target in effect.possible_targets(path.job):
        if effect.not_testable(path, target) is not None:
            continue
        inner = next(iter(effect.inner_grid(path, target)), {})
        _Trial(effect, path, target, inner, file).check()
        _ask_all(effect, path, target)


def _ask_all(effect: Effect, path: Circumstances, target: str) -> None:
    """Ask for everything that a prediction or a fit asks for: what is wrong comes to light here."""
    effect.needed(target)
    effect.is_unmeasured(path.job.machine, target)
    effect.shows_on(path.states)
    for inner in islice(effect.inner_grid(path, target), _MOST_INNER):
        count = effect.columns(path, target, inner).shape[2]
        parameters = effect.settle(np.ones(count), inner)
        effect.unforeseen(path, target, parameters)
        bare = replace(path.states, contact_mm=np.zeros((len(path), 3)), normal=None)
        on_tool = effect.tool_shift if effect.needs_surface else effect.displacement
        on_tool(replace(path, states=bare), target, **parameters)


class _Trial:
    """A law on one target, with inner parameters chosen."""

    def __init__(
        self,
        effect: Effect,
        path: Circumstances,
        target: str,
        inner: Mapping[str, float],
        file: Path | None,
    ) -> None:
        self.effect, self.path, self.target = effect, path, target
        self.inner, self.file = inner, file

    def check(self) -> None:
        effect = self.effect
        columns = effect.columns(self.path, self.target, self.inner)
        if type(effect).settle is Effect.settle and columns.shape[2] != len(effect.amplitudes):
            raise self._error(
                f"columns() gives {columns.shape[2]} columns",
                f"one for each of its {len(effect.amplitudes)} amplitudes",
            )
        largest = float(np.abs(columns).max(initial=0.0))
        if largest > _TOO_FAR_MM:
            raise self._error(
                f"at its usual size it moves the tool by {largest:.3g} mm",
                f"displacements in mm, up to {_TOO_FAR_MM:g} mm",
                hint="is a factor missing? 1 um is 1e-3 mm",
            )
        self._check_again(columns)
        self._check_zero(largest)
        self._check_turning(columns.shape[2])
        for k in range(columns.shape[2]):
            for factor in _TRIED:
                self._check_proportion(columns, k, factor)
        together = np.linspace(0.5, 1.5, columns.shape[2])
        off = np.abs(self._moved(together) - columns @ together).max(initial=0.0)
        if off > self._allowed(2.0 * largest):
            raise self._error(
                f"its amplitudes together move by {off:.3g} mm otherwise than one by one",
                "displacements that add up",
            )

    def _check_again(self, columns: np.ndarray) -> None:
        off = np.abs(self.effect.columns(self.path, self.target, self.inner) - columns)
        if off.max(initial=0.0) > 0.0:
            raise self._error(
                f"asked twice for the same, it differs by {off.max():.3g} mm",
                "a displacement that its arguments alone decide",
                hint="without numbers by chance, and without values kept from call to call",
            )

    def _check_zero(self, largest_mm: float) -> None:
        count = self.effect.columns(self.path, self.target, self.inner).shape[2]
        rest = np.abs(self._moved(np.zeros(count))).max(initial=0.0)
        if rest > _ROUNDING_MM:
            names = ", ".join(p.name for p in self.effect.amplitudes)
            raise self._error(
                f"with {names} = 0 it still moves by up to {rest:.3g} mm "
                f"({largest_mm:.3g} mm at the usual size)",
                "no displacement without the amplitudes",
            )

    def _check_turning(self, count: int) -> None:
        parameters = self.effect.settle(np.ones(count), self.inner)
        moved = self.effect.displacement(self.path, self.target, **parameters)
        turns = isinstance(moved, RigidDisplacement) and bool(moved.tilt_rad.any())
        if turns and not self.effect.turns_tool:
            raise self._error(
                "it turns the tool, and its class does not say so",
                "turns_tool = True where a tilt is given",
            )

    def _check_proportion(self, columns: np.ndarray, k: int, factor: float) -> None:
        if factor < 0.0 and any(p.is_size for p in self.effect.amplitudes):
            return
        coefficients = np.zeros(columns.shape[2])
        coefficients[k] = factor
        wanted = factor * columns[:, :, k]
        off = float(np.abs(self._moved(coefficients) - wanted).max(initial=0.0))
        if off <= self._allowed(float(np.abs(wanted).max(initial=0.0))):
            return
        is_plain = type(self.effect).columns is Effect.columns
        name = self.effect.amplitudes[k].name if is_plain else f"column {k + 1}"
        raise self._error(
            f"it is not proportional to {name}: at {factor:g} times the usual size it is off by "
            f"{off:.3g} mm",
            "a displacement in proportion to every linear(...) parameter",
            hint="what is not proportional is an inner(..., grid=...) parameter",
        )

    def _moved(self, coefficients: np.ndarray) -> np.ndarray:
        parameters = self.effect.settle(coefficients, self.inner)
        moved = self.effect.displacement(self.path, self.target, **parameters)
        return at_contact(moved, self.path)

    def _allowed(self, largest_mm: float) -> float:
        return max(_ROUNDING * largest_mm, _ROUNDING_MM)

    def _error(self, what: str, accepted: str, hint: str | None = None) -> InputError:
        label = label_of(self.effect.name, self.target)
        return InputError(
            f"displacement() of effect '{label}': {what}",
            file=self.file,
            line=line_of(type(self.effect), "displacement") if self.file else None,
            accepted=accepted,
            hint=hint,
        )


def largest_displacement_mm(effect: Effect, path: Circumstances) -> float:
    """How far the usual size of any amplitude of an effect moves the tool at most, mm."""
    largest = 0.0
    for target in effect.possible_targets(path.job):
        if effect.not_testable(path, target) is None:
            inner = next(iter(effect.inner_grid(path, target)), {})
            columns = effect.columns(path, target, inner)
            largest = max(largest, float(np.abs(columns).max(initial=0.0)))
    return largest
