"""M codes of a Fanuc block: those before the motion, those behind it, and those nobody knows."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gcode.dialects.fanuc.block import MacroBlock
from gcode.dialects.fanuc.machine_moves import to_reference
from gcode.errors import ProgramError
from gcode.state.block_values import whole

if TYPE_CHECKING:
    from gcode.dialects.fanuc.blocks import BlockRunner

__all__ = ["AT_THE_END", "obey_m_codes"]

#: act when the block's motion has ended
AT_THE_END = (0, 1, 2, 5, 9, 30, 60)
_SENSES = {13: 3, 14: 4}  #: spindle and coolant -> spindle


def obey_m_codes(runner: BlockRunner, block: MacroBlock) -> list[int]:
    """Obey the M codes that act before the motion; gives those that act after it."""
    after = [code for code in block.m if code in AT_THE_END]
    before = [code for code in block.m if code not in after]
    block.m = []
    following = _choose_tool(runner, block)
    if "s" in block.words:
        runner.in_order(f"s{block.words.pop('s'):g}")
    for code in before:
        if code in (3, 4, 6, 7, 8, 19):
            if code in (6, 19):
                runner.finish_corner()
            if code == 19:
                block.pop("pr")
            runner.in_order(f"m{code}")
            if code == 6 and following is not None:
                runner.execute(f"t{following}")
        elif code in _SENSES:
            runner.in_order(f"m{_SENSES[code]}m8")
        elif code in runner.settings.z_home_m:
            runner.finish_corner()
            to_reference(runner, {"z": runner.here()[2]}, 28.0)
        elif code in runner.settings.builder_m:
            block.pop("p" if code not in (29,) else "")
            runner.controller.note(f"M{code}", runner.settings.builder_m[code])
        elif code in runner.reader.options.control.ignore_m:
            runner.controller.note(f"M{code}", "machine builder's code, ignored by ignore_m")
        else:
            raise _unknown_m(runner)
    return after


def _choose_tool(runner: BlockRunner, block: MacroBlock) -> int | None:
    """T; gives the tool that a second T word chooses for later."""
    tools = [whole(value, "T word") for letter, value in block.all_words if letter == "t"]
    if not block.pop("t"):
        return None
    if len(tools) > 1 and not (runner.settings.next_tool_in_block and len(tools) == 2):
        raise ProgramError(f"{len(tools)} T words in a block", accepted="one",
                           hint="T1 T2 M6 of Mazak is read as --control mazak")  # fmt: skip
    runner.execute(f"t{tools[0]}")
    return tools[1] if len(tools) > 1 else None


def _unknown_m(runner: BlockRunner) -> ProgramError:
    """One error for all M codes of the program that nobody knows."""
    known = {*runner.settings.builder_m, *runner.settings.z_home_m, *_SENSES, *AT_THE_END,
             *runner.reader.options.control.ignore_m, 3, 4, 6, 7, 8, 19, 97, 98, 99}  # fmt: skip
    found = runner.reader.m_codes() - known
    listed = ", ".join(str(code) for code in sorted(found))
    names = " ".join(f"M{code}" for code in sorted(found))
    return ProgramError(
        f"M codes of the machine's builder: {names}",
        accepted=f"ignore_m = [{listed}] in [control], if they move nothing",
    )
