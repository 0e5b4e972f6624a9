"""What an effect is: declared parameters, the axes it can act on, one pure function."""

from __future__ import annotations

import itertools
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import ClassVar

import numpy as np

from vmach.effects.parameter import Parameter
from vmach.effects.wandering import wandering
from vmach.job import Job
from vmach.machine import LINEAR_AXES, Machine, RigidDisplacement
from vmach.path.circumstances import Circumstances
from vmach.path.toolpath import PathStates

__all__ = [
    "Displaced",
    "Effect",
    "along",
    "at_contact",
    "label_of",
]

Displaced = RigidDisplacement | np.ndarray


def along(axis: str, amount_mm: np.ndarray) -> np.ndarray:
    """Displacement (P, 3) of `amount_mm` (P,) in the direction of one axis.

    Examples
    --------
    >>> import numpy as np
    >>> import vmach
    >>> vmach.along("Z", np.array([0.001, 0.002]))
    array([[0.   , 0.   , 0.001],
           [0.   , 0.   , 0.002]])
    """
    shift = np.zeros((len(amount_mm), 3))
    shift[:, LINEAR_AXES.index(axis)] = amount_mm
    return shift


def label_of(name: str, target: str) -> str:
    """An effect's name and what it acts on, for people: ``backlash X``, ``servo_lag``."""
    return f"{name} {target}".rstrip()


