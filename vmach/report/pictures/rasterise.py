"""A picture of a coloured mesh without any graphics library."""

from __future__ import annotations

import numpy as np
from numba import njit

from vmach.report.pictures.camera import Camera
from vmach.report.pictures.display_mesh import sharp_edges
from vmach.report.result import DisplayMesh

__all__ = ["rasterise"]

_OVERSAMPLING = 3
#: width of an outline: one pixel, half of it on either side of the edge
_LINE_SAMPLES = _OVERSAMPLING
_EDGE_COLOUR = (0.16, 0.18, 0.20)


def rasterise(
    mesh: DisplayMesh, colours: np.ndarray, camera: Camera, size: tuple[int, int]
) -> np.ndarray:
    """Draw a mesh with a depth buffer.

    Parameters
    ----------
    mesh : DisplayMesh
    colours : (V, 3) float
        sRGB, 0 to 1, of each vertex, shading included.
    camera : Camera
    size : (int, int)
        Width and height of the picture in pixels.

    Returns
    -------
    (height, width, 4) uint8
        RGBA, transparent where there is no part.
    """
    width, height = (_OVERSAMPLING * side for side in size)
    seen = camera.pixels(mesh.vertices_mm, (width, height))
    image = np.zeros((height, width, 4))
    depth = np.full((height, width), -np.inf)
    _fill_triangles(seen, mesh.triangles, colours, image, depth)
    bias_mm = 2e-3 * camera.height_mm
    edges, colour = seen[sharp_edges(mesh)], np.array(_EDGE_COLOUR)
    _draw_lines(edges, colour, image, depth - bias_mm, _LINE_SAMPLES)
    blocks = image.reshape(size[1], _OVERSAMPLING, size[0], _OVERSAMPLING, 4)
    return _over_white_fringe(blocks.mean(axis=(1, 3)))


def _over_white_fringe(image: np.ndarray) -> np.ndarray:
    """Undo the darkening of half-covered pixels; to 8 bits."""
    alpha = image[..., 3:]
    colour = image[..., :3] / np.where(alpha > 0, alpha, 1.0)
    return np.round(255 * np.concatenate([colour, alpha], axis=2)).astype(np.uint8)


@njit(cache=True)
def _fill_triangles(seen, triangles, colours, image, depth):
    height, width = depth.shape
    for i in range(len(triangles)):
        a, b, c = seen[triangles[i, 0]], seen[triangles[i, 1]], seen[triangles[i, 2]]
        twice_area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        if twice_area == 0:
            continue
        left = max(int(np.ceil(min(a[0], b[0], c[0]) - 0.5)), 0)
        right = min(int(np.floor(max(a[0], b[0], c[0]) - 0.5)), width - 1)
        top = max(int(np.ceil(min(a[1], b[1], c[1]) - 0.5)), 0)
        bottom = min(int(np.floor(max(a[1], b[1], c[1]) - 0.5)), height - 1)
        for row in range(top, bottom + 1):
            y = row + 0.5
            for column in range(left, right + 1):
                x = column + 0.5
                v = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / twice_area
                w = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / twice_area
                u = 1.0 - v - w
                if u < -1e-9 or v < -1e-9 or w < -1e-9:
                    continue
                z = u * a[2] + v * b[2] + w * c[2]
                if z > depth[row, column]:
                    depth[row, column] = z
                    for k in range(3):
                        image[row, column, k] = (
                            u * colours[triangles[i, 0], k]
                            + v * colours[triangles[i, 1], k]
                            + w * colours[triangles[i, 2], k]
                        )
                    image[row, column, 3] = 1.0


@njit(cache=True)
def _draw_lines(lines, colour, image, depth, width_samples):
    height, width = depth.shape
    for i in range(len(lines)):
        start, end = lines[i, 0], lines[i, 1]
        steps = int(np.ceil(max(abs(end[0] - start[0]), abs(end[1] - start[1])))) + 1
        for k in range(steps + 1):
            point = start + (end - start) * (k / steps)
            left = int(point[0] - 0.5 * (width_samples - 1))
            top = int(point[1] - 0.5 * (width_samples - 1))
            for row in range(max(top, 0), min(top + width_samples, height)):
                for column in range(max(left, 0), min(left + width_samples, width)):
                    if point[2] >= depth[row, column]:
                        image[row, column, :3] = colour
                        image[row, column, 3] = 1.0
