"""RS274/NGC interpreter: executes one block in the controller's order of execution."""

from __future__ import annotations

from gcode.control import standalone
from gcode.control.checks import check_block, choose_motion
from gcode.control.modal_memory import ModalMemory, restoring_lines
from gcode.control.predefined import unknown_input
from gcode.errors import ProgramError
from gcode.motion import cutter_compensation, frames, interpolation
from gcode.motion.cycles import run_cycle
from gcode.motion.spindle_synchronised import run_threading, synchronised
from gcode.motion.splines import close_nurbs, nurbs_point, spline
from gcode.state.block_values import Values, evaluate, whole
from gcode.state.codes import ARCS, CODES, CYCLES, PATH_CONTROL
from gcode.state.controller import XY, XZ, YZ, Controller
from gcode.text.comments import expand_comment
from gcode.text.expressions import value_of, value_of_key
from gcode.text.lexer import Block, read_block

__all__ = ["assign", "execute", "restore_modes", "set_units"]

_PLANES = {"G17": XY, "G18": XZ, "G19": YZ}
_MODAL_MEMORY = ("M70", "M71", "M72", "M73")
_FEED_MODES = {"G93": "inverse", "G94": "minute", "G95": "revolution"}


def execute(controller: Controller, block: Block) -> bool:
    """Obey one block; returns True where the program ends with it.

    Order: comment, spindle mode, feed mode, F, S, T, M codes, G codes as in `_execute_g`, stop.

    Raises
    ------
    ProgramError
        For whatever a controller would refuse; the caller adds the line.
    """
    if controller.refresh:
        standalone.after_tool_change(controller)
    values = evaluate(block, controller.parameters)
    if controller.trace is not None:
        controller.trace.take(block)
    if controller.diameter_mode and "x" in values.words:
        values.words["x"] /= 2.0
    choose_motion(controller, values)
    check_block(controller, values)
    assign(controller, block)
    if block.comment is not None:
        _comment(controller, block.comment)
    if not (values.words or values.g or values.m):
        return False
    _execute_modes(controller, values)
    if values.m:
        _execute_m(controller, values)
    if values.g or values.motion is not None:
        _execute_g(controller, values)
    return "stop" in values.m and _stop(controller, values.m["stop"])


def assign(controller: Controller, block: Block) -> None:
    """Apply the parameter settings of a block, all evaluated before the first is made."""
    parameters = controller.parameters
    settled = [(value_of_key(name, parameters), value_of(value, parameters))
               for name, value in block.settings]  # fmt: skip
    for key, value in settled:
        parameters.set(key, value)


def _comment(controller: Controller, text: str) -> None:
    record = controller.record
    head, comma, rest = text.partition(",")
    if comma and head.strip().lower() == "abort":
        raise ProgramError(f"program aborts itself: {rest.strip()}")
    if comma and head.strip().lower() in ("msg", "debug", "print", "log"):
        record.event("message", expand_comment(rest, controller.parameters))
    else:
        controller.queue.say(lambda: record.event("comment", text))


def _execute_modes(controller: Controller, values: Values) -> None:
    """Spindle mode, feed mode, F, S, T."""
    g, words = values.g, values.words
    record, say = controller.record, controller.queue.say
    if "spindle_mode" in g:
        controller.css = g["spindle_mode"] == "G96"
        controller.note(g["spindle_mode"], "spindle speed mode")
    if "feed_mode" in g:
        controller.feed_mode = _FEED_MODES[g["feed_mode"]]
        per_revolution = int(controller.feed_mode == "revolution")
        say(lambda: record.event("set_feed_mode", per_revolution))
        if controller.feed_mode != "inverse":
            controller.feed = 0.0
            say(lambda: record.set_feed(0.0))
    if "f" in words and controller.feed_mode != "inverse":
        feed = controller.feed = words["f"]
        say(lambda: record.set_feed(feed))
    if "s" in words:
        controller.speed = words["s"]
        _say_spindle(controller)
    if "s" in words or "feed_mode" in g:
        record.rpm_of_feed = controller.speed if controller.feed_mode == "revolution" else None
    if "t" in words:
        number = int(words["t"])
        if controller.tools:
            controller.check_tool(number, word="T")
        controller.selected_tool = number


