"""Level strokes of flat tools at one height, merged in the plane before they become a solid.

Where flat end mills clear a floor, thousands of strokes share one plane. Their outlines are
united in two dimensions, which is fast and leaves one clean floor, and raised to a prism.

Source: closed form derived here: a disc along a straight line sweeps a stadium.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from manifold3d import CrossSection, Manifold, Mesh64, OpType
from numba import njit

from stock.solid.ring_stack import RingStack
from stock.solid.strokes import Strokes
from stock.solid.swept_hull import swept_points

__all__ = ["LEVEL_MM", "level_groups", "level_solid"]

#: heights that differ by less are one height, mm
LEVEL_MM = 1e-4
#: fewer strokes at one height are not worth a merge in the plane
_SMALLEST_GROUP = 4


def level_groups(
    strokes: Strokes, stacks: Sequence[RingStack], index: np.ndarray
) -> Iterator[np.ndarray]:
    """Groups of strokes, taken from `index`, that share a flat tool and a height.

    Yields
    ------
    (G,) int64
        Strokes in cutting order that keep level, upright and at one height to `LEVEL_MM`.
    """
    flat = np.array([_is_flat(stack) for stack in stacks], dtype=bool)
    reach = np.array([np.hypot(*stack.rings[-1, :2]) for stack in stacks])
    s = strokes
    lean = np.maximum(np.abs(s.start_tilt_rad), np.abs(s.end_tilt_rad)).max(axis=1)
    level = (
        flat[s.tool]
        & (np.abs(s.end_mm[:, 2] - s.start_mm[:, 2]) <= LEVEL_MM / 2)
        & (2 * lean * reach[s.tool] <= LEVEL_MM)
    )
    index = index[level[index]]
    height = s.start_mm[index, 2]
    order = np.lexsort((height, s.tool[index]))
    index, height = index[order], height[order]
    begin = 0
    for i in range(1, len(index) + 1):
        if (
            i == len(index)
            or s.tool[index[i]] != s.tool[index[begin]]
            or height[i] - height[begin] > LEVEL_MM / 2
        ):
            if i - begin >= _SMALLEST_GROUP:
                yield np.sort(index[begin:i])
            begin = i


def _is_flat(stack: RingStack) -> bool:
    return len(stack.rings) == 2 and stack.rings[0, 0] == stack.rings[1, 0]


def level_solid(
    strokes: Strokes, stack: RingStack, group: np.ndarray, *, top_mm: float
) -> tuple[Manifold, dict[int, int]]:
    """The prism that a group, (G,), of level strokes removes, up to `top_mm`.

    Returns
    -------
    solid : Manifold
    move_of_id : dict of int to int
        The move of each mesh identity in the solid. A wall belongs to the stroke whose side it
        is, a piece of floor to the stroke that passes nearest.
    """
    radius = stack.rings[0, 0]
    ring = np.array([[radius, 0.0, np.pi / 2, np.pi / 2]])
    outline = _outline([_plane_points(strokes, i, ring, stack.azimuths[:1]) for i in group])
    bottom_mm = float(strokes.start_mm[group[0], 2])
    prism = Manifold.extrude(outline, top_mm - bottom_mm).translate((0.0, 0.0, bottom_mm))
    mesh = prism.to_mesh64()
    vertices = np.array(mesh.vert_properties, order="C")  # the library wants it writable
    triangles = np.asarray(mesh.tri_verts)
    corners = vertices[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    wall = np.abs(normals[:, 2]) < 0.5 * np.linalg.norm(normals, axis=1)
    stroke = _nearest(
        corners.mean(axis=1)[:, :2],
        np.where(wall, radius, 0.0),
        strokes.start_mm[group, :2],
        strokes.end_mm[group, :2],
    )
    return _marked(vertices, triangles, strokes.move[group][stroke])


def _plane_points(strokes: Strokes, i: int, ring: np.ndarray, azimuths: np.ndarray) -> CrossSection:
    placement = np.zeros((4, 3))
    placement[0, :2], placement[1, :2] = strokes.start_mm[i, :2], strokes.end_mm[i, :2]
    points = swept_points(ring, azimuths, placement, strokes.before(i), strokes.ends(i))
    return CrossSection.hull_points(np.ascontiguousarray(points[:, :2]))


def _outline(sections: list[CrossSection]) -> CrossSection:
    """Union over a tree: all at once would meet every crossing of all outlines."""
    if len(sections) <= 16:
        return CrossSection.batch_boolean(sections, OpType.Add)
    half = len(sections) // 2
    return _outline(sections[:half]) + _outline(sections[half:])


def _marked(
    vertices: np.ndarray, triangles: np.ndarray, move: np.ndarray
) -> tuple[Manifold, dict[int, int]]:
    """A solid whose triangles carry one mesh identity a move."""
    order = np.argsort(move, kind="stable")
    moves, first = np.unique(move[order], return_index=True)
    identity = Manifold.reserve_ids(len(moves)) + np.arange(len(moves))
    solid = Manifold(
        Mesh64(
            vertices,
            triangles[order].astype(np.uint64),
            run_index=(3 * np.append(first, len(move))).astype(np.uint64),
            run_original_id=identity.astype(np.uint32),
        )
    )
    return solid, dict(zip(identity.tolist(), moves.tolist(), strict=True))


@njit(cache=True)
def _nearest(
    points: np.ndarray, distance: np.ndarray, start: np.ndarray, end: np.ndarray
) -> np.ndarray:
    """For each point the segment whose distance from it is closest to the one asked for."""
    best = np.zeros(len(points), dtype=np.int64)
    for i in range(len(points)):
        least = np.inf
        for j in range(len(start)):
            along_x, along_y = end[j, 0] - start[j, 0], end[j, 1] - start[j, 1]
            arm_x, arm_y = points[i, 0] - start[j, 0], points[i, 1] - start[j, 1]
            length2 = along_x**2 + along_y**2
            share = 0.0
            if length2 > 0.0:
                share = min(max((arm_x * along_x + arm_y * along_y) / length2, 0.0), 1.0)
            off = np.hypot(arm_x - share * along_x, arm_y - share * along_y)
            if abs(off - distance[i]) < least:
                least = abs(off - distance[i])
                best[i] = j
    return best
