"""Volume under triangles that follow a curved surface, by a node more in the middle of each side.

Source: divergence theorem; quadrature of degree 4 on triangles, D. A. Dunavant, Int. J. Numer.
Methods Eng. 21 (1985) 1129, rule 4.
"""

from __future__ import annotations

import numpy as np

from stock.compiled import njit_maker

__all__ = ["area_mm2", "volume_under_mm3"]

#: barycentric coordinates and weights of the rule's six points
_A, _B = 0.445948490915965, 0.091576213509771
_POINTS = np.array([[1.0 - 2.0 * c if i == k else c for i in range(3)]
                    for c in (_A, _B) for k in range(3)])  # fmt: skip
_WEIGHTS = np.repeat([0.223381589678011, 0.109951743655322], 3) / 2.0


def _shapes(a: float, b: float, c: float) -> list[list[float]]:
    """Share of each of the six nodes in the point, and in its slopes along the sides 0-1 and 0-2.

    Along these a = 1 - b - c.
    """
    return [
        [a * (2 * a - 1), b * (2 * b - 1), c * (2 * c - 1), 4 * a * b, 4 * b * c, 4 * c * a],
        [1 - 4 * a, 4 * b - 1, 0.0, 4 * (a - b), 4 * c, -4 * c],
        [1 - 4 * a, 0.0, 4 * c - 1, -4 * b, 4 * b, 4 * (a - c)],
    ]


_SHAPES = np.array([_shapes(*point) for point in _POINTS])


def volume_under_mm3(corners_mm: np.ndarray, middles_mm: np.ndarray) -> float:
    """A third of the integral of x . n over curved triangles; of a closed surface the volume.

    Parameters
    ----------
    corners_mm : (T, 3, 3) float64
        Counter-clockwise seen from outside.
    middles_mm : (T, 3, 3) float64
        Points of the surface near the middles of the sides 0-1, 1-2 and 2-0; the same for both
        triangles of a side.
    """
    return _volume(np.ascontiguousarray(corners_mm), np.ascontiguousarray(middles_mm))


@njit_maker()
def _volume(corners_mm, middles_mm):
    total = 0.0
    sums = np.empty((3, 3))
    for t in range(len(corners_mm)):
        for p in range(len(_SHAPES)):
            sums[:] = 0.0
            for k in range(3):
                for row in range(3):
                    for axis in range(3):
                        sums[row, axis] += _SHAPES[p, row, k] * corners_mm[t, k, axis]
                        sums[row, axis] += _SHAPES[p, row, k + 3] * middles_mm[t, k, axis]
            x, b, c = sums
            total += _WEIGHTS[p] * (
                x[0] * (b[1] * c[2] - b[2] * c[1])
                + x[1] * (b[2] * c[0] - b[0] * c[2])
                + x[2] * (b[0] * c[1] - b[1] * c[0])
            )
    return total / 3.0


@njit_maker()
def area_mm2(vertices_mm, triangles):
    """Area of plane triangles (T, 3) between vertices (V, 3)."""
    total, one, other = 0.0, np.empty(3), np.empty(3)
    for t in range(len(triangles)):
        for axis in range(3):
            first = vertices_mm[triangles[t, 0], axis]
            one[axis] = vertices_mm[triangles[t, 1], axis] - first
            other[axis] = vertices_mm[triangles[t, 2], axis] - first
        x = one[1] * other[2] - one[2] * other[1]
        y = one[2] * other[0] - one[0] * other[2]
        z = one[0] * other[1] - one[1] * other[0]
        total += np.sqrt(x * x + y * y + z * z)
    return total / 2.0
