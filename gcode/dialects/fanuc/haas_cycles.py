"""G12, G13 (circular pocket) and G70 to G72 (holes on a circle or line) of Haas.

Source: Haas Automation, Mill Operator's Manual 96-8210, "G12 Circular Pocket Milling CW / G13
Circular Pocket Milling CCW", "G70 Bolt Hole Circle", "G71 Bolt Hole Arc", "G72 Bolt Holes Along an
Angle". The tool stands in the middle, for G72 at the first hole.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from gcode.dialects.fanuc.block import MacroBlock
from gcode.errors import ProgramError
from gcode.language.translate import number, xy_words
from gcode.state.block_values import whole

if TYPE_CHECKING:
    from gcode.dialects.fanuc.blocks import BlockRunner

__all__ = ["HAAS_CYCLES", "haas_cycle"]

HAAS_CYCLES = (12.0, 13.0, 70.0, 71.0, 72.0)
#: more circles or holes than this are a mistake
_MOST = 10_000


def haas_cycle(runner: BlockRunner, block: MacroBlock) -> bool:
    """Obey one of the cycles; tells whether it moved the axes."""
    code = block.take(*HAAS_CYCLES)
    if not runner.transform.is_identity or runner.polar is not None:
        raise ProgramError(
            f"G{code:g} with rotation, scaling, mirror image or G16 is not read",
            hint="cancel them first",
        )
    if code in (12.0, 13.0):
        _circular_pocket(runner, block, clockwise=code == 12.0)
    else:
        _holes(runner, block, code)
    return True


def _circular_pocket(runner: BlockRunner, block: MacroBlock, *, clockwise: bool) -> None:
    c, words = runner.controller, block.pop("xyzikql")
    if "i" not in words:
        raise ProgramError("G12 and G13 need the radius I of the first circle")
    c.require_no_compensation("use G12 or G13")
    offset = 0.0
    if runner.offsets.d:
        entry = c.find_offset(whole(runner.offsets.d, "D word"), word="D")
        offset = entry.offset_diameter_mm / 2.0 / c.unit_mm
    radii = [radius - offset for radius in _radii(words)]
    if not radii[0] > 0.0:
        raise ProgramError(f"I{words['i']:g} is not larger than the tool's radius {offset:g}")
    rounds = whole(words.get("l", 1.0), "L word")
    x, y, z = runner.here()
    level, was = z, c.absolute
    modal = c.motion
    c.absolute = True
    for _ in range(min(max(rounds, 1), _MOST)):
        if "z" in words:
            level = words["z"] if was else level + words["z"]
            runner.execute(f"g1z{number(level)}")
        for text in _circles((x, y), radii, clockwise=clockwise):
            runner.execute(text)
    c.absolute, c.motion = was, modal


def _radii(words: dict[str, float]) -> list[float]:
    """I, then Q more each time up to K."""
    if "k" not in words:
        return [words["i"]]
    step = abs(words.get("q", 0.0))
    if step == 0.0:
        raise ProgramError("G12 and G13 with K need the increment Q")
    count = math.ceil((words["k"] - words["i"]) / step - 1e-9)
    if not 0 <= count <= _MOST:
        raise ProgramError(f"K{words['k']:g} and Q{step:g} behind I{words['i']:g}")
    return [min(words["i"] + step * k, words["k"]) for k in range(count + 1)]


def _circles(centre: tuple[float, float], radii: list[float], *, clockwise: bool) -> Iterator[str]:
    """From the middle on a semicircle to each circle, round it, and back at the end."""
    code = "g2" if clockwise else "g3"
    x, y = centre
    at = 0.0
    for radius in radii:
        half = (radius + at) / 2.0  # from the far side of the circle before
        if at:
            yield f"{code}{xy_words(x - at, y)}i{number(-at)}j0"
            yield f"{code}{xy_words(x + radius, y)}i{number(half)}j0"
        else:
            yield f"{code}{xy_words(x + radius, y)}i{number(radius / 2.0)}j0"
        yield f"{code}{xy_words(x + radius, y)}i{number(-radius)}j0"
        at = radius
    yield f"{code}{xy_words(x, y)}i{number(-at / 2.0)}j0"


def _holes(runner: BlockRunner, block: MacroBlock, code: float) -> None:
    """The canned cycle in force, on a circle about where the tool stands or X Y, or on a line."""
    words = block.pop("xyijkl")
    if runner.cycle is None or runner.cycle.bottom is None:
        raise ProgramError(f"G{code:g} without a canned cycle", accepted="G81 ... L0 before it")
    missing = [k for k in ("i", "j", "l", *("k" if code == 71.0 else "")) if k not in words]
    if missing:
        raise ProgramError(f"G{code:g} without {missing[0].upper()} word")
    count = whole(words["l"], "L word")
    if not 1 <= count <= _MOST:
        raise ProgramError(f"G{code:g} with {count} holes")
    here = runner.here()
    x, y = words.get("x", here[0]), words.get("y", here[1])
    step = {70.0: 360.0 / count, 71.0: words.get("k", 0.0), 72.0: 0.0}[code]
    for k in range(count):
        angle = math.radians(words["j"] + k * step)
        away = words["i"] * (k if code == 72.0 else 1.0)
        runner.cycle.hole_at(
            runner, [x + away * math.cos(angle), y + away * math.sin(angle), here[2]]
        )
