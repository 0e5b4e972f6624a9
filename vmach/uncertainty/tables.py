"""What the error tables do not know: noise of their readings and the curve between them.

All of it is carried as independent causes of unit variance, each with its signature on the
readings: the covariance of the prediction is ``F F^T`` for the matrix F of signatures.

Source: JCGM 100:2008 (GUM), 4.2 (type A) for the noise; JCGM 101:2008, 6.4.9 (a t-distribution
where an uncertainty is itself read off few readings); C. de Boor, A Practical Guide to Splines
(1978): linear interpolation errs by h^2 f'' / 8 in the middle.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from vmach.effects import Circumstances
from vmach.machine import (
    COMPONENT_NAMES,
    LINEAR_AXES,
    ComponentError,
    Machine,
    RigidDisplacement,
    Variant,
)  # fmt: skip
from vmach.machine.component_errors import component_of
from vmach.machine.squareness import lean_direction, squareness_name
from vmach.machine.tables.interpolation import Extrapolation
from vmach.path.levers import levers, tilts_of_axes_rad
from vmach.path.toolpath import PathStates
from vmach.path.touched_zero import touched_zero

__all__ = ["STATED", "Cause", "Pool", "TableUncertainty", "signature"]

#: where a table shows no difference between both directions, its noise is taken as this
_DEFAULT_MM, _DEFAULT_RAD = 0.2e-3, 0.3e-6
_SQUARENESS_RAD = 1e-6
#: C0Y, B0X, A0Y as (axis, rotation); the other three turn the frame, which nobody measures
_SQUARENESSES = ((1, 2), (0, 1), (1, 0))


@dataclass(frozen=True)
class Pool:
    """Causes whose common uncertainty was read off the same readings.

    Attributes
    ----------
    name : str
    degrees_of_freedom : float
        Of that uncertainty; infinite where it was stated.
    """

    name: str
    degrees_of_freedom: float = np.inf


#: causes of a stated uncertainty
STATED = Pool("stated")


@dataclass(frozen=True)
class Cause:
    """Q independent corrections of one thing, and the displacement that they make at P places.

    Attributes
    ----------
    label : str
        What is not known, for people.
    lever : RigidDisplacement
        Of the tool by one unit (mm or rad), (P, 3).
    size : (P, Q) float64
        In that unit, for one standard uncertainty of each correction.
    pool : Pool
    """

    label: str
    lever: RigidDisplacement
    size: np.ndarray
    pool: Pool = STATED

    def moved(self, drawn: np.ndarray) -> RigidDisplacement:
        """The tool's displacement where the corrections (Q,) are drawn, in their u."""
        amount = (self.size @ drawn)[:, None]
        return RigidDisplacement(amount * self.lever.shift_mm, amount * self.lever.tilt_rad)