def _say_spindle(controller: Controller) -> None:
    record = controller.record
    rpm = controller.spindle * controller.speed
    controller.queue.say(lambda: record.event("spindle", rpm))


def _execute_m(controller: Controller, values: Values) -> None:
    """M codes in the order inputs and outputs, tool, spindle, coolant, overrides."""
    m, words = values.m, values.words
    if "io" in m:
        _input_output(controller, m["io"], words)
    if "tool_change" in m:
        _change_tool(controller, m["tool_change"], words)
    if "spindle" in m:
        _spindle(controller, m["spindle"])
    for group in ("coolant", "override"):
        if group in m:
            if group == "override":
                controller.require_no_compensation(f"use {m[group]}")
            controller.note(m[group], CODES[m[group]].text)
    coolant = m.get("coolant")
    controller.mist = coolant == "M7" or (controller.mist and coolant != "M9")
    controller.flood = coolant == "M8" or (controller.flood and coolant != "M9")


def _input_output(controller: Controller, code: str, words: dict[str, float]) -> None:
    controller.require_no_compensation(f"use {code}")
    if code == "M66":
        if not {"p", "e"} & words.keys():
            raise ProgramError("M66 without P or E word")
        unknown_input(controller.parameters)
    controller.note(code, CODES[code].text)


def _change_tool(controller: Controller, code: str, words: dict[str, float]) -> None:
    record = controller.record
    if code == "M61":
        number = whole(words.get("q", -1.0), "Q word of M61")
        if number < 0:
            raise ProgramError("M61 without Q word", accepted="Q with the tool's number")
        if controller.tools:
            controller.check_tool(number, word="Q")
        record.event("change_tool_number", number)
    else:
        if controller.selected_tool is None:
            raise ProgramError("M6 without a T word", hint="select the tool first: T1 M6")
        controller.require_no_compensation("change tools")
        number = controller.selected_tool
        controller.spindle = 0
        _say_spindle(controller)
        record.change_tool(number)
    controller.tool = number
    controller.refresh = True
    controller.set_tool_parameters()


def _spindle(controller: Controller, code: str) -> None:
    if code in _MODAL_MEMORY:
        _modal_memory(controller, code)
        return
    controller.spindle = {"M3": 1, "M4": -1}.get(code, 0)
    if CODES[code].is_noted:
        controller.note(code, CODES[code].text)
    _say_spindle(controller)


def _modal_memory(controller: Controller, code: str) -> None:
    """M70 saves the modal state, M71 forgets it, M72 restores it, M73 restores on return."""
    memory = controller.saved_modes
    if code == "M72":
        restore_modes(controller)
        return
    memory[-1] = None if code == "M71" else ModalMemory.of(controller)
    if code == "M73" and len(memory) > 1:
        controller.restore_on_return.add(len(memory))


def restore_modes(controller: Controller) -> None:
    """Bring back the modal state saved at this call level."""
    for text in restoring_lines(controller, controller.saved_modes[-1]):
        execute(controller, read_block(text))


def _execute_g(controller: Controller, values: Values) -> None:
    """G codes: dwell, plane, units, compensation, tool length, work system, path control,
    distance modes, retract mode, non-modal codes, motion."""
    g, record = values.g, controller.record
    nonmodal = g.get("nonmodal")
    if nonmodal == "G4":
        seconds = values.words["p"]
        controller.queue.say(lambda: record.dwell(seconds))
    if "plane" in g:
        _select_plane(controller, g["plane"])
    if "units" in g:
        set_units(controller, 25.4 if g["units"] == "G20" else 1.0)
    if "diameter" in g:
        _diameter_mode(controller, values)
    if "compensation" in g:
        cutter_compensation.switch(controller, values, g["compensation"])
    if "tool_length" in g:
        frames.set_tool_length(controller, values, g["tool_length"])
    if "system" in g:
        frames.select_system(controller, g["system"])
    if "control" in g:
        _set_path_control(controller, g["control"], values.words.get("p", 0.0))
    if "distance" in g:
        controller.absolute = g["distance"] == "G90"
    if "arc_distance" in g:
        controller.arc_absolute = g["arc_distance"] == "G90.1"
    if "retract" in g:
        controller.require_no_compensation("change the retract mode")
        controller.retract_to_initial = g["retract"] == "G98"
    if nonmodal is not None:
        _nonmodal(controller, values, nonmodal)
    if "g92_applied" in g:
        frames.axis_offsets(controller, values, g["g92_applied"])
    if values.motion is not None:
        _move(controller, values, values.motion)


