"""Volume under triangles that follow a curved surface, by a node more in the middle of each side.

Source: divergence theorem; quadrature of degree 4 on triangles, D. A. Dunavant, Int. J. Numer.
Methods Eng. 21 (1985) 1129, rule 4.
"""

from __future__ import annotations

import numpy as np

__all__ = ["volume_under_mm3"]

#: barycentric coordinates and weights of the rule's six points
_A, _B = 0.445948490915965, 0.091576213509771
_POINTS = np.array([[1.0 - 2.0 * c if i == k else c for i in range(3)]
                    for c in (_A, _B) for k in range(3)])  # fmt: skip
_WEIGHTS = np.repeat([0.223381589678011, 0.109951743655322], 3) / 2.0


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
    nodes = np.concatenate([corners_mm, middles_mm], axis=1)
    total = 0.0
    for (a, b, c), weight in zip(_POINTS, _WEIGHTS, strict=True):
        shape = [a * (2 * a - 1), b * (2 * b - 1), c * (2 * c - 1), 4 * a * b, 4 * b * c, 4 * c * a]
        # along the sides 0-1 and 0-2, where a = 1 - b - c
        along_b = [1 - 4 * a, 4 * b - 1, 0.0, 4 * (a - b), 4 * c, -4 * c]
        along_c = [1 - 4 * a, 0.0, 4 * c - 1, -4 * b, 4 * b, 4 * (a - c)]
        x, one, other = (np.einsum("tij,i->tj", nodes, np.array(s))
                         for s in (shape, along_b, along_c))  # fmt: skip
        total += weight * float(np.einsum("ij,ij->", x, np.cross(one, other)))
    return total / 3.0
