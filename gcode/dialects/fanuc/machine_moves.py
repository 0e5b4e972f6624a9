"""Blocks whose end is the machine's: G4, G28, G30, G31 and G53 (B-64484EN)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gcode.dialects.fanuc.block import MacroBlock
from gcode.errors import ProgramError
from gcode.language.translate import number
from gcode.state.block_values import whole

if TYPE_CHECKING:
    from gcode.dialects.fanuc.blocks import BlockRunner

__all__ = ["dwell", "machine_position", "reference", "skip", "to_reference"]


def dwell(runner: BlockRunner, block: MacroBlock) -> bool:
    """G4: P in milliseconds, X or U in seconds (B-64484EN, "Dwell")."""
    block.take(4)
    words = block.pop("pxu")
    if len(words) != 1:
        raise ProgramError(
            "G4 needs one of P, X and U",
            accepted="P in milliseconds: G4 P500; X in seconds: G4 X0.5",
        )
    letter, value = words.popitem()
    if letter == "p":
        pointed, unit_s = "p" not in block.pointless, runner.settings.dwell_p_s
        in_seconds = runner.settings.pointed_p_is_seconds or unit_s == 1.0
        if pointed and not in_seconds and value != int(value):
            raise ProgramError(
                f"G4 P{value:g}: P takes no decimal point",
                accepted="P in milliseconds, or X in seconds",
            )
        value *= 1.0 if pointed and in_seconds else unit_s
    if value < 0.0:
        raise ProgramError(f"negative dwell {value:g} s")
    runner.execute(f"g4p{number(value)}" if value >= 1e-9 else "g4p0")
    return False


def reference(runner: BlockRunner, block: MacroBlock) -> bool:
    """G28, G30: over an intermediate point to the reference point; G0 or G1 beside it."""
    code = block.take(28, 30)
    block.take(0, 1)
    if "p" in block.words and code == 30:
        point = whole(block.words.pop("p"), "P word of G30")
        if point != 2:
            raise ProgramError(
                f"G30 P{point}: third and fourth reference point", accepted="G28, G30 or G30 P2"
            )
    words = block.pop("xyzabc")
    if not words and runner.settings.reference_all_axes:
        words = dict(
            zip("xyz", runner.here() if runner.controller.absolute else (0.0,) * 3, strict=True)
        )
    if not words:
        raise ProgramError(f"G{code:g} without axes", accepted="G91 G28 Z0.")
    if not runner.transform.is_identity or runner.polar is not None:
        raise ProgramError(
            f"G{code:g} with rotation, scaling, mirror image or G16 on",
            hint="cancel them first",
        )
    to_reference(runner, words, code)
    return True


def to_reference(runner: BlockRunner, words: dict[str, float], code: float) -> None:
    """Axes to their reference point over a programmed point; the modal motion stays."""
    modal = runner.controller.motion
    runner.execute(MacroBlock(words, g=[code]).text())
    runner.controller.motion = modal if modal in ("G0", "G1", "G2", "G3") else "G0"


def machine_position(runner: BlockRunner, block: MacroBlock) -> bool:
    """G53: rapid in machine coordinates; without effect in G91 (B-64484EN)."""
    block.take(53)
    modal = runner.controller.motion
    own = block.take(0, 1)
    words = block.pop("xyzabc")
    if not words:
        return False
    if not runner.controller.absolute:
        runner.controller.note("G53", "ignored by the control in G91, as its manual says")
        return False
    runner.execute(MacroBlock(words, g=[53.0, 0.0]).text())
    runner.controller.motion = f"G{own:g}" if own is not None else modal
    runner.forget()
    return True


def skip(runner: BlockRunner, block: MacroBlock) -> bool:
    """G31: a feed move that a signal may end."""
    block.take(31)
    runner.controller.note("G31", "skip: the input is taken to stay off to the end of the move")
    block.pop("pqm")
    modal = runner.controller.motion
    if not block.has(0, 1, 2, 3):
        block.g.append(1.0)
    moved = runner.interpolate(block, 1.0)
    runner.controller.motion = modal
    return moved
