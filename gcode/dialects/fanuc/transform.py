"""G50.1/G51.1 mirror image, G50/G51 scaling, G68/G69 rotation: what becomes of a programmed point.

They act in this order whatever the order of their blocks (B-64484EN-2, "Scaling", "Programmable
mirror image"; B-64484EN, "Coordinate system rotation").
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from gcode.errors import ProgramError
from gcode.state.controller import PLANE_AXES

__all__ = ["Transform"]


@dataclass(frozen=True)
class Transform:
    """Mirror image, scaling and rotation in force; lengths in program units.

    Attributes
    ----------
    mirror : tuple of float or None
        For X, Y and Z the coordinate that is mirrored at.
    centre, factor : tuple of float
        Of the scaling.
    pivot : tuple of float
        First and second coordinate of the rotation's centre in `plane`.
    angle_deg : float
    plane : int
    """

    mirror: tuple[float | None, float | None, float | None] = (None, None, None)
    centre: tuple[float, float, float] = (0.0, 0.0, 0.0)
    factor: tuple[float, float, float] = (1.0, 1.0, 1.0)
    pivot: tuple[float, float] = (0.0, 0.0)
    angle_deg: float = 0.0
    plane: int = 1

    @property
    def is_identity(self) -> bool:
        """Nothing is in force."""
        return self == Transform()

    def mirrored(self, words: dict[str, float], *, on: bool) -> Transform:
        """After G51.1 (on) or G50.1 with axis words."""
        if not words:
            return replace(self, mirror=(None, None, None)) if not on else self
        values = [words.get(a, old) if on else None if a in words else old
                  for a, old in zip("xyz", self.mirror, strict=True)]  # fmt: skip
        return replace(self, mirror=tuple(values))

    def scaled(self, words: dict[str, float], here: list[float]) -> Transform:
        """After G51 with centre X Y Z and factor P, or I J K for each axis."""
        factor = [words.get(k, words.get("p", 1.0)) for k in "ijk"]
        if 0.0 in factor:
            raise ProgramError("G51 with scale factor zero")
        centre = [words.get(a, h) for a, h in zip("xyz", here, strict=True)]
        return replace(self, centre=tuple(centre), factor=tuple(factor))

    def unscaled(self) -> Transform:
        """After G50."""
        return replace(self, centre=(0.0, 0.0, 0.0), factor=(1.0, 1.0, 1.0))

    def rotated(self, pivot: tuple[float, float], angle_deg: float, plane: int) -> Transform:
        """After G68."""
        return replace(self, pivot=pivot, angle_deg=angle_deg, plane=plane)

    def unrotated(self) -> Transform:
        """After G69."""
        return replace(self, pivot=(0.0, 0.0), angle_deg=0.0, plane=1)

    def point(self, point: list[float]) -> list[float]:
        """Where a programmed point X Y Z goes."""
        result = [2.0 * m - p if m is not None else p
                  for p, m in zip(point, self.mirror, strict=True)]  # fmt: skip
        result = [c + f * (p - c)
                  for p, c, f in zip(result, self.centre, self.factor, strict=True)]  # fmt: skip
        return self._turned(result, self.pivot)

    def vector(self, vector: list[float]) -> list[float]:
        """What becomes of a distance X Y Z, such as I J K of an arc."""
        signs = [-1.0 if m is not None else 1.0 for m in self.mirror]
        result = [v * s * f for v, s, f in zip(vector, signs, self.factor, strict=True)]
        return self._turned(result, (0.0, 0.0))

    def _turned(self, point: list[float], pivot: tuple[float, float]) -> list[float]:
        if not self.angle_deg:
            return point
        first, second, _ = PLANE_AXES[self.plane]
        angle = math.radians(self.angle_deg)
        out = point[first] - pivot[0], point[second] - pivot[1]
        result = list(point)
        result[first] = pivot[0] + out[0] * math.cos(angle) - out[1] * math.sin(angle)
        result[second] = pivot[1] + out[0] * math.sin(angle) + out[1] * math.cos(angle)
        return result

    def flips(self, plane: int) -> bool:
        """Whether arcs and sides change their sense in a plane."""
        first, second, _ = PLANE_AXES[plane]
        sense = 1.0
        for axis in (first, second):
            sense *= (-1.0 if self.mirror[axis] is not None else 1.0) * self.factor[axis]
        return sense < 0.0

    def arc_factor(self, plane: int) -> float:
        """Factor of an arc's radius; raises ProgramError where arcs become ellipses."""
        first, second, _ = PLANE_AXES[plane]
        if abs(self.factor[first]) != abs(self.factor[second]):
            raise ProgramError(
                f"arc with scale factors {self.factor[first]:g} and {self.factor[second]:g}",
                accepted="G51 with one factor P",
            )
        return abs(self.factor[first])
