"""The toolpath: states of the machine along the program, at nodes at most 5 mm apart.

Source: ISO 841 (motion of the tool relative to the workpiece).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gcode import MoveKind, Moves
from vmach.machine import RigidDisplacement
from vmach.path.geometry import last_direction, move_length_mm, position_at, tangent_at

__all__ = ["NODE_SPACING_MM", "PathStates", "Toolpath"]

#: spacing of the nodes at which the errors are evaluated; arcs stay arcs in between
NODE_SPACING_MM = 5.0


@dataclass(frozen=True)
class PathStates:
    """P states of the machine while it runs a program: which move, and where on it.

    Everything that an error can depend on is derived from these and the moves' history.

    Attributes
    ----------
    moves : Moves
        The whole program, so that effects can look back in time.
    tool_lengths_mm : (T,) float64
        Length of tool number k at index k; NaN where there is no such tool.
    move : (P,) int64
        Index into `moves`.
    parameter : (P,) float64
        0 at the start of the move, 1 at its end.
    contact_mm : (P, 3) float64
        The tool point of interest from the tip, workpiece axes; zero for the tip itself.
    normal : (P, 3) float64 or None
        Outward normal of the surface being cut, where a surface is looked at.
    arm_mm : (P, 3) float64 or None
        Where a tilt is read, as by a level: how far one end of the arm moves against the other
        is what a reading sees, and no displacement that both share.
    """

    moves: Moves
    tool_lengths_mm: np.ndarray
    move: np.ndarray
    parameter: np.ndarray
    contact_mm: np.ndarray
    normal: np.ndarray | None = None
    arm_mm: np.ndarray | None = None

    def __len__(self) -> int:
        return len(self.move)

    def __getitem__(self, rows: np.ndarray | slice) -> PathStates:
        """Some of the states, by index, mask or slice."""
        return PathStates(
            moves=self.moves,
            tool_lengths_mm=self.tool_lengths_mm,
            move=self.move[rows],
            parameter=self.parameter[rows],
            contact_mm=self.contact_mm[rows],
            normal=None if self.normal is None else self.normal[rows],
            arm_mm=None if self.arm_mm is None else self.arm_mm[rows],
        )

    def seen_mm(self, moved: RigidDisplacement | np.ndarray) -> np.ndarray:
        """What readings see of a displacement of the tool, (P, 3) mm.

        Parameters
        ----------
        moved : RigidDisplacement, or (P, 3) float64
            Of the tool; or of the point of interest, without any tilt.
        """
        if not isinstance(moved, RigidDisplacement):
            return moved if self.arm_mm is None else np.zeros_like(moved)
        if self.arm_mm is None:
            return moved.at(self.contact_mm)
        return np.cross(moved.tilt_rad, self.arm_mm)

    @cached_property
    def nose_mm(self) -> np.ndarray:
        """Axis positions q, (P, 3): the spindle nose in machine coordinates."""
        return position_at(self.moves, self.move, self.parameter)

    @cached_property
    def tool_mm(self) -> np.ndarray:
        """Vector from nose to tip, (P, 3)."""
        length = self.tool_lengths_mm[self.tool]
        return np.column_stack([np.zeros((len(self), 2)), -length])

    @cached_property
    def rotary_rad(self) -> np.ndarray:
        """Angles of A, B and C, (P, 3)."""
        start, end = self.moves.rotary_start_deg, self.moves.rotary_end_deg
        turned_deg = end[self.move] - start[self.move]
        return np.radians(start[self.move] + self.parameter[:, None] * turned_deg)

    @property
    def tool(self) -> np.ndarray:
        """Tool number, (P,) int32."""
        return self.moves.tool[self.move]

    @property
    def line(self) -> np.ndarray:
        """Line of the program, (P,) int32, 1-based."""
        return self.moves.line[self.move]

    @cached_property
    def direction(self) -> np.ndarray:
        """Sign of the last motion of each axis, (P, 3); 0 before an axis first moved."""
        return last_direction(self.moves, self.move, self.parameter)

    @cached_property
    def velocity_mm_per_s(self) -> np.ndarray:
        """Velocity of the nose, (P, 3); zero while standing, and at the ends of a rapid.

        What a rapid touches where it leaves a surface was made before it set off.
        """
        duration = self.moves.duration_s[self.move]
        tangent = tangent_at(self.moves, self.move, self.parameter)
        at_an_end = (self.parameter <= 0.0) | (self.parameter >= 1.0)
        stands = (self.moves.kind[self.move] == MoveKind.RAPID) & at_an_end
        moving = ((duration > 0) & ~stands)[:, None]
        return np.divide(tangent, duration[:, None], out=np.zeros_like(tangent), where=moving)

    @property
    def feed_mm_per_min(self) -> np.ndarray:
        """Feed along the path, (P,)."""
        return self.moves.feed_mm_per_min[self.move]

    @property
    def time_s(self) -> np.ndarray:
        """Seconds since the program's start, (P,)."""
        return self.moves.start_s[self.move] + self.parameter * self.moves.duration_s[self.move]

    @property
    def spindle_rpm(self) -> np.ndarray:
        """Spindle speed, (P,), positive clockwise (M3)."""
        return self.moves.spindle_rpm[self.move]