@dataclass(frozen=True)
class TableUncertainty:
    """Standard uncertainties of a machine's tables.

    Attributes
    ----------
    reading_mm, reading_rad : float
        Of the mean of both directions at a table's position: as the machine file states it, else
        from the scatter of their difference over all tables of the machine.
    pools : (Pool, Pool)
        How well these two are known.
    bend : mapping of component to (K - 1,) float64
        Distance of the curve from the straight line in the middle of every interval, mm or rad,
        by the curvature of the table.
    bend_apart : mapping of component to float
        RMS of the differences of it between neighbouring points: its uncertainty.
    squareness_rad : float
    positioning_share, measured_at_mm : float
        As in `MeasuringUncertainty`.
    """

    reading_mm: float
    reading_rad: float
    pools: tuple[Pool, Pool]
    bend: dict[str, np.ndarray]
    bend_apart: dict[str, float]
    squareness_rad: float = _SQUARENESS_RAD
    positioning_share: float = 0.0
    measured_at_mm: float = 0.0

    @classmethod
    def of(cls, machine: Machine) -> TableUncertainty:
        """What the machine file states; the rest estimated from the tables themselves."""
        stated = machine.uncertainty
        tables = machine.components.items()
        (reading_mm, lengths), (reading_rad, angles) = (
            _reading([t for n, t in tables if component_of(n)[2] == angular], own, default, name)
            for angular, own, default, name in (
                (False, stated.reading_mm, _DEFAULT_MM, "length"),
                (True, stated.reading_rad, _DEFAULT_RAD, "angle"),
            )
        )
        bends = {n: _bends(t.position_mm, t.mean) for n, t in tables}
        square = stated.squareness_rad
        return cls(
            reading_mm,
            reading_rad,
            (lengths, angles),
            {name: both.mean(axis=0) for name, both in bends.items()},
            {n: _root_mean_square(0.5 * np.diff(b, axis=0)) for n, b in bends.items()},
            _SQUARENESS_RAD if square is None else square,
            stated.positioning_share,
            stated.measured_at_mm,
        )

    def causes(
        self, machine: Machine, nose_mm: np.ndarray, tool_mm: np.ndarray, variant: Variant,
        direction: np.ndarray | None = None,
    ) -> Iterator[Cause]:  # fmt: skip
        """Every cause, always in the same order.

        Parameters
        ----------
        machine : Machine
        nose_mm, tool_mm : (P, 3) float64
            Axis positions, and the vector from nose to tip.
        variant : Variant
        direction : (P, 3) number, optional
            Sign of the last motion of each axis, 0 where not known, where tables are kept apart by
            it; without it the mean of both directions acts.
        """
        lever = levers(machine, nose_mm, tool_mm, variant)
        for name in COMPONENT_NAMES:
            if name in machine.components:
                ways = None if direction is None else direction[:, component_of(name)[1]]
                yield from self._of_table(machine.components[name], nose_mm, lever[name], ways)
        still = np.zeros_like(nose_mm)
        for axis, rotation in _SQUARENESSES:
            lean = np.multiply.outer(nose_mm[:, axis], lean_direction(axis, rotation))
            size = np.full((len(nose_mm), 1), self.squareness_rad)
            yield Cause(squareness_name(axis, rotation), RigidDisplacement(lean, still), size)
        if self.positioning_share:
            yield self._of_scale(machine, nose_mm)
        if self.measured_at_mm and variant is Variant.ABBE:
            yield from self._of_places(machine, nose_mm, tool_mm)

    def _of_table(
        self, table: ComponentError, nose_mm: np.ndarray, lever: RigidDisplacement,
        ways: np.ndarray | None,
    ) -> Iterator[Cause]:  # fmt: skip
        _, axis, angular = component_of(table.name)
        hats, bump, interval = _hats_and_bumps(
            nose_mm[:, axis], table.position_mm,
            is_line_beyond=table.extrapolation is Extrapolation.LINEAR,
        )  # fmt: skip
        u = self.reading_rad if angular else self.reading_mm
        # one column for both directions is one reading, whichever way the axis came
        is_one = ways is None or np.array_equal(table.forward, table.backward)
        read = hats if is_one else _of_directions(hats, ways)
        yield Cause(f"{table.name} readings", lever, u * read, self.pools[int(angular)])
        # one cause for all: where the curve bends one way, it does so over intervals
        bends = np.zeros_like(hats)
        bends[:, 0] = bump * self.bend[table.name][interval]
        bends[np.arange(len(bump)), 1 + interval] = self.bend_apart[table.name] * bump
        yield Cause(f"{table.name} between positions", lever, bends)

    def _of_scale(self, machine: Machine, nose_mm: np.ndarray) -> Cause:
        """The scale of all positioning tables, which were zeroed at their first positions."""
        shift = np.zeros_like(nose_mm)
        for axis, name in enumerate(f"E{a}{a}" for a in LINEAR_AXES):
            if name in machine.components:
                start_mm = machine.components[name].position_mm[0]
                shift[:, axis] = nose_mm[:, axis] - start_mm
        size = np.full((len(nose_mm), 1), self.positioning_share)
        return Cause("scale of positioning", RigidDisplacement(shift, np.zeros_like(shift)), size)

    def _of_places(
        self, machine: Machine, nose_mm: np.ndarray, tool_mm: np.ndarray
    ) -> Iterator[Cause]:
        """Measuring points: one that is off by d changes the error by -theta x d."""
        tilt_rad = tilts_of_axes_rad(machine, nose_mm, tool_mm)
        for name, table in machine.components.items():
            direction, axis, angular = component_of(name)
            if angular or table.measured_at_mm is None:
                continue
            along = np.eye(3)[direction]
            unit = RigidDisplacement(np.tile(along, (len(nose_mm), 1)), np.zeros_like(nose_mm))
            read = [
                -np.cross(tilt_rad[axis], np.eye(3)[(direction + k) % 3])[:, direction]
                for k in (1, 2)
            ]
            yield Cause(f"{name} measuring point", unit, self.measured_at_mm * np.stack(read, 1))

    def causes_of(self, machine: Machine, states: PathStates, variant: Variant) -> Iterator[Cause]:
        """Every cause at states of a path."""
        ways = states.direction if machine.separate_directions else None
        return self.causes(machine, states.nose_mm, states.tool_mm, variant, ways)

    def factors(self, path: Circumstances, sensing: np.ndarray) -> np.ndarray:
        """Signature of every unit cause on readings along `sensing` (P, 3), (P, Q) mm."""
        return np.hstack([own for _, own in self.signatures(path, sensing)])

    def signatures(
        self, path: Circumstances, sensing: np.ndarray
    ) -> Iterator[tuple[Cause, np.ndarray]]:
        """Every cause with what it does to readings along `sensing` (P, 3), (P, Q) mm.

        On a part they count from the zero that was touched, as the prediction does.
        """
        zero = None if path.states.normal is None else touched_zero(path.job, path.states)
        causes = self.causes_of(path.job.machine, path.states, path.variant)
        if zero is None:
            yield from ((cause, signature(cause, path, sensing)) for cause in causes)
            return
        there = self.causes_of(path.job.machine, zero.states, path.variant)
        for cause, at_touch in zip(causes, there, strict=True):
            moved = at_touch.lever.shift_mm[:, :, None] * at_touch.size[:, None, :]
            taken_off = np.einsum("pi,pik->pk", sensing, zero.shift_mm(moved))
            yield cause, signature(cause, path, sensing) - taken_off


