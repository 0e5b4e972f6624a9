"""Which moves of a program made holes, bores and bosses: drilled in one plunge, or milled round.

Source: closed form derived here: the wall of a bore lies a tool radius outside the path of the
tool's axis, that of a boss a radius inside.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gcode import MoveKind, Moves
from vmach.path.preparation import Preparation
from vmach.path.toolpath import PathStates

__all__ = ["CONTACTS", "CircularFeature", "HoleContacts", "hole_contacts"]

#: contacts around a hole; their mean is free of harmonics up to the sixth
CONTACTS = 8
#: distance of the tool's axis from the stated centre within which it is that hole
_CENTRE_MM = 0.05
#: share of the diameter by which a drill may differ from the hole that it made
_DRILL_SHARE = 0.1
#: difference of the path's radius from that of wall and tool, as finishing offsets make it
_RADIUS_MM = 0.3
#: cosine of the angle between an arc's axis and Z from which on it is a circle in the plane XY
_UPRIGHT = 0.999


@dataclass(frozen=True)
class CircularFeature:
    """A hole, bore or boss as the drawing has it, in workpiece coordinates.

    Attributes
    ----------
    centre_mm : (2,) float64
    z_mm : float
        Height at which it was measured; NaN where nobody says.
    diameter_mm : float
        NaN where nobody says.
    """

    centre_mm: np.ndarray
    z_mm: float
    diameter_mm: float


@dataclass(frozen=True)
class HoleContacts:
    """Where the tool made H features: `CONTACTS` places around each of those found.

    Attributes
    ----------
    found : (H,) bool
    states : PathStates
        ``CONTACTS`` of each feature found, one feature after the other, with normals.
    outward : (S, 3) float64
        Unit vector from the feature's axis through each contact.
    """

    found: np.ndarray
    states: PathStates
    outward: np.ndarray


def hole_contacts(preparation: Preparation, features: list[CircularFeature]) -> HoleContacts:
    """The states in which the last tool that fits made each feature.

    A drill made it where it plunges at its centre, a mill where it goes round it at feed. Where
    several did, the last one counts whose diameter agrees; then the last that plunges at all.
    """
    finder = _Finder(preparation)
    made = [finder.contacts_of(feature) for feature in features]
    rows = [one for one in made if one is not None]
    angle = _angles()
    count = len(rows)
    none = np.zeros(0)
    joined = [np.concatenate([none, *(row[k] for row in rows)]) for k in range(3)]
    outward = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(CONTACTS)])
    outward = np.tile(outward, (count, 1))
    side = np.repeat([row[3] for row in rows], CONTACTS)[:, None] if rows else np.zeros((0, 1))
    nodes = preparation.path.nodes
    states = PathStates(
        moves=nodes.moves,
        tool_lengths_mm=nodes.tool_lengths_mm,
        move=joined[0].astype(np.int64),
        parameter=joined[1],
        contact_mm=side * joined[2][:, None] * outward,
        normal=-side * outward,
    )
    return HoleContacts(np.array([one is not None for one in made]), states, outward)


def _angles() -> np.ndarray:
    """Of the contacts: none of them on an axis, where a reversal would be hit by chance."""
    return (np.arange(CONTACTS) + 0.5) * 2.0 * np.pi / CONTACTS


class _Finder:
    """The plunges and circles of a program, in workpiece coordinates of the tip."""

    def __init__(self, preparation: Preparation) -> None:
        moves = preparation.path.nodes.moves
        self._moves = moves
        self._radius = np.full(len(preparation.tool_index), np.nan)
        for number, tool in preparation.job.tools.items():
            self._radius[number] = 0.5 * tool.diameter_mm
        zero = preparation.zero_mm
        length = preparation.path.nodes.tool_lengths_mm
        known = (moves.tool > 0) & (moves.tool < len(length))
        drop = np.where(known, length[np.minimum(moves.tool, len(length) - 1)], np.nan)
        self._z = np.column_stack([moves.start_mm[:, 2], moves.end_mm[:, 2]])
        self._z = self._z - drop[:, None] - zero[2]
        way = moves.end_mm - moves.start_mm
        still = np.abs(way[:, :2]).max(axis=1) < 1e-6
        down = (moves.kind == MoveKind.LINE) & still & (way[:, 2] < 0.0) & known
        self._plunge = np.flatnonzero(down)
        self._plunge_mm = moves.end_mm[self._plunge, :2] - zero[:2]
        upright = np.abs(moves.axis[:, 2]) > _UPRIGHT
        self._circle = np.flatnonzero((moves.kind == MoveKind.ARC) & upright & known)
        self._circle_mm = moves.centre_mm[self._circle, :2] - zero[:2]
        away = moves.start_mm[self._circle, :2] - moves.centre_mm[self._circle, :2]
        self._way_mm = np.linalg.norm(away, axis=1)

    def contacts_of(self, feature: CircularFeature):
        """Moves, parameters and contact radii (CONTACTS,), and 1 for a bore, -1 for a boss."""
        drilled = self._drilled(feature)
        milled = self._milled(feature)
        if milled is not None and (drilled is None or milled[0].max() > drilled[0].max()):
            return milled
        return drilled or self._drilled(feature, any_size=True)

    def _drilled(self, feature: CircularFeature, *, any_size: bool = False):
        near = np.linalg.norm(self._plunge_mm - feature.centre_mm, axis=1) < _CENTRE_MM
        radius = self._radius[self._moves.tool[self._plunge]]
        if np.isfinite(feature.diameter_mm) and not any_size:
            apart = np.abs(2.0 * radius - feature.diameter_mm)
            near &= apart < _DRILL_SHARE * feature.diameter_mm
        rows = self._plunge[near]
        if not len(rows):
            return None
        rows = rows[self._moves.tool[rows] == self._moves.tool[rows[-1]]]
        top, bottom = self._z[rows].T
        reaches = rows[(bottom <= feature.z_mm + 1e-6) & (top > feature.z_mm)]
        move = int(reaches[-1] if len(reaches) else rows[np.argmin(bottom)])
        high, low = self._z[move]
        share = (high - feature.z_mm) / (high - low) if len(reaches) else 1.0
        wide = float(self._radius[self._moves.tool[move]])
        return np.full(CONTACTS, move), np.full(CONTACTS, share), np.full(CONTACTS, wide), 1.0

    def _milled(self, feature: CircularFeature):
        if not np.isfinite(feature.diameter_mm):
            return None
        near = np.linalg.norm(self._circle_mm - feature.centre_mm, axis=1) < _CENTRE_MM
        tool = self._radius[self._moves.tool[self._circle]]
        best = None
        for side in (1.0, -1.0):
            wanted = 0.5 * feature.diameter_mm - side * tool
            rows = self._circle[near & (np.abs(self._way_mm - wanted) < _RADIUS_MM)]
            found = _all_round(self._moves, rows)
            if found is not None and (best is None or found[0].max() > best[0].max()):
                best = *found, self._radius[self._moves.tool[found[0]]], side
        return best


def _all_round(moves: Moves, rows: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    """The last of some arcs at every angle, and where on it; None where an angle is left out."""
    move, parameter = np.full(CONTACTS, -1), np.zeros(CONTACTS)
    for row in rows:
        start = moves.start_mm[row] - moves.centre_mm[row]
        turn = np.sign(moves.axis[row, 2]) * moves.sweep_rad[row]
        on = np.sign(turn) * (_angles() - np.arctan2(start[1], start[0])) % (2.0 * np.pi)
        # of a helix its last turn
        on += 2.0 * np.pi * np.floor((abs(turn) - on) / (2.0 * np.pi))
        covered = on >= 0.0
        move[covered], parameter[covered] = row, (on / abs(turn))[covered]
    return (move, parameter) if (move >= 0).all() else None
