"""What numbers without a decimal point count: least input increments (B-64484EN, 8.4)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from gcode.state.controller import PLANE_AXES, XY, XZ, YZ

if TYPE_CHECKING:
    from gcode.dialects.fanuc.block import MacroBlock
    from gcode.dialects.fanuc.blocks import BlockRunner

__all__ = ["INCREMENTS", "Increments", "count_arguments", "count_increments"]

#: Words that count in least input increments where they have no decimal point.
_LENGTHS = frozenset("xyzuvwijkrq")
_ANGLES = frozenset("abc")
_PLANES = {17: XY, 18: XZ, 19: YZ}
#: G codes whose X Y Z are no radius and angle while G16 is on
_NOT_POLAR = (4, 10, 28, 30, 51, 51.1, 50.1, 52, 53, 68, 92)


@dataclass(frozen=True)
class Increments:
    """What a number without a decimal point counts (parameters 1013 ISx and 3401#0 DPI).

    Attributes
    ----------
    mm, inch : float
        Lengths, in the unit of the program.
    degree : float
        Angles in degrees, and X and U of G4 in seconds.
    """

    mm: float
    inch: float
    degree: float

    def length(self, unit_mm: float) -> float:
        """Factor of a length in a unit of so many millimetres."""
        return self.mm if unit_mm == 1.0 else self.inch

    def of(self, letter: str, *, unit_mm: float) -> float:
        """Factor of a number of this letter where it is a place or the argument of a macro."""
        if letter in _ANGLES:
            return self.degree
        return self.length(unit_mm) if letter in _LENGTHS else 1.0


#: name of an increment system -> its increments; the calculator type takes numbers as they stand
INCREMENTS = {
    "IS-A": Increments(0.01, 0.001, 0.01),
    "IS-B": Increments(0.001, 0.0001, 0.001),
    "IS-C": Increments(0.0001, 0.00001, 0.0001),
    "calculator": Increments(1.0, 1.0, 1.0),
}


def count_increments(runner: BlockRunner, block: MacroBlock) -> None:
    """Give the words of a block that have no decimal point their values."""
    degrees = _degrees(runner, block)
    lengths = _lengths(runner, block) - degrees
    letters = sorted(block.pointless & (lengths | degrees) & block.words.keys())
    _tell(runner, {letter: block.words[letter] for letter in letters})
    unit_mm = 25.4 if block.has(20) else 1.0 if block.has(21) else runner.controller.unit_mm
    for letter in letters:
        counts = runner.increments
        block.words[letter] *= counts.degree if letter in degrees else counts.length(unit_mm)
    if block.corner is not None and "," in block.pointless:
        kind, size = block.corner
        block.corner = (kind, size * runner.increments.length(unit_mm))


def count_arguments(runner: BlockRunner, block: MacroBlock) -> list[tuple[str, float]]:
    """Arguments of G65 and G66, each in the increment of its address (B-63684EN, 16.7.1)."""
    unit_mm, words = runner.controller.unit_mm, []
    pointless = {}
    for (letter, value), has_point in zip(block.all_words, block.has_point, strict=True):
        factor = 1.0 if has_point else runner.increments.of(letter, unit_mm=unit_mm)
        words.append((letter, value * factor))
        if not has_point and letter in _LENGTHS | _ANGLES:
            pointless[letter] = value
    _tell(runner, pointless)
    return words


def _lengths(runner: BlockRunner, block: MacroBlock) -> set[str]:
    letters = set("xyzijkrq")
    if block.has(51):
        letters -= set("ijk")
    if block.has(5.1):
        letters.discard("q")  # which mode
    if runner.is_drilling(block) and not runner.settings.haas_cycles:
        letters.discard("k")  # how often
    return letters


def _degrees(runner: BlockRunner, block: MacroBlock) -> set[str]:
    """Letters of angles, and of the seconds of G4."""
    letters = set(_ANGLES)
    if block.has(4):
        letters |= set("xu")
    if block.has(68):
        letters.add("r")
    is_polar = block.has(16) or (runner.polar is not None and not block.has(15))
    if is_polar and not block.has(*_NOT_POLAR):
        said = (plane for code, plane in _PLANES.items() if block.has(code))
        letters.add("xyz"[PLANE_AXES[next(said, runner.controller.plane)][1]])
    return letters


def _tell(runner: BlockRunner, pointless: dict[str, float]) -> None:
    """One note on the first number without a point, where nobody has said what it counts."""
    notes = runner.controller.notes
    word = next((letter for letter, value in pointless.items() if value), None)
    if word is None or runner.is_told or any(name == "increment" for _, name in notes):
        return
    runner.controller.note(
        "increment",
        f"{word.upper()}{pointless[word]:g} has no decimal point and is read as it stands "
        '(calculator type); where the control counts 0.001 mm, say increment = "IS-B"',
    )
