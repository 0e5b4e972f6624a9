"""Words before the motion of a block: units, planes, work offsets, G15 and G16, transformations."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gcode.dialects.fanuc.block import MacroBlock
from gcode.dialects.fanuc.transform import Transform
from gcode.errors import ProgramError
from gcode.language.translate import number
from gcode.motion import frames
from gcode.state.block_values import whole
from gcode.state.controller import PLANE_AXES

if TYPE_CHECKING:
    from gcode.dialects.fanuc.blocks import BlockRunner

__all__ = ["HAAS_MIRROR", "obey_frames"]

#: G100 and G101 -> the codes of Fanuc that do the same
HAAS_MIRROR = {100.0: 50.1, 101.0: 51.1}


def obey_frames(runner: BlockRunner, block: MacroBlock) -> None:
    """Everything before the motion; takes its words out of the block."""
    _extended_system(runner, block)
    for codes in ((20, 21), (17, 18, 19), (90, 91), (93, 94, 95), (61.1, 64),
                  (98, 99), (54, 55, 56, 57, 58, 59)):  # fmt: skip
        code = block.take(*codes)
        if code is not None:
            runner.finish_corner()
            runner.execute(f"g{code:g}")
    if "f" in block.words and not block.has(93) and runner.controller.feed_mode != "inverse":
        runner.execute(f"f{number(block.words.pop('f'))}")
    _polar(runner, block)
    _transformations(runner, block)
    runner.offsets.obey(block)
    if block.has(52, 92):
        runner.finish_corner()
        runner.execute(MacroBlock(block.pop("xyzabc"), g=[block.take(52, 92)]).text())
    if block.has(92.1):
        block.take(92.1)
        runner.execute("g92.1")


def _extended_system(runner: BlockRunner, block: MacroBlock) -> None:
    """G54.1 P5, G154 P5: further work offsets; G110 to G129 of Haas are the first of them."""
    if runner.settings.haas_cycles:
        for code in [code for code in block.g if code in range(110, 130)]:
            block.g.remove(code)
            frames.select_system(runner.controller, f"G54.1 P{code - 109:.0f}")
    code = block.take(54.1, 154)
    if code is None and block.has(54) and "p" in block.words:
        code = block.take(54)
    if code is None:
        return
    if "p" not in block.words:
        raise ProgramError(f"G{code:g} without P word", accepted="P1 to P99")
    frames.select_system(runner.controller, f"G54.1 P{whole(block.words.pop('p'), 'P word')}")


def _polar(runner: BlockRunner, block: MacroBlock) -> None:
    if block.take(15) is not None:
        runner.polar = None
    if block.take(16) is not None:
        absolute = runner.controller.absolute
        runner.polar = [0.0] * 3 if absolute else list(runner.here())


def _transformations(runner: BlockRunner, block: MacroBlock) -> None:
    controller = runner.controller
    if runner.settings.haas_cycles:
        _mirror_of_haas(block)
    codes = [code for code in (50.1, 51.1, 50.0, 51.0, 68.0, 69.0) if code in block.g]
    if not codes:
        return
    runner.finish_corner()
    controller.require_no_compensation("change scaling, rotation or mirror image")
    for code in codes:
        block.g.remove(code)
        if code in (50.1, 51.1):
            runner.transform = runner.transform.mirrored(block.pop("xyz"), on=code == 51.1)
        elif code == 50.0:
            runner.transform = runner.transform.unscaled()
        elif code == 51.0:
            runner.transform = _scaling(runner, block)
        elif code == 69.0:
            runner.transform = runner.transform.unrotated()
        else:
            runner.transform = _rotation(runner, block)


def _mirror_of_haas(block: MacroBlock) -> None:
    """G101 X0. mirrors about the work zero, whatever the number; G100 ends it."""
    for own, common in HAAS_MIRROR.items():
        if own in block.g:
            block.g[block.g.index(own)] = common
            block.words |= dict.fromkeys(block.words.keys() & set("xyz"), 0.0)


def _scaling(runner: BlockRunner, block: MacroBlock) -> Transform:
    words = block.pop("xyzijkp")
    if not words.keys() & set("ijkp"):
        raise ProgramError("G51 without scale factor", accepted="P, or I J K")
    if not runner.settings.pointless_factor and block.pointless & words.keys() & set("ijkp"):
        raise ProgramError(
            "G51 with a scale factor without a decimal point",
            accepted="P1.5; its unit is parameter 5400#7 of the control",
        )
    return runner.transform.scaled(words, runner.here())


def _rotation(runner: BlockRunner, block: MacroBlock) -> Transform:
    if block.words.keys() & set("ijk"):
        raise ProgramError("G68 with I J K (three-dimensional coordinate conversion) is not read",
                           accepted="G68 X Y R in the plane")  # fmt: skip
    if "r" not in block.words:
        raise ProgramError("G68 without R word", accepted="R with the angle in degrees")
    first, second, _ = PLANE_AXES[runner.controller.plane]
    words, here = block.pop("xyzr"), runner.here()
    pivot = (words.get("xyz"[first], here[first]), words.get("xyz"[second], here[second]))
    angle = words["r"]
    if not runner.controller.absolute and runner.transform.angle_deg:
        angle += runner.transform.angle_deg
    return runner.transform.rotated(pivot, angle, runner.controller.plane)