def _set_path_control(controller: Controller, code: str, blend: float) -> None:
    """G61, G61.1, G64 P; LinuxCNC alone forbids them within cutter compensation."""
    if not controller.start_up:
        controller.require_no_compensation("change the control mode")
    controller.path_control = code
    mode, blend_mm = PATH_CONTROL[code], blend * controller.unit_mm if code == "G64" else 0.0
    controller.queue.say(lambda: controller.record.event("path_control", mode, blend_mm))


def _select_plane(controller: Controller, code: str) -> None:
    plane = _PLANES[code]
    if controller.side and (plane != controller.plane or plane == YZ):
        raise ProgramError("cannot change planes with cutter compensation on")
    controller.plane = plane
    controller.record.event("set_plane", plane)


def set_units(controller: Controller, unit_mm: float) -> None:
    """G20 and G21: express the whole state in the other unit."""
    if unit_mm == controller.unit_mm:
        return
    factor = 1.0 / 25.4 if unit_mm == 25.4 else 25.4
    for values in (controller.position, controller.g92, controller.origin,
                   controller.tool_offset, controller.programmed):  # fmt: skip
        values[:3] = [v * factor for v in values[:3]]
    standalone.keep_tool_offset(controller, factor)
    controller.feed *= factor
    controller.radius *= factor
    controller.queue.scale(factor)
    controller.unit_mm = controller.record.unit_mm = unit_mm


def _diameter_mode(controller: Controller, values: Values) -> None:
    wanted = values.g["diameter"] == "G7"
    if wanted != controller.diameter_mode and "x" in values.words:
        values.words["x"] *= 0.5 if wanted else 2.0
    controller.diameter_mode = wanted


def _nonmodal(controller: Controller, values: Values, code: str) -> None:
    if code == "G10":
        frames.write_tables(controller, values)
    elif code in ("G28", "G30"):
        frames.go_home(controller, values, code)
    elif code in ("G28.1", "G30.1"):
        frames.set_home(controller, code)
    elif code in ("G52", "G92"):
        frames.axis_offsets(controller, values, code)
    elif code == "G5.3":
        close_nurbs(controller)


def _move(controller: Controller, values: Values, code: str) -> None:
    if code not in CYCLES:
        controller.cycle.initial = None
    if code in ("G0", "G1"):
        interpolation.straight(controller, values, code)
    elif code in ARCS:
        interpolation.arc(controller, values, code)
    elif code in CYCLES:
        run_cycle(controller, values, code)
    elif code == "G80":
        controller.motion = "G80"
    elif code.startswith("G38."):
        interpolation.probe(controller, values, code)
    elif code in ("G33", "G33.1"):
        synchronised(controller, values, code)
    elif code == "G76":
        run_threading(controller, values)
    elif code == "G5.2":
        nurbs_point(controller, values)
    else:
        spline(controller, values, code)


def _stop(controller: Controller, code: str) -> bool:
    """M0, M1, M60 go on; M2, M30 and M99 of the main program end it."""
    cutter_compensation.flush(controller)
    if CODES[code].is_noted:
        controller.note(code, CODES[code].text)
        return False
    frames.end_program(controller)
    if controller.plane != XY:
        controller.plane = XY
        controller.record.event("set_plane", XY)
    controller.record.set_feed(0.0)
    controller.spindle = 0
    _say_spindle(controller)
    return True
