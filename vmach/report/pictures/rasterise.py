"""A picture of a coloured mesh without any graphics library."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit

from stock.threads import run_in_parts
from vmach.report.pictures.camera import Camera
from vmach.report.pictures.display_mesh import sharp_edges
from vmach.report.result import DisplayMesh

__all__ = ["Visible", "rasterise"]

_OVERSAMPLING = 3
#: width of an outline: one pixel, half of it on either side of the edge
_LINE_SAMPLES = _OVERSAMPLING
_EDGE_COLOUR = (0.16, 0.18, 0.20)
#: how far behind the surface a point is still on it, as a share of the picture's height
_SLACK = 0.01
#: what a sample shows that shows no triangle
_NOTHING, _EDGE = -1, -2


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
    return Visible.of(mesh, camera, size).coloured(colours)


@dataclass(frozen=True)
class Visible:
    """What a camera sees of a mesh at every sample, to be coloured in several ways.

    Attributes
    ----------
    triangles : (T, 3) int64
    triangle : (H, W) int32
        The nearest at each sample; `_NOTHING`, or `_EDGE` on an outline.
    share : (H, W, 2) float32
        Of the triangle's second and third corner.
    depth_mm : (H, W) float64
        Of the surface at each sample, larger is nearer; minus infinity where there is none.
    slack_mm : float
        A point so far behind the surface is still on it.
    """

    triangles: np.ndarray
    triangle: np.ndarray
    share: np.ndarray
    depth_mm: np.ndarray
    slack_mm: float

    @classmethod
    def of(cls, mesh: DisplayMesh, camera: Camera, size: tuple[int, int]) -> Visible:
        """Look at a mesh; `size` is the width and height of the pictures in pixels."""
        width, height = (_OVERSAMPLING * side for side in size)
        seen = camera.pixels(mesh.vertices_mm, (width, height))
        triangles = np.ascontiguousarray(mesh.triangles, dtype=np.int64)
        triangle = np.full((height, width), _NOTHING, dtype=np.int32)
        share = np.zeros((height, width, 2), dtype=np.float32)
        depth = np.full((height, width), -np.inf)
        run_in_parts(
            lambda top, bottom: _fill_triangles(
                seen, triangles, (top, bottom), triangle, share, depth
            ),
            height,
        )
        bias_mm = 2e-3 * camera.height_mm
        _draw_lines(seen[sharp_edges(mesh)], triangle, depth, bias_mm, _LINE_SAMPLES)
        return cls(triangles, triangle, share, depth, slack_mm=_SLACK * camera.height_mm)

    def shows(self, pixels: np.ndarray) -> np.ndarray:
        """Whether nothing hides points, (N,) bool; `pixels` (N, 3) are those of `Camera.pixels`.

        A pixel's neighbours count as well: a steep wall is seen as a narrow strip.
        """
        height, width = self.depth_mm.shape
        middles = np.floor(_OVERSAMPLING * pixels[:, 1::-1]).astype(np.int64)
        reach = np.arange(-_OVERSAMPLING, _OVERSAMPLING + 1)
        rows = np.clip(middles[:, :1] + reach, 0, height - 1)
        columns = np.clip(middles[:, 1:] + reach, 0, width - 1)
        around = self.depth_mm[rows[:, :, None], columns[:, None, :]]
        return around.min(axis=(1, 2)) <= pixels[:, 2] + self.slack_mm

    def coloured(self, colours: np.ndarray) -> np.ndarray:
        """The picture with these colours (V, 3) of the vertices, (height, width, 4) uint8."""
        height, width = (side // _OVERSAMPLING for side in self.triangle.shape)
        picture = np.empty((height, width, 4), dtype=np.uint8)
        colours = np.ascontiguousarray(colours, dtype=np.float64)
        run_in_parts(
            lambda top, bottom: _fill_picture(
                (self.triangle, self.share), self.triangles, colours, (top, bottom), picture
            ),
            height,
            least=16,
        )
        return picture


@njit(cache=True, nogil=True)
def _fill_triangles(seen, triangles, rows, triangle, share, depth):
    width = depth.shape[1]
    for i in range(len(triangles)):
        a, b, c = seen[triangles[i, 0]], seen[triangles[i, 1]], seen[triangles[i, 2]]
        top = max(int(np.ceil(min(a[1], b[1], c[1]) - 0.5)), rows[0])
        bottom = min(int(np.floor(max(a[1], b[1], c[1]) - 0.5)), rows[1] - 1)
        twice_area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        if top > bottom or twice_area == 0:
            continue
        left = max(int(np.ceil(min(a[0], b[0], c[0]) - 0.5)), 0)
        right = min(int(np.floor(max(a[0], b[0], c[0]) - 0.5)), width - 1)
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
                    triangle[row, column] = i
                    share[row, column, 0], share[row, column, 1] = v, w


@njit(cache=True, nogil=True)
def _fill_picture(seen, triangles, colours, rows, picture):
    """Mean of the samples of every pixel; colour of the covered ones, their share as alpha."""
    triangle, share = seen
    for row in range(rows[0], rows[1]):
        for column in range(picture.shape[1]):
            red, green, blue, covered = 0.0, 0.0, 0.0, 0
            for y in range(row * _OVERSAMPLING, (row + 1) * _OVERSAMPLING):
                for x in range(column * _OVERSAMPLING, (column + 1) * _OVERSAMPLING):
                    i = triangle[y, x]
                    if i == _NOTHING:
                        continue
                    covered += 1
                    if i == _EDGE:
                        red += _EDGE_COLOUR[0]
                        green += _EDGE_COLOUR[1]
                        blue += _EDGE_COLOUR[2]
                        continue
                    v, w = share[y, x, 0], share[y, x, 1]
                    a, b, c = triangles[i, 0], triangles[i, 1], triangles[i, 2]
                    u = 1.0 - v - w
                    red += u * colours[a, 0] + v * colours[b, 0] + w * colours[c, 0]
                    green += u * colours[a, 1] + v * colours[b, 1] + w * colours[c, 1]
                    blue += u * colours[a, 2] + v * colours[b, 2] + w * colours[c, 2]
            scale = 255.0 / max(covered, 1)
            picture[row, column, 0] = np.rint(scale * red)
            picture[row, column, 1] = np.rint(scale * green)
            picture[row, column, 2] = np.rint(scale * blue)
            picture[row, column, 3] = np.rint(255.0 * covered / _OVERSAMPLING**2)


@njit(cache=True)
def _draw_lines(lines, triangle, depth, bias_mm, width_samples):
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
                    if point[2] >= depth[row, column] - bias_mm:
                        triangle[row, column] = _EDGE