class Effect(ABC):
    """A physical effect that the error tables do not hold.

    A subclass is one file: the class attributes below and one pure function, `displacement`.
    Amplitudes (`linear` parameters) have to enter proportionally; everything else is an `inner`
    parameter with a grid of starting values.

    Examples
    --------
    >>> from vmach.effects import Effect, along, linear
    >>> class Twist(Effect):
    ...     name = "twist"
    ...     title = "twist of the bed"
    ...     parameters = (linear("twist_um_per_m2", "rise over one square metre", usual=20.0),)
    ...     targets = ("",)
    ...
    ...     def displacement(self, path, target, twist_um_per_m2):
    ...         x, y, _ = path.nose_mm.T
    ...         return along("Z", -1e-9 * twist_um_per_m2 * x * y)
    """

    name: ClassVar[str]
    title: ClassVar[str]
    parameters: ClassVar[tuple[Parameter, ...]]
    #: axes, tools, components ... that it can act on; ("",) where there is nothing to choose
    targets: ClassVar[tuple[str, ...]] = LINEAR_AXES
    #: whether it acts on the cutting edge at a surface, and not on the tool as a whole
    needs_surface: ClassVar[bool] = False
    #: whether it turns the tool too: what reads tilts sees no other effect
    turns_tool: ClassVar[bool] = False
    #: rank by how often it is met: where data cannot tell effects apart, the larger leads
    commonness: ClassVar[int] = 0
    #: whether it corrects an error table: its parameters are then the lists of a curve
    corrects_table: ClassVar[bool] = False
    #: whether it is plain: a curve of a table that nobody measured is what lies beyond it
    goes_before_curves: ClassVar[bool] = False
    #: whether it begins at one moment, its inner parameter ``time_s``
    is_sudden: ClassVar[bool] = False
    #: whether it is always there a little, and may join in an imitation of another effect
    is_never_exact: ClassVar[bool] = False
    #: whether it imitates another effect when it acts alike on all axes, or on all tools
    imitates_as_team: ClassVar[bool] = False
    #: whether it depends on how the axes travel: passes over one place then differ, and of those
    #: that cross a floor the lowest one makes it
    follows_travel: ClassVar[bool] = False
    #: effects with the same signature share this word: none is a team against the other
    signature: ClassVar[str] = ""
    #: how many times rarer than the common effects, as a logarithm; weighs in close calls only
    rarity: ClassVar[float] = 0.0
    #: what the law leaves out, as a share of the effect, wandering over this time
    slack_share: ClassVar[float] = 0.0
    slack_time_s: ClassVar[float] = 60.0
    #: what a measured part shows of it, in a few words
    shows_as: ClassVar[str] = ""
    #: its equation; docs/laws.md explains the symbols
    law: ClassVar[str] = ""
    usual_size: ClassVar[str] = ""
    confirm: ClassVar[str] = ""
    cure: ClassVar[str] = ""
    #: where the law comes from, with the number of its equation
    source: ClassVar[str] = ""
    #: where it was loaded from, for an effect of a user's own
    file: Path | None = None

    @abstractmethod
    def displacement(self, path: Circumstances, target: str, **parameters: float) -> Displaced:
        """Displacement of the tool relative to the workpiece, actual minus nominal.

        Returns
        -------
        (P, 3) float64, mm
            At the contact; or a `RigidDisplacement` where the tool also turns.
        """

    def tool_shift(
        self, path: Circumstances, target: str, **parameters: float
    ) -> np.ndarray | None:
        """Of an effect on the surface: what moves the whole tool, wherever it touches, (P, 3) mm.

        The states may belong to no surface. Of passes that compete for one surface it tells which
        one makes it. None where the effect moves the edge alone.
        """
        return None

    def travel_axes(self, target: str) -> frozenset[str]:
        """Axes whose travel it follows: those of its target, all where that names none."""
        if not self.follows_travel:
            return frozenset()
        return frozenset(LINEAR_AXES).intersection(target) or frozenset(LINEAR_AXES)

    def possible_targets(self, job: Job) -> tuple[str, ...]:
        """The targets that this job has; those of the class unless overridden."""
        return self.targets

    def is_unmeasured(self, machine: Machine, target: str) -> bool:
        """Whether every machine has some of it, and nobody measured how much of it this one has."""
        return False

    def needed(self, target: str) -> tuple[str, ...]:
        """Names of the parameters that a job has to give for a target."""
        return tuple(p.name for p in self.parameters if not p.optional)

    def complaint(
        self, target: str, parameters: Mapping[str, float | list[float]]
    ) -> tuple[str, str, str] | None:
        """What is wrong with values that are each within their bounds, or None.

        The key at fault, what is wrong, and what is accepted.
        """
        return None

    def not_testable(self, path: Circumstances, target: str) -> str | None:
        """Why these states cannot show the effect, in words, or None."""
        return None

    def alike(
        self, paths: Sequence[Circumstances], target: str, parameters: Mapping[str, float]
    ) -> tuple[dict[str, float], ...]:
        """Other parameters that do the same at all these states; none unless overridden."""
        return ()

    def slack_pattern(
        self, path: Circumstances, target: str, parameters: Mapping[str, float]
    ) -> np.ndarray:
        """Where the law's own inaccuracy shows, at full size, (P, 3) mm; the effect itself."""
        return at_contact(self.displacement(path, target, **parameters), path)

    def slack(
        self, path: Circumstances, target: str, parameters: Mapping[str, float]
    ) -> np.ndarray:
        """Displacements of unit variance by which nature may differ from the law, (P, 3, K)."""
        if self.slack_share == 0.0:
            return np.zeros((len(path), 3, 0))
        pattern = self.slack_share * self.slack_pattern(path, target, parameters)
        return pattern[:, :, None] * wandering(path.time_s, self.slack_time_s)[:, None, :]

    def unforeseen(
        self, path: Circumstances, target: str, parameters: Mapping[str, float]
    ) -> np.ndarray:
        """Displacements of unit variance by which another run may differ, (P, 3, K); the slack."""
        return self.slack(path, target, parameters)

    def shows_on(self, states: PathStates) -> bool:
        """Whether readings of this kind can show it: of a surface, of a place, of a tilt."""
        if states.arm_mm is not None and not self.turns_tool:
            return False
        return states.normal is not None or not self.needs_surface

    def is_twin_of(self, other: Effect) -> bool:
        """Whether it is the other effect, or has the same signature."""
        return self.name == other.name or (
            self.signature != "" and self.signature == other.signature
        )

    def knots_mm(self, path: Circumstances, target: str) -> np.ndarray:
        """Axis positions of the curve of an effect that corrects a table, (K,)."""
        raise NotImplementedError

    def curve(self, path: Circumstances, target: str, **inner_values: float) -> np.ndarray:
        """From its coefficients to the correction at the knots, um or urad, (K, K)."""
        raise NotImplementedError

    def beyond_slope(
        self, inner_values: Mapping[str, float], target: str, nose_mm: np.ndarray
    ) -> dict[str, float]:
        """Inner values of a curve that has no slope over the places of readings, (P, 3) mm."""
        raise NotImplementedError

    def moments_like(
        self, path: Circumstances, target: str, inner_values: Mapping[str, float]
    ) -> float:
        """Of a sudden effect: the whole time over that of the pause that its moment lies in."""
        return float(len(list(self.inner_grid(path, target))))

    # what a fit works with; an effect overrides these only where its amplitudes hide ----------

    @cached_property
    def amplitudes(self) -> tuple[Parameter, ...]:
        """The linear parameters."""
        return tuple(p for p in self.parameters if p.is_linear)

    @cached_property
    def inner_parameters(self) -> tuple[Parameter, ...]:
        """The parameters with a grid."""
        return tuple(p for p in self.parameters if not p.is_linear)

    def inner_grid(self, path: Circumstances, target: str) -> Iterator[dict[str, float]]:
        """Every combination of the inner parameters' starting values."""
        names = [p.name for p in self.inner_parameters]
        for values in itertools.product(*(p.grid for p in self.inner_parameters)):
            yield dict(zip(names, values, strict=True))

    def places(
        self, path: Circumstances, target: str, inner_values: Mapping[str, float]
    ) -> list[tuple[dict[str, float], float]]:
        """Inner values to choose among around given ones, and how likely each was before.

        Empty where the inner parameters move smoothly, as nearly all of them do.
        """
        return []

    def columns(
        self, path: Circumstances, target: str, inner_values: Mapping[str, float]
    ) -> np.ndarray:
        """Displacement at the contact for one usual size of each coefficient, (P, 3, K) mm."""
        parts = []
        for one in self.amplitudes:
            unit = {p.name: p.usual * float(p is one) for p in self.amplitudes}
            moved = self.displacement(path, target, **unit, **inner_values)
            parts.append(at_contact(moved, path))
        return np.stack(parts, axis=2)

    def settle(
        self, coefficients: np.ndarray, inner_values: Mapping[str, float]
    ) -> dict[str, float]:
        """The parameters, from fitted multiples (K,) of the columns."""
        found = {
            p.name: float(p.usual * c) for p, c in zip(self.amplitudes, coefficients, strict=True)
        }
        return {**found, **inner_values}


def at_contact(moved: Displaced, path: Circumstances) -> np.ndarray:
    """What is seen at the contact, (P, 3) mm, of what an effect says of the tool."""
    return path.states.seen_mm(moved)
