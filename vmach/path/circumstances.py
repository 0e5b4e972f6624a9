"""The circumstances under which the tool made a point: everything an effect may depend on.

Source: closed form derived here: positions, directions and histories of the rigid nominal
machine, as each property states.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gcode import WORK_OFFSETS, MoveKind, Moves
from vmach.job import Job
from vmach.machine import RigidDisplacement, Variant, in_machine_axes
from vmach.machine.displacement import contributions
from vmach.path.blank_depth import blank_depth_mm
from vmach.path.dynamics import corner_before, curvature_per_mm
from vmach.path.engagement import Engagement, engagement
from vmach.path.levers import levers, location_levers, tilts_of_axes_rad
from vmach.path.motion_history import MotionHistory
from vmach.path.screw_waves import ScrewWaves
from vmach.path.toolpath import PathStates

__all__ = ["Circumstances"]

#: an axis that moves less than this has not reversed
_DEAD_BAND_MM = 2e-3
#: spindle speed that thermal amplitudes are stated at
_REFERENCE_RPM = 8000.0


@dataclass(frozen=True)
class Circumstances:
    """P states with everything derived from them that effects ask for.

    Lengths in mm, times in s, speeds in mm/s; arrays have one row a state.

    Attributes
    ----------
    states : PathStates
    job : Job
        For machine, tools, blank and work offsets.
    variant : Variant
        From where the arms of the machine's angular errors count.
    """

    states: PathStates
    job: Job
    variant: Variant = Variant.ABBE

    def __len__(self) -> int:
        return len(self.states)

    @property
    def moves(self) -> Moves:
        """The whole program."""
        return self.states.moves

    @cached_property
    def history(self) -> MotionHistory:
        """What the axes and the spindle did before."""
        return MotionHistory(self.moves)

    # position -----------------------------------------------------------------------------

    @property
    def nose_mm(self) -> np.ndarray:
        """Axis positions, (P, 3): spindle nose in machine coordinates, zero at home."""
        return self.states.nose_mm

    @property
    def rotary_rad(self) -> np.ndarray:
        """Angles of A, B and C, (P, 3)."""
        return self.states.rotary_rad

    @property
    def tool_mm(self) -> np.ndarray:
        """Vector from nose to tip, (P, 3)."""
        return self.states.tool_mm

    @property
    def contact_mm(self) -> np.ndarray:
        """Vector from tip to the point of interest, (P, 3)."""
        return self.states.contact_mm

    @cached_property
    def on_part_mm(self) -> np.ndarray:
        """The point of interest from the part's one zero, whatever offset is in force, (P, 3)."""
        # a program that cuts in one clamping only need not say which zero is the part's
        name = self.job.workpiece_zero or WORK_OFFSETS[max(int(self.work_offset[0]), 1) - 1]
        zero = self.job.work_offsets_mm.get(name, np.zeros(3))
        return self.nose_mm + self.tool_mm + self.contact_mm - zero

    @property
    def middle_of_part_mm(self) -> np.ndarray:
        """Middle of the blank, or of the points of interest where there is none, (3,)."""
        if self.job.blank is None:
            return self.on_part_mm.mean(axis=0)
        return 0.5 * (self.job.blank.min_mm + self.job.blank.max_mm)

    @cached_property
    def in_work_offset_mm(self) -> np.ndarray:
        """The point of interest from the zero of the work offset in force, (P, 3)."""
        offsets = np.zeros((len(WORK_OFFSETS) + 1, 3))
        for name, offset in self.job.work_offsets_mm.items():
            offsets[1 + WORK_OFFSETS.index(name)] = offset
        zero = offsets[self.moves.work_offset[self.states.move]]
        return self.nose_mm + self.tool_mm + self.contact_mm - zero

    @property
    def normal(self) -> np.ndarray:
        """Outward normal of the surface being cut, (P, 3)."""
        if self.states.normal is None:
            raise ValueError(
                "these states belong to no surface: needs_surface = True asks for those that do"
            )
        return self.states.normal

    @cached_property
    def side_normal(self) -> np.ndarray:
        """The part of the normal across the tool axis, (P, 3)."""
        return self.normal * np.array([1.0, 1.0, 0.0])

    @property
    def work_offset(self) -> np.ndarray:
        """Number of the work offset in force, (P,): 1 is G54."""
        return self.moves.work_offset[self.states.move]

    # motion -------------------------------------------------------------------------------

    @cached_property
    def _play(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        key = self.states.move + self.states.parameter
        return self.history.play(key, self.nose_mm, width_mm=_DEAD_BAND_MM)

    @property
    def play_side(self) -> np.ndarray:
        """Side of its play that each axis lies against, (P, 3).

        1 after motion in positive direction, -1 negative, in between while it crosses the play;
        0 before it first moved.
        """
        return self._play[0]

    @property
    def travel_since_reversal_mm(self) -> np.ndarray:
        """Way of each axis since it last reversed, (P, 3)."""
        return self._play[1]

    @cached_property
    def time_since_reversal_s(self) -> np.ndarray:
        """Time since each axis last reversed, (P, 3)."""
        since = self._play[2]
        move = np.minimum(since.astype(np.int64), len(self.moves) - 1)
        when = self.moves.start_s[move] + (since - move) * self.moves.duration_s[move]
        return np.maximum(self.time_s[:, None] - when, 0.0)

    @property
    def velocity_mm_per_s(self) -> np.ndarray:
        """Velocity of the nose, (P, 3)."""
        return self.states.velocity_mm_per_s

    @cached_property
    def acceleration_mm_per_s2(self) -> np.ndarray:
        """Acceleration from the path's curvature, towards the centre, (P, 3)."""
        curvature = curvature_per_mm(self.moves, self.states.move, self.states.parameter)
        return curvature * (self.velocity_mm_per_s**2).sum(axis=1, keepdims=True)

    @property
    def on_arc(self) -> np.ndarray:
        """Whether a true arc goes on, and no straight move, (P,) bool."""
        return self.moves.kind[self.states.move] == MoveKind.ARC

    @cached_property
    def corner(self) -> tuple[np.ndarray, np.ndarray]:
        """Jump of the velocity at the last corner, (P, 3) mm/s, and time since, (P,) s."""
        return corner_before(self.moves, self.states.move, self.time_s)

    # time ---------------------------------------------------------------------------------

    @cached_property
    def time_s(self) -> np.ndarray:
        """Time since the cold start, (P,)."""
        return self.states.time_s

    @property
    def spindle_rpm(self) -> np.ndarray:
        """Spindle speed, (P,)."""
        return np.abs(self.states.spindle_rpm)

    def warmth_of_spindle(self, time_constant_s: float, exponent: float) -> np.ndarray:
        """First-order response to the spindle's speed, (P,); 1 when warm at 8000 rpm.

        The heat source is (rpm / 8000) ** exponent.
        """

        def warmth() -> np.ndarray:
            drive = (np.abs(self.moves.spindle_rpm) / _REFERENCE_RPM) ** exponent
            return self.history.spindle_warmth(drive, time_constant_s, self.time_s)

        return self._once("spindle", (time_constant_s, exponent), warmth)

    def warmth_of_axis(self, axis: int, time_constant_s: float, work_share: float) -> np.ndarray:
        """First-order response to the axis' motion, (P,); 1 when warm at 100 mm/min.

        The heat source is, in the share `work_share`, the speed of the axis, and constant in
        the rest.
        """
        start_s = self.history.heat.start_s[0]
        by_time = -np.expm1((start_s - self.time_s) / time_constant_s)
        by_work = self._warmth_by_work(axis, time_constant_s)
        return work_share * by_work + (1.0 - work_share) * by_time

    def _warmth_by_work(self, axis: int, time_constant_s: float) -> np.ndarray:
        """First-order response to the axis' motion alone, (P,)."""
        heat, key = self.history.heat, (axis, time_constant_s)
        return self._once("axis", key, lambda: heat.axis_warmth(*key, self.time_s))

    def warmth_of_screw_mm(self, axis: int, time_constant_s: float) -> np.ndarray:
        """Warmth of an axis' screw summed from home to the nut, (P,) mm.

        The screw is heated where its nut runs: see `vmach.path.screw_waves`.
        """
        low, high = self.job.machine.travel_mm
        waves = ScrewWaves(float(low[axis]), float(high[axis]))
        position_mm, heat = self.nose_mm[:, axis], self.history.heat

        def warmth() -> np.ndarray:
            sines = self._once("sines", (axis,), lambda: waves.sines(position_mm))
            uneven = heat.warmth_of_waves(axis, time_constant_s, waves=waves, time_s=self.time_s)
            even = self._warmth_by_work(axis, time_constant_s) * position_mm
            return even + (uneven * sines) @ (1.0 / waves.per_mm)

        return self._once("screw", (axis, time_constant_s), warmth)

    def _once(self, what: str, key: tuple, work: Callable[[], np.ndarray]) -> np.ndarray:
        """What `work` gives; the last of each kind is asked for again, for each amplitude."""
        if what not in self._last or self._last[what][0] != key:
            self._last[what] = key, work()
        return self._last[what][1]

    @cached_property
    def _last(self) -> dict[str, tuple[tuple, np.ndarray]]:
        return {}

    # tool and cut -------------------------------------------------------------------------

    @property
    def tool(self) -> np.ndarray:
        """Tool number, (P,)."""
        return self.states.tool

    def of_tool(self, name: str) -> np.ndarray:
        """A dimension of each state's tool, such as ``diameter_mm``, (P,); NaN if not given."""

        def dimension() -> np.ndarray:
            values = np.full(max([*self.job.tools, int(self.moves.tool.max())]) + 1, np.nan)
            for number, tool in self.job.tools.items():
                given = getattr(tool, name)
                values[number] = np.nan if given is None else given
            return values[self.tool]

        return self._once(f"{name} of the tool", (), dimension)

    @cached_property
    def tool_changes(self) -> np.ndarray:
        """How many times the tool was changed before, (P,)."""
        return np.searchsorted(self._changes, self.states.move, side="right")

    @cached_property
    def time_since_tool_change_s(self) -> np.ndarray:
        """Time since the tool was taken, (P,); since the start for the first one."""
        since = np.concatenate([self.moves.start_s[:1], self.moves.start_s[self._changes]])
        return np.maximum(self.time_s - since[self.tool_changes], 0.0)

    @cached_property
    def _changes(self) -> np.ndarray:
        """Moves that are the first with another tool."""
        return 1 + np.flatnonzero(np.diff(self.moves.tool))

    @cached_property
    def cutting_length_mm(self) -> np.ndarray:
        """Way that the tool has gone at feed so far, (P,)."""
        return self.history.cutting_length_mm(self.states.move, self.states.parameter)

    @cached_property
    def feed_per_tooth_mm(self) -> np.ndarray:
        """Feed per tooth, (P,); two flutes where the job does not say."""
        flutes = np.nan_to_num(self.of_tool("flutes"), nan=2.0)
        per_min = np.where(self.spindle_rpm > 0, self.spindle_rpm * flutes, np.inf)
        return 60.0 * np.linalg.norm(self.velocity_mm_per_s, axis=1) / per_min

    @cached_property
    def radial_depth_mm(self) -> np.ndarray:
        """Material along the normal that the last cut took away, (P,).

        Up to what earlier passes of the program left, or the blank where none went.
        """
        depth = self._engagement.radial_mm
        if self.job.blank is None:
            return depth
        across = np.linalg.norm(self.side_normal, axis=1, keepdims=True)
        outwards = self.side_normal / np.where(across > 0.0, across, np.inf)
        return blank_depth_mm(self.job.blank, self.on_part_mm, outwards, depth)

    @cached_property
    def axial_depth_mm(self) -> np.ndarray:
        """Height of the material before the surface above the tip, (P,) mm.

        Up to the top of the blank, or to the lowest earlier pass over it, as that of a face mill.
        1 mm where there is no blank; no pass is known of what belongs to no surface.
        """
        if self.job.blank is None:
            return np.ones(len(self))
        tip = self.on_part_mm[:, 2] - self.contact_mm[:, 2]
        top = np.full(len(self), self.job.blank.max_mm[2])
        if self.states.normal is not None:
            zero = (self.nose_mm + self.tool_mm)[:, 2] - tip
            top = np.minimum(top, self._engagement.top_mm - zero)
        return np.maximum(top - tip, 0.0)

    @cached_property
    def _engagement(self) -> Engagement:
        radii = np.full(len(self.states.tool_lengths_mm), np.nan)
        for number, tool in self.job.tools.items():
            radii[number] = 0.5 * tool.diameter_mm
        return engagement(self.states, self.normal, radii)

    # machine ------------------------------------------------------------------------------

    def lever(self, component: str) -> RigidDisplacement:
        """Displacement of the tool by one unit (mm or rad) of a component error everywhere."""
        if component not in self._levers:
            # of a long path each takes as much room as the path itself: no other is made
            self._levers[component] = levers(
                self.job.machine, self.nose_mm, self.tool_mm, self.variant,
                rotary_rad=self.rotary_rad, names=(component,),
            )[component]  # fmt: skip
        return self._levers[component]

    @cached_property
    def _levers(self) -> dict[str, RigidDisplacement]:
        return {}

    def location_lever(self, name: str) -> RigidDisplacement:
        """Displacement of the tool by one unit (mm or rad) of a location error such as ``EX0C``."""
        return self._location_levers[name]

    @cached_property
    def _location_levers(self) -> dict[str, RigidDisplacement]:
        return location_levers(self.job.machine, self.nose_mm, self.tool_mm, self.rotary_rad)

    @cached_property
    def of_each_error(self) -> dict[str, RigidDisplacement]:
        """Displacement of the tool by each error of the machine file, by its ISO 230-1 symbol."""
        machine = self.job.machine
        direction = self.states.direction if machine.separate_directions else None
        place = self.nose_mm, self.rotary_rad
        own = contributions(
            machine, place[0], self.tool_mm, self.variant, direction=direction, rotary_rad=place[1]
        )
        return {name: in_machine_axes(machine, moved, *place) for name, moved in own}

    @cached_property
    def axis_tilt_rad(self) -> np.ndarray:
        """Rotation of the tool by the angular tables of each axis, (3, P, 3) rad, axis first."""
        return tilts_of_axes_rad(self.job.machine, self.nose_mm, self.tool_mm)
