"""Frames: G54-G59.3, G10, G43, G49, G52, G92, G28, G30 and what they do to the position.

Changing a frame never moves the machine; the same machine point gets new program coordinates.

Source: NISTIR 6556 (RS274/NGC), coordinate systems; LinuxCNC, Coordinate Systems.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from gcode.errors import ProgramError
from gcode.geometry.frame_turn import FrameTurn
from gcode.motion.interpolation import block_end, traverse
from gcode.state.block_values import Values, whole
from gcode.state.codes import AXES
from gcode.state.controller import WORK_OFFSETS, Controller, rotate
from gcode.text.parameters import FIRST_SYSTEM, G28_HOME, G30_HOME, G92_APPLIED, system_base

__all__ = [
    "apply_system",
    "axis_offsets",
    "end_program",
    "go_home",
    "load_offsets",
    "select_system",
    "set_home",
    "set_tool_length",
    "turn_frame",
    "write_tables",
]


def _axis_words(block: Values) -> dict[int, float]:
    return {axis: block.words[name] for axis, name in enumerate(AXES) if name in block.words}


def say_work_system(controller: Controller) -> None:
    """Tell the machine the active offset, G92 offset and rotation."""
    record = controller.record
    record.offset("set_g5x_offset", controller.system, values=controller.origin)
    record.offset("set_g92_offset", values=controller.g92)
    record.event("set_xy_rotation", controller.rotation_deg)


def _load_system(controller: Controller, system: int) -> None:
    """Read offset and rotation of a work system from its parameters."""
    base = system_base(system)
    controller.system = system
    controller.parameters.numbered[FIRST_SYSTEM] = float(system)
    controller.origin = controller.to_program(controller.parameters.vector(base))
    controller.rotation_deg = controller.parameters.numbered.get(base + 9, 0.0)


def position_in_system(controller: Controller, system: int, *, with_tool: bool) -> list[float]:
    """Present position in the coordinates of a work system, G92 included where applied."""
    base, numbers = system_base(system), controller.parameters
    point = controller.machine_position(with_tool=with_tool)
    offset = controller.to_program(numbers.vector(base))
    point = [p - o for p, o in zip(point, offset, strict=True)]
    rotate(point, -numbers.numbered.get(base + 9, 0.0))
    if numbers.numbered.get(G92_APPLIED, 0.0):
        applied = controller.to_program(numbers.vector(G92_APPLIED + 1))
        point = [p - g for p, g in zip(point, applied, strict=True)]
    return point


def select_system(controller: Controller, code: str) -> None:
    """G54 ... G59.3."""
    controller.require_no_compensation("change the work system")
    if code not in WORK_OFFSETS:
        raise ProgramError(f"work offset {code} does not exist", accepted="G54.1 P1 to P99")
    system = WORK_OFFSETS.index(code) + 1
    if system == controller.system:
        return
    here = controller.machine_position()
    controller.position = position_in_system(controller, system, with_tool=False)
    _load_system(controller, system)
    if not controller.turn.is_identity:
        controller.position = controller.from_machine(here)
    say_work_system(controller)


def axis_offsets(controller: Controller, block: Values, code: str) -> None:
    """G52, G92, G92.1, G92.2, G92.3."""
    controller.require_no_compensation("change axis offsets")
    parameters, applied = controller.parameters, G92_APPLIED + 1
    before = list(controller.g92)
    if code in ("G52", "G92"):
        parameters.numbered[G92_APPLIED] = 1.0
        for axis, value in _axis_words(block).items():
            total = controller.position[axis] + controller.g92[axis]
            controller.g92[axis] = value if code == "G52" else total - value
            controller.position[axis] = total - value if code == "G52" else value
        parameters.set_vector(applied, controller.to_machine_units(controller.g92))
    else:
        if code == "G92.3":
            controller.g92 = controller.to_program(parameters.vector(applied))
        else:
            controller.g92 = [0.0] * 6
            if code == "G92.1":
                parameters.set_vector(applied, [0.0] * 6)
        parameters.numbered[G92_APPLIED] = 1.0 if code == "G92.3" else 0.0
        controller.position = [
            p + b - g for p, b, g in zip(controller.position, before, controller.g92, strict=True)
        ]
    controller.record.offset("set_g92_offset", values=controller.g92)


def write_tables(controller: Controller, block: Values) -> None:
    """G10 in all its L forms: write the tool table or the offsets of a work system."""
    if "l" not in block.words or block.words["l"] not in (0, 1, 2, 10, 11, 20):
        given = f"L{block.words['l']:g}" if "l" in block.words else "no L word"
        raise ProgramError(f"G10 with {given}", accepted="L0 L1 L2 L10 L11 L20")
    form = int(block.words["l"])
    if form == 0:
        if controller.tool:
            raise ProgramError(f"G10 L0 with tool T{controller.tool} in the spindle")
        controller.note("G10 L0", "reload of the tool table")
        return
    if "p" not in block.words:
        raise ProgramError(f"G10 L{form} without P word")
    number = whole(block.words["p"], "P word of G10")
    if form in (1, 10, 11):
        if number < 1:
            raise ProgramError(f"P{number} out of range with G10 L{form}", accepted="a tool")
        _write_tool(controller, block, number, form)
    else:
        if not 0 <= number <= 9:
            raise ProgramError(f"P{number} out of range with G10 L{form}", accepted="P0 to P9")
        _write_system(controller, block, number or controller.system, form)


def _write_tool(controller: Controller, block: Values, number: int, form: int) -> None:
    """G10 L1, L10, L11: write the tool table."""
    entry = controller.find_offset(number, word="P")
    words = _axis_words(block)
    if not words and not {"r", "q", "i", "j"} & block.words.keys():
        raise ProgramError(f"G10 L{form} without offsets has no effect")
    unit = controller.unit_mm
    offset = controller.tool_offset_of(number, word="P")
    if form == 1:
        for axis, value in words.items():
            offset[axis] = value
    else:
        _measure_tool(controller, words, offset, form)
    entry = replace(entry, x_mm=offset[0] * unit, y_mm=offset[1] * unit,
                    length_mm=offset[2] * unit - entry.length_wear_mm,
                    rotary_deg=tuple(offset[3:]))  # fmt: skip
    if "r" in block.words:
        entry = replace(entry, diameter_mm=block.words["r"] * unit * 2.0 - entry.diameter_wear_mm)
    if "q" in block.words:
        orientation = whole(block.words["q"], "Q word of G10")
        if orientation > 9:
            raise ProgramError(f"tool orientation Q{orientation}", accepted="0 to 9")
        entry = replace(entry, orientation=orientation)
    controller.offsets[number] = entry
    controller.set_tool_parameters()


def _measure_tool(
    controller: Controller, words: dict[int, float], offset: list[float], form: int
) -> None:
    """G10 L10 and L11: offset that makes the present position read as the words say."""
    system = 9 if form == 11 else controller.system
    angle = controller.parameters.numbered.get(system_base(system) + 9, 0.0)
    here = position_in_system(controller, system, with_tool=True)
    if form == 11 and controller.parameters.numbered.get(G92_APPLIED, 0.0):
        applied = controller.parameters.vector(G92_APPLIED + 1)
        here = [h + g for h, g in zip(here, controller.to_program(applied), strict=True)]
    if 0 in words or 1 in words:
        plane = offset[:2]
        rotate(plane, -angle)
        for axis in (0, 1):
            if axis in words:
                plane[axis] = here[axis] - words[axis]
        rotate(plane, angle)
        offset[:2] = plane
    for axis, value in words.items():
        if axis > 1:
            offset[axis] = here[axis] - value


def _write_system(controller: Controller, block: Values, system: int, form: int) -> None:
    """G10 L2 and L20: write the offset of a work system."""
    if "i" in block.words or "j" in block.words:
        raise ProgramError(f"I J words with G10 L{form}")
    active = system == controller.system
    if active:
        controller.require_no_compensation("change the active work system")
    parameters, base = controller.parameters, system_base(system)
    here = position_in_system(controller, system, with_tool=False)
    if "r" in block.words:
        if form == 20:
            raise ProgramError("R word with G10 L20")
        parameters.numbered[base + 9] = block.words["r"]
    angle = parameters.numbered.get(base + 9, 0.0)
    offset = controller.to_program(parameters.vector(base))
    words = _axis_words(block)
    if form == 20:
        wanted = [words.get(axis, here[axis]) for axis in range(6)]
        rotate(here, angle)
        rotate(wanted, angle)
        shifted = [h + o - w for h, o, w in zip(here, offset, wanted, strict=True)]
        offset[:2] = shifted[:2]
        for axis in range(2, 6):
            if axis in words:
                offset[axis] = shifted[axis]
    else:
        for axis, value in words.items():
            offset[axis] = value
    store_system(controller, system, offset)


def store_system(controller: Controller, system: int, offset: list[float]) -> None:
    """Write the offset of a work system, program units, effective at once if it is active."""
    parameters, base = controller.parameters, system_base(system)
    parameters.set_vector(base, controller.to_machine_units(offset))
    if system == controller.system:
        controller.require_no_compensation("change the active work system")
        apply_system(controller, offset, parameters.numbered.get(base + 9, 0.0))


def apply_system(controller: Controller, offset: list[float], angle: float) -> None:
    """Make a changed offset of the active system effective."""
    position = controller.position
    rotate(position, controller.rotation_deg)
    position = [p + o - n for p, o, n in zip(position, controller.origin, offset, strict=True)]
    controller.origin = offset
    rotate(position, -angle)
    controller.position = position
    controller.rotation_deg = angle
    record = controller.record
    record.offset("set_g5x_offset", controller.system, values=offset)
    record.event("set_xy_rotation", angle)


def turn_frame(
    controller: Controller, shift: Sequence[float], *, angle_deg: float = 0.0,
    signs: tuple[float, float] = (1.0, 1.0),
) -> None:  # fmt: skip
    """Put a programmable frame in force: mirror image, rotation about Z, shift.

    Parameters
    ----------
    controller : Controller
    shift : (6,) sequence of float
        X Y Z A B C, program units and degrees; takes the place of G92's and G52's.
    angle_deg : float
    signs : tuple of float
        -1.0 where X, or Y, is mirrored.
    """
    turn = FrameTurn(angle_deg, signs)
    if turn == controller.turn and list(shift) == list(controller.g92):
        return
    controller.require_no_compensation("change the frame")
    here = controller.machine_position()
    turned = turn != controller.turn
    controller.turn, controller.g92 = turn, list(shift)
    controller.position = controller.from_machine(here)
    controller.record.offset("set_g92_offset", values=controller.g92)
    if turned:
        controller.record.event("set_turn", angle_deg, *signs)


def set_tool_length(controller: Controller, block: Values, code: str) -> None:
    """G43, G43.1, G43.2, G49."""
    controller.require_no_compensation("change the tool offset")
    words = _axis_words(block)
    if code == "G49":
        offset = [0.0] * 6
    elif code == "G43":
        number = controller.tool if controller.refresh and controller.tool else controller.loaded
        number = int(block.words.get("h", number))
        word = "H" if "h" in block.words else "G43 with tool T"
        offset = controller.tool_offset_of(number, word=word)
    else:
        offset = list(controller.tool_offset)
        if code == "G43.1":
            for axis, value in words.items():
                offset[axis] = value
        else:
            if ("h" in block.words) == bool(words):
                raise ProgramError("G43.2 takes either an H word or axis words")
            added = (
                controller.tool_offset_of(int(block.words["h"]), word="H")
                if "h" in block.words
                else [words.get(axis, 0.0) for axis in range(6)]
            )
            offset = [o + a for o, a in zip(offset, added, strict=True)]
    change = [o - n for o, n in zip(controller.tool_offset, offset, strict=True)]
    rotate(change, -controller.rotation_deg)
    controller.position = [p + c for p, c in zip(controller.position, change, strict=True)]
    controller.tool_offset = offset
    controller.record.offset("tool_offset", values=offset)


def set_home(controller: Controller, code: str) -> None:
    """G28.1 and G30.1: remember the present machine position."""
    controller.require_no_compensation("set a reference point")
    first = G28_HOME if code == "G28.1" else G30_HOME
    here = controller.to_machine_units(controller.machine_position())
    controller.parameters.set_vector(first, here)


def go_home(controller: Controller, block: Values, code: str) -> None:
    """G28 and G30: over the programmed point to the reference point."""
    end = block_end(controller, block)
    controller.require_no_compensation("use G28 or G30")
    traverse(controller, end)
    first = G28_HOME if code == "G28" else G30_HOME
    home = controller.from_machine(controller.to_program(controller.parameters.vector(first)))
    named = _axis_words(block) or dict.fromkeys(range(6))
    traverse(controller, [home[axis] if axis in named else end[axis] for axis in range(6)])


def end_program(controller: Controller) -> None:
    """M2, M30: back to G54 and to the modes of a fresh start."""
    rotate(controller.position, controller.rotation_deg)
    moved = [p + o for p, o in zip(controller.position, controller.origin, strict=True)]
    _load_system(controller, 1)
    controller.position = [p - o for p, o in zip(moved, controller.origin, strict=True)]
    rotate(controller.position, -controller.rotation_deg)
    record = controller.record
    record.offset("set_g5x_offset", 1, values=controller.origin)
    record.event("set_xy_rotation", controller.rotation_deg)


def load_offsets(controller: Controller) -> None:
    """Read the active system at the program's start and say it."""
    system = int(controller.parameters.numbered.get(FIRST_SYSTEM, 1.0))
    _load_system(controller, system)
    say_work_system(controller)