@dataclass(frozen=True)
class Toolpath:
    """A program's moves cut into pieces of at most the node spacing.

    A piece lies between two neighbouring nodes of one move; E is the number of pieces.

    Attributes
    ----------
    nodes : PathStates
        The tool tip at every node, K states.
    first_node : (E,) int64
        Piece e goes from node ``first_node[e]`` to ``first_node[e] + 1``.
    """

    nodes: PathStates
    first_node: np.ndarray

    @classmethod
    def split(
        cls, moves: Moves, tool_lengths_mm: np.ndarray, spacing_mm: float = NODE_SPACING_MM
    ) -> Toolpath:
        """Split every move that carries a tool, (M,) of them, into equal pieces up to `spacing_mm`.

        An arc's piece is an arc: the spacing is that of the nodes at which errors are evaluated.
        """
        length = move_length_mm(moves)
        moving = (moves.kind != MoveKind.DWELL) & (length > 0) & (moves.tool > 0)
        used = np.flatnonzero(moving)
        pieces = np.maximum(np.ceil(length[used] / spacing_mm - 1e-9), 1).astype(np.int64)
        nodes = pieces + 1
        first = np.concatenate([[0], np.cumsum(nodes)])
        within = np.arange(first[-1]) - np.repeat(first[:-1], nodes)
        states = PathStates(
            moves=moves,
            tool_lengths_mm=tool_lengths_mm,
            move=np.repeat(used, nodes),
            parameter=within / np.repeat(pieces, nodes),
            contact_mm=np.zeros((first[-1], 3)),
        )
        return cls(states, np.flatnonzero(within < np.repeat(pieces, nodes)))

    @property
    def piece_move(self) -> np.ndarray:
        """Move that each piece belongs to, (E,) int64."""
        return self.nodes.move[self.first_node]

    def parts(self, count: int) -> Iterator[Toolpath]:
        """The path in parts of about `count` pieces, whole moves each."""
        begin, total, move = 0, len(self.first_node), self.piece_move
        while begin < total:
            end = int(np.searchsorted(move, move[min(begin + count, total) - 1], side="right"))
            first = self.first_node[begin:end]
            yield Toolpath(self.nodes[slice(first[0], first[-1] + 2)], first - first[0])
            begin = end

    def of_pieces(self, piece: np.ndarray) -> tuple[Toolpath, np.ndarray]:
        """The moves that some pieces (P,) belong to, and the number of each piece there, (P,)."""
        move = self.piece_move
        chosen = np.zeros(len(self.nodes.moves), dtype=bool)
        chosen[move[piece]] = True
        pieces, nodes = chosen[move], chosen[self.nodes.move]
        first = (np.cumsum(nodes) - 1)[self.first_node[pieces]]
        return Toolpath(self.nodes[nodes], first), (np.cumsum(pieces) - 1)[piece]

    def states_on_pieces(
        self,
        piece: np.ndarray,
        parameter: np.ndarray,
        *,
        contact_mm: np.ndarray,
        normal: np.ndarray | None = None,
    ) -> PathStates:
        """States at given places: piece (P,) and parameter (P,) from 0 to 1 along it."""
        first = self.first_node[piece]
        start, end = self.nodes.parameter[first], self.nodes.parameter[first + 1]
        return PathStates(
            moves=self.nodes.moves,
            tool_lengths_mm=self.nodes.tool_lengths_mm,
            move=self.nodes.move[first],
            parameter=start + parameter * (end - start),
            contact_mm=contact_mm,
            normal=normal,
        )
