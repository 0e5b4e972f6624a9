"""Heights that a ball leaves along straight moves, found by OpenCAMLib.

OpenCAMLib drops a cutter on triangles. Under places p of its tip a ball of radius R leaves the
floor of the least p_z + R - sqrt(R^2 - d^2). So it is what a ball meets that is dropped upside down
on the path: on its mirror image in z = 0, with a sharp fin of triangles under every move.
"""

from __future__ import annotations

import numpy as np

__all__ = ["heights_left"]

#: height of the fins, mm: of no influence, as only their upper edges are met
_FIN_MM = 1.0


def heights_left(path_mm: np.ndarray, places_mm: np.ndarray, diameter_mm: float) -> np.ndarray:
    """Height of the floor at places, (P,) mm; infinite where no move passes.

    Parameters
    ----------
    path_mm : (M + 1, 3) float64
        Corners of the way of the ball's tip.
    places_mm : (P, 2) float64
    diameter_mm : float
    """
    import opencamlib

    surface, nowhere = opencamlib.STLSurf(), -float(np.abs(path_mm[:, 2]).max()) - 1e3
    mirrored = path_mm * [1.0, 1.0, -1.0]
    for start, end in zip(mirrored[:-1].tolist(), mirrored[1:].tolist(), strict=True):
        below = [*end[:2], end[2] - _FIN_MM]
        corners = (opencamlib.Point(*corner) for corner in (start, end, below))
        surface.addTriangle(opencamlib.Triangle(*corners))
    drop = opencamlib.BatchDropCutter()
    drop.setSTL(surface)
    drop.setCutter(opencamlib.BallCutter(diameter_mm, 100.0))
    for x, y in places_mm.tolist():
        drop.appendPoint(opencamlib.CLPoint(x, y, nowhere))
    drop.run()
    height = np.array([point.z for point in drop.getCLPoints()])
    return np.where(height > nowhere, -height, np.inf)
