"""Modal state of the controller, in program units, and the frames that go with it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field

from gcode.errors import ProgramError, UnknownToolError
from gcode.geometry.arc_tolerance import ArcTolerance
from gcode.geometry.frame_turn import FrameTurn
from gcode.state.compensation_queue import CompensationQueue
from gcode.state.record import Record
from gcode.state.tools import ToolEntry
from gcode.state.trace import Trace
from gcode.text.parameters import Parameters

__all__ = ["PLANE_AXES", "WORK_OFFSETS", "XY", "XZ", "YZ", "Controller", "mapping_of_systems",
           "rotate"]  # fmt: skip

XY, YZ, XZ = 1, 2, 3

#: plane -> indices of first, second and axial axis.
PLANE_AXES = {XY: (0, 1, 2), YZ: (1, 2, 0), XZ: (2, 0, 1)}

#: names of the work offsets in the order of their numbers, 1 = G54; those of LinuxCNC, then
#: those that Fanuc chooses by G54.1 P and Haas by G154 P
WORK_OFFSETS = ("G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3",
                *(f"G54.1 P{number}" for number in range(1, 100)))  # fmt: skip
_ACCEPTED = "G54 to G59, G59.1 to G59.3, G54.1 P1 to G54.1 P99"

_ZERO = (0.0,) * 6


def rotate(point: list[float], angle_deg: float) -> None:
    """Turn X and Y of `point` in place about Z."""
    angle = math.radians(angle_deg)
    cosine, sine = math.cos(angle), math.sin(angle)
    x, y = point[0], point[1]
    point[0], point[1] = x * cosine - y * sine, x * sine + y * cosine


@dataclass
class CycleMemory:
    """What a canned cycle leaves for its repetition in the next block."""

    r: float = 0.0
    bottom: float = 0.0
    p: float = 0.0
    q: float = 0.0
    ijk: tuple[float, float, float] = (0.0, 0.0, 0.0)
    initial: float | None = None  #: level above which G98 retracts; None outside cycles


@dataclass
class Controller:
    """Everything that a block can read or change.

    Lengths are in program units (`unit_mm` each) unless a name says otherwise; positions and
    offsets are X Y Z A B C.
    """

    tools: dict[int, ToolEntry]  #: in the magazine
    tolerance: ArcTolerance
    machine_unit_mm: float = 1.0
    parameters: Parameters = field(default_factory=Parameters)
    record: Record = field(default_factory=Record)
    line: int = 0

    position: list[float] = field(default_factory=lambda: [0.0] * 6)
    g92: list[float] = field(default_factory=lambda: [0.0] * 6)
    origin: list[float] = field(default_factory=lambda: [0.0] * 6)
    tool_offset: list[float] = field(default_factory=lambda: [0.0] * 6)
    rotation_deg: float = 0.0
    turn: FrameTurn = field(
        default_factory=FrameTurn
    )  #: of a programmable frame, before G92's shift
    system: int = 1

    unit_mm: float = 1.0
    plane: int = XY
    absolute: bool = True
    arc_absolute: bool = False
    diameter_mode: bool = False
    motion: str | None = "G80"
    feed_mode: str = "minute"
    feed: float = 0.0
    speed: float = 0.0
    spindle: int = 0
    css: bool = False
    mist: bool = False
    flood: bool = False
    saved_modes: list = field(default_factory=lambda: [None])  #: M70, M73: one per call level
    restore_on_return: set[int] = field(default_factory=set)
    retract_to_initial: bool = False
    path_control: str = "G64"
    tool: int = 0
    loaded: int = 0  #: tool that G43 without H and G41 without D mean: M6 counts one block later
    selected_tool: int | None = None
    cycle: CycleMemory = field(default_factory=CycleMemory)
    control_points: list[tuple[float, float, float]] = field(default_factory=list)
    nurbs_order: int = 3

    side: int = 0  #: cutter compensation: 1 left, -1 right, 0 off
    radius: float = 0.0
    orientation: int = 0
    entering: bool = True
    starting: bool = False  #: its first line waits for the next move
    start_heading: float = 0.0  #: of that line, rad
    #: type B: side and compensated position where G40 waits for the next move
    leaving: tuple[int, list[float]] | None = None
    #: with a start-up: outer corners that turn more get an arc, others go on straight, rad
    round_corners_from: float = math.inf
    #: cutter compensation: type A or B of Fanuc, A from in front of the contour alone, or
    #: LinuxCNC's, which is empty
    start_up: str = ""
    programmed: list[float] = field(default_factory=lambda: [0.0] * 3)
    straight_only: bool = False
    queue: CompensationQueue = field(default_factory=CompensationQueue)
    preview: bool = False  #: show the quirks in `standalone`
    refresh: bool = False  #: a tool has been changed in the block before
    offsets: dict[int, ToolEntry] = field(default_factory=dict)  #: what H and D mean
    first_offsets: dict[int, ToolEntry] = field(init=False)
    notes: dict[tuple[int, str], str] = field(default_factory=dict)
    used: dict[str, int] = field(default_factory=dict)  #: codes and words -> line of first use
    trace: Trace | None = None  #: what is obeyed, where somebody asks for it

    def __post_init__(self) -> None:
        self.offsets = self.offsets or dict(self.tools)
        self.first_offsets = dict(self.offsets)

    def use(self, word: str) -> None:
        """Count a code, cycle or key word among those that the program uses."""
        self.used.setdefault(word, self.line)

    @contextmanager
    def told_as(self, line: int) -> Iterator[None]:
        """Motion that belongs to an earlier line, which waited for the one that is obeyed."""
        here = self.line
        self.line = self.record.line = line
        yield
        self.line = self.record.line = here

    def note(self, word: str, meaning: str) -> None:
        """List a word as irrelevant to geometry."""
        self.notes[(self.line, word)] = meaning

    def to_program(self, values: list[float] | tuple[float, ...]) -> list[float]:
        """Convert X Y Z A B C from machine units to program units."""
        scale = self.machine_unit_mm / self.unit_mm
        return [v * scale for v in values[:3]] + list(values[3:])

    def to_machine_units(self, values: list[float]) -> list[float]:
        """Convert X Y Z A B C from program units to machine units."""
        scale = self.unit_mm / self.machine_unit_mm
        return [v * scale for v in values[:3]] + list(values[3:])

    def machine_position(self, *, with_tool: bool = True) -> list[float]:
        """Nose (or, without tool, controlled point) in machine coordinates, program units."""
        point = [p + g for p, g in zip(self.turn.apply(self.position), self.g92, strict=True)]
        rotate(point, self.rotation_deg)
        tool = self.tool_offset if with_tool else _ZERO
        return [p + o + t for p, o, t in zip(point, self.origin, tool, strict=True)]

    def from_machine(self, point: list[float]) -> list[float]:
        """Program coordinates of a nose position in machine coordinates."""
        result = [p - o - t for p, o, t in
                  zip(point, self.origin, self.tool_offset, strict=True)]  # fmt: skip
        rotate(result, -self.rotation_deg)
        return self.turn.undo([r - g for r, g in zip(result, self.g92, strict=True)])

    def require_no_compensation(self, what: str) -> None:
        """Raise ProgramError where cutter compensation forbids `what`."""
        if self.side:
            raise ProgramError(
                f"cannot {what} with cutter compensation on", hint="cancel it with G40 first"
            )

    def require_spindle(self, name: str) -> None:
        """Raise ProgramError where the spindle stands that the cycle `name` wants to turn."""
        if self.spindle == 0:
            raise ProgramError(f"{name} with the spindle stopped", hint="start it with M3 or M4")

    def check_tool(self, number: int, *, word: str) -> None:
        """Raise UnknownToolError for a tool that is not in the magazine; 0 stands for none."""
        if number and number not in self.tools:
            known = ", ".join(str(n) for n in sorted(self.tools)) or "none"
            error = UnknownToolError(
                f"{word}{number}: tool {number} is not in the tool table",
                accepted=f"tools {known}",
                hint="add the tool to the table",
            )
            error.number = number
            raise error

    def tool_named(self, name: str) -> int:
        """Number of the tool of that name, whatever its case; raises UnknownToolError."""
        wanted = name.strip().upper()
        found = [n for n, tool in self.tools.items() if tool.name.upper() == wanted]
        if len(found) != 1:
            names = dict.fromkeys(tool.name for tool in self.tools.values() if tool.name)
            known = ", ".join(f'"{one}"' for one in names)
            what = "no tool has" if not found else f"tools {found} have"
            raise UnknownToolError(
                f'{what} the name "{name}"',
                accepted=known or "numbers of tools",
                hint="give each of them another name"
                if found
                else f'give the tool of the job name = "{name}"',
            )
        return found[0]

    def find_offset(self, number: int, *, word: str) -> ToolEntry:
        """Look up the offset memory; number 0 means the tool in the spindle."""
        if number == 0:
            return self.offsets.get(self.loaded, ToolEntry())
        if self.offsets.keys() == self.tools.keys():
            self.check_tool(number, word=word)
        if number not in self.offsets:
            known = ", ".join(str(n) for n in sorted(self.offsets))
            raise UnknownToolError(
                f"{word}{number}: there is neither a tool nor an offset {number}",
                accepted=f"numbers {known}",
                hint=f"add tool {number}, or a row {number} of the offset memory",
            )
        return self.offsets[number]

    def set_tool_parameters(self) -> None:
        """Publish the tool in the spindle as #5400 ... #5413, machine units."""
        entry = self.offsets.get(self.tool, ToolEntry())
        scale = 1.0 / self.machine_unit_mm
        lengths = [entry.x_mm * scale, entry.y_mm * scale, entry.offset_length_mm * scale]
        numbers = self.parameters.numbered
        numbers[5400] = float(self.tool)
        self.parameters.set_vector(5401, [*lengths, *entry.rotary_deg])
        numbers[5410] = entry.offset_diameter_mm * scale
        numbers[5413] = float(entry.orientation)

    def tool_offset_of(self, number: int, *, word: str) -> list[float]:
        """Offset X Y Z A B C of a row of the offset memory, program units and degrees."""
        entry = self.find_offset(number, word=word)
        lengths = (entry.x_mm, entry.y_mm, entry.offset_length_mm)
        scale = self.machine_unit_mm
        return self.to_program([v / scale for v in lengths] + list(entry.rotary_deg))


def mapping_of_systems(work_offsets_mm: Mapping[str, object]) -> dict[int, object]:
    """Translate G54 ... G59.3 to 1 ... 9; raises ProgramError for other names."""
    for name in work_offsets_mm:
        if name.upper() not in WORK_OFFSETS:
            raise ProgramError(f"unknown work offset '{name}'", accepted=_ACCEPTED)
    return {WORK_OFFSETS.index(name.upper()) + 1: value for name, value in work_offsets_mm.items()}
