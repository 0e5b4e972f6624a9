"""The circular tests of a job: full circles of its program, in pairs, on the machine of the job.

Source: ISO 230-4; the tool tip's error of `vmach.prediction`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from gcode import MoveKind, Moves
from vmach.effects import EffectInstance
from vmach.errors import InputError
from vmach.features.circular_test import (
    CircularFigures,
    CircularTest,
    circular_figures,
    circular_weights,
)
from vmach.job import Job
from vmach.machine import Variant
from vmach.path.preparation import Preparation
from vmach.prediction import displacement_of
from vmach.uncertainty.first_order import path_u_mm

__all__ = ["job_circular_tests"]

#: axes of a plane by the axis that it is normal to, in the order that counter-clockwise goes
_PLANES = {2: ("XY", 0, 1), 0: ("YZ", 1, 2), 1: ("ZX", 2, 0)}
#: a circle is full where it lacks no more than this, rad; its axis is one of the machine's
_FULL_RAD = 1e-6
#: two circles are one where centres and radii differ by no more than this, mm
_SAME_MM = 1e-3


def job_circular_tests(
    job: Job, preparation: Preparation, variant: Variant, effects: Sequence[EffectInstance]
) -> tuple[CircularTest, ...]:
    """Evaluate every pair of full circles, counter-clockwise and clockwise, of the program.

    Raises
    ------
    InputError
        The job asks for a circular test and its program has no such pair.
    """
    if job.circular_test is None:
        return ()
    moves = preparation.program.moves
    pairs = _pairs(moves)
    if not pairs:
        raise InputError(
            "[circular_test], but no full circle of the program is made both ways round",
            file=job.program,
            accepted="G2 and G3 of 360 degrees about one centre, at one feed, in one plane",
        )
    nodes = preparation.path.nodes
    rows = np.flatnonzero(np.isin(nodes.move, [move for pair in pairs for move in pair]))
    states = nodes[rows]
    tip = states.nose_mm + displacement_of(preparation, states, variant, effects).shift_mm
    found = []
    for pair in pairs:
        own = [np.flatnonzero(states.move == move)[:-1] for move in pair]  # its end is its start
        seen = [_seen(moves, move, states.nose_mm[k], tip[k])
                for move, k in zip(pair, own, strict=True)]  # fmt: skip
        angles, radial = zip(*seen, strict=True)
        first = pair[0]
        u_mm = path_u_mm(
            states[np.concatenate(own)], _outwards(moves, first, np.concatenate(angles)),
            circular_weights(angles, radial), job=job, variant=variant, effects=effects,
        )  # fmt: skip
        found.append(
            CircularTest(
                _PLANES[_normal(moves, first)][0],
                moves.centre_mm[first],
                _radius(moves, first),
                float(moves.feed_mm_per_min[first]),
                (int(moves.line[pair[0]]), int(moves.line[pair[1]])),
                circular_figures(angles, radial),
                job.circular_test,
                angles,
                radial,
                CircularFigures(*u_mm.tolist()),
            )
        )
    return tuple(found)


def _pairs(moves: Moves) -> list[tuple[int, int]]:
    """Moves that go counter-clockwise and clockwise round one circle, each once."""
    full = np.abs(moves.sweep_rad) > 2.0 * np.pi - _FULL_RAD
    flat = np.abs(moves.end_mm - moves.start_mm).max(axis=1, initial=0.0) < _SAME_MM
    circles = np.flatnonzero((moves.kind == MoveKind.ARC) & full & flat).tolist()
    circles = [k for k in circles if np.abs(moves.axis[k]).max() > 1.0 - _FULL_RAD]
    ways = {way: [k for k in circles if _way(moves, k) == way] for way in (1, -1)}
    pairs = []
    for one in ways[1]:
        other = next((k for k in ways[-1] if _alike(moves, one, k)), None)
        if other is not None:
            ways[-1].remove(other)
            pairs.append((one, other))
    return pairs


def _normal(moves: Moves, move: int) -> int:
    return int(np.abs(moves.axis[move]).argmax())


def _way(moves: Moves, move: int) -> int:
    """1 counter-clockwise seen against the machine's axis, -1 clockwise."""
    return int(np.sign(moves.sweep_rad[move] * moves.axis[move].sum()))


def _radius(moves: Moves, move: int) -> float:
    return float(np.linalg.norm(moves.start_mm[move] - moves.centre_mm[move]))


def _alike(moves: Moves, one: int, other: int) -> bool:
    return (
        _normal(moves, one) == _normal(moves, other)
        and float(np.abs(moves.centre_mm[one] - moves.centre_mm[other]).max()) < _SAME_MM
        and abs(_radius(moves, one) - _radius(moves, other)) < _SAME_MM
        and moves.feed_mm_per_min[one] == moves.feed_mm_per_min[other]
    )


def _seen(moves: Moves, move: int, nose: np.ndarray, tip: np.ndarray):
    """Angle and radial deviation, (N,) each, of nodes of a move, (N, 3) mm each."""
    _, across, upward = _PLANES[_normal(moves, move)]
    plane = [across, upward]
    centre, radius = moves.centre_mm[move, plane], _radius(moves, move)
    nominal = nose[:, plane] - centre
    reached = np.hypot(*(tip[:, plane] - centre).T)
    return np.arctan2(nominal[:, 1], nominal[:, 0]), reached - radius


def _outwards(moves: Moves, move: int, angle_rad: np.ndarray) -> np.ndarray:
    """Unit vectors away from the centre, (N, 3)."""
    _, across, upward = _PLANES[_normal(moves, move)]
    found = np.zeros((len(angle_rad), 3))
    found[:, across], found[:, upward] = np.cos(angle_rad), np.sin(angle_rad)
    return found