def signature(cause: Cause, path: Circumstances, sensing: np.ndarray) -> np.ndarray:
    """What one u of each correction of a cause does to readings along `sensing`, (P, Q) mm."""
    lever = np.einsum("ij,ij->i", sensing, path.states.seen_mm(cause.lever))
    return lever[:, None] * cause.size


def _reading(
    tables: list[ComponentError], stated: float | None, default: float, name: str
) -> tuple[float, Pool]:
    """Standard uncertainty of a table's value, mm or rad, and how well it is known.

    The difference of both directions scatters by twice as much as their mean (GUM 4.2.2).
    """
    if stated is not None:
        return stated, STATED
    apart = [table.forward - table.backward for table in tables]
    # a table with one column for both directions says nothing of its noise
    apart = [both - both.mean() for both in apart if both.any()]
    freedom = sum(len(both) - 1 for both in apart)
    scatter = np.sqrt(sum(both @ both for both in apart) / freedom) if freedom else 0.0
    if not scatter:
        return default, STATED
    return 0.5 * float(scatter), Pool(name, float(freedom))


def _bends(position: np.ndarray, value: np.ndarray) -> np.ndarray:
    """Height above the chord in the middle of every interval by either end's curvature, (2, K - 1).

    At the ends of the table the curvature of the next point holds.
    """
    step = np.diff(position)
    if len(step) < 2:
        return np.zeros((2, len(step)))
    curvature = 2.0 * np.diff(np.diff(value) / step) / (step[:-1] + step[1:])
    first, last = np.append(curvature[:1], curvature), np.append(curvature, curvature[-1:])
    return -np.stack([first, last]) * step**2 / 8.0


def _root_mean_square(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _of_directions(hats: np.ndarray, ways: np.ndarray) -> np.ndarray:
    """What the readings of either direction do, in u of their mean, (P, 2 K).

    Independent readings of one direction scatter by sqrt(2) of their mean (GUM, 4.2.2 and eq. 10).

    Parameters
    ----------
    hats : (P, K) float64
    ways : (P,) number
        Sign of the last motion: forward, backward, or 0 where their mean acts.
    """
    share = 0.5 * (1.0 + np.stack([np.sign(ways), -np.sign(ways)]))
    return np.hstack([np.sqrt(2.0) * one[:, None] * hats for one in share])


def _hats_and_bumps(
    position: np.ndarray, knots: np.ndarray, *, is_line_beyond: bool
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """What one point of a table does to the straight lines between them, and where each place is.

    Parameters
    ----------
    position : (P,) float64
    knots : (K,) float64
        Increasing, K > 1.
    is_line_beyond : bool
        Whether the first and last line and parabola go on beyond the table, else its end holds.

    Returns
    -------
    hats : (P, K) float64
        1 at the own point, 0 at all others.
    bump : (P,) float64
        Height of a parabola that is 0 at both ends of the interval and 1 in its middle.
    interval : (P,) int
        The interval, 0 to K - 2; beyond the table the first or last.
    """
    rows, last = np.arange(len(position)), len(knots) - 1
    if not is_line_beyond:
        position = np.clip(position, knots[0], knots[-1])
    left = np.clip(np.searchsorted(knots, position, side="right") - 1, 0, last - 1)
    share = (position - knots[left]) / np.diff(knots)[left]
    hats = np.zeros((len(position), len(knots)))
    hats[rows, left], hats[rows, left + 1] = 1.0 - share, share
    return hats, 4.0 * share * (1.0 - share), left
