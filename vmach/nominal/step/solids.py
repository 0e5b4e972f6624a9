"""Solids of a STEP file: shells, their faces and the edges that these share.

Source: ISO 10303-42 (topology: shells, faces, loops, edges).
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np

from vmach.errors import InputError
from vmach.nominal.step.exchange_file import StepEntity, StepFile
from vmach.nominal.step.geometry import GeometryReader
from vmach.nominal.surfaces import Surface
from vmach.nominal.surfaces.curves import Curve, Line, polyline

__all__ = [
    "CHORD_MM",
    "GAP_MM",
    "Edge",
    "OpenShellError",
    "Solid",
    "SolidFace",
    "SolidReader",
    "is_straight",
]

#: chords of edges, and of the triangles to look at, leave the exact shape by no more than this
CHORD_MM = 0.01

#: a vertex may be this far from the curve of its edge, an edge from the surface of its face, before
#: the file is refused
GAP_MM = 0.1

#: straight edges on other surfaces than the following are cut into so many pieces
LINE_PIECES = 16

#: straight edges are straight in u and v on these
_RULED = ("plane", "cylinder", "cone")


class OpenShellError(InputError):
    """Shells that do not enclose a volume."""


@dataclass(frozen=True)
class Edge:
    """A piece of a curve between two vertices, as parameters t (N,) and points (N, 3) mm."""

    curve: Curve
    t: np.ndarray
    points_mm: np.ndarray

    def split(self, places: list[tuple[int, float]]) -> Edge:
        """The same edge with more points: in order, the segments and shares of them in t."""
        segments = np.array([segment for segment, _ in places])
        share = np.array([share for _, share in places])
        t = self.t[segments] + share * (self.t[segments + 1] - self.t[segments])
        points = self.curve.evaluate(t)
        return Edge(
            self.curve,
            np.insert(self.t, segments + 1, t),
            np.insert(self.points_mm, segments + 1, points, axis=0),
        )


@dataclass(frozen=True)
class SolidFace:
    """A face as the file has it.

    Attributes
    ----------
    surface : Surface
    outward : float
        +1 where dS/du x dS/dv points out of the material, -1 where it points in.
    edges : tuple of (int, bool)
        Keys of the solid's edges, and whether the points of the edge have the face on their
        left seen from the tip of dS/du x dS/dv. Seams are left out.
    number : int
        Of the face in the file.
    name : str
        That the file gives it; may be empty.
    """

    surface: Surface
    outward: float
    edges: tuple[tuple[int, bool], ...]
    number: int = 0
    name: str = ""

    def turned(self) -> SolidFace:
        """The face on the other side of its edges, facing the other way along the normal."""
        edges = tuple((number, not left) for number, left in self.edges)
        return SolidFace(self.surface, -self.outward, edges, self.number, self.name)


@dataclass(frozen=True)
class Solid:
    """Faces of one solid and the edges they refer to.

    Attributes
    ----------
    faces : tuple of SolidFace
    edges : dict of int to Edge
    gap_mm : float
        Largest distance of a vertex from the curve of its edge.
    touching_edges : int
        Edges along which the solid touches itself: four faces or more meet there.
    """

    faces: tuple[SolidFace, ...]
    edges: dict[int, Edge]
    gap_mm: float
    touching_edges: int = 0


class SolidReader:
    """Reads one solid whose geometry is in one context of units and one placement."""

    def __init__(self, step: StepFile, geometry: GeometryReader) -> None:
        self._step, self._geometry = step, geometry
        self._edges: dict[int, Edge] = {}
        self._sides: Counter[tuple[int, bool]] = Counter()
        self._bounds: set[frozenset[tuple[int, bool]]] = set()
        self._gap_mm = 0.0

    def read(self, entity: StepEntity) -> Solid:
        """Solid from a MANIFOLD_SOLID_BREP, BREP_WITH_VOIDS or SHELL_BASED_SURFACE_MODEL.

        Raises
        ------
        InputError
            Geometry that is not supported, or damaged references.
        OpenShellError
            An edge that does not bound as many faces in one direction as in the other.
        """
        try:
            faces = [f for shell in _shells(entity) for f in self._shell(self._step.entity(shell))]
        except RecursionError:
            raise self._step.error(entity, "the solid is damaged: it refers to itself") from None
        except (TypeError, ValueError, IndexError, KeyError) as error:
            if isinstance(error, InputError):
                raise
            raise self._step.error(entity, f"the solid is damaged ({error})") from None
        if not faces:
            raise self._step.error(entity, "a solid without faces")
        self._check_closed(entity)
        touching = sum(times > 1 for (_, forward), times in self._sides.items() if forward)
        return Solid(tuple(faces), self._edges, self._gap_mm, touching)

    def _shell(self, shell: StepEntity, inverted: bool = False) -> list[SolidFace]:
        if shell.is_a("ORIENTED_CLOSED_SHELL"):
            *_, inner, same = shell.arguments
            return self._shell(self._step.entity(inner), inverted ^ (not same))
        if not (shell.is_a("CLOSED_SHELL") or shell.is_a("OPEN_SHELL")):
            raise self._step.error(shell, "not a shell", "CLOSED_SHELL")
        return [self._face(self._step.entity(face), inverted) for face in shell.arguments[1]]

    def _face(self, face: StepEntity, inverted: bool) -> SolidFace:
        if face.is_a("ORIENTED_FACE"):
            *_, inner, same = face.arguments
            return self._face(self._step.entity(inner), inverted ^ (not same))
        if not (face.is_a("ADVANCED_FACE") or face.is_a("FACE_SURFACE")):
            raise self._step.error(face, "this kind of face is not supported", "ADVANCED_FACE")
        name, bounds, surface_number, same_sense = face.arguments
        surface = self._geometry.surface(surface_number)
        sides = [side for bound in bounds for side in self._bound(self._step.entity(bound))]
        bounds_seen = frozenset((edge, forward ^ inverted) for edge, forward in sides)
        if bounds_seen and bounds_seen in self._bounds:
            raise self._step.error(face, "another face of the solid has the same edges")
        self._bounds.add(bounds_seen)
        self._sides.update((edge, forward ^ inverted) for edge, forward in sides)
        times = Counter(edge for edge, _ in sides)
        kept = [(edge, forward == same_sense) for edge, forward in sides if times[edge] == 1]
        self._divide_lines(surface, [edge for edge, _ in kept])
        outward = 1.0 if same_sense ^ inverted else -1.0
        return SolidFace(surface, outward, tuple(kept), face.number, _own_name(name))

    def _bound(self, bound: StepEntity) -> list[tuple[int, bool]]:
        """Edges of a loop, and whether each runs with the face on its left, from outside."""
        _, loop_number, same = bound.arguments
        loop = self._step.entity(loop_number)
        if loop.is_a("VERTEX_LOOP"):
            return []
        if not loop.is_a("EDGE_LOOP"):
            raise self._step.error(loop, "this kind of loop is not supported", "EDGE_LOOP")
        sides = []
        for reference in loop.arguments[1]:
            *_, edge, forward = self._step.entity(reference).arguments
            self._read_edge(self._step.entity(edge))
            sides.append((int(edge), forward == same))
        return sides

    def _read_edge(self, entity: StepEntity) -> None:
        if entity.number in self._edges:
            return
        if not entity.is_a("EDGE_CURVE"):
            raise self._step.error(entity, "this kind of edge is not supported", "EDGE_CURVE")
        _, start, end, curve_number, same_sense = entity.arguments
        curve = self._geometry.curve(curve_number)
        ends = self._geometry.points([start, end])
        t = curve.parameter(ends)
        gap = float(np.linalg.norm(curve.evaluate(t) - ends, axis=1).max())
        if gap > GAP_MM:
            raise self._step.error(
                entity, f"a vertex is {gap:.3g} mm from the curve", f"at most {GAP_MM} mm"
            )
        self._gap_mm = max(self._gap_mm, gap)
        if curve.period:
            closed = start == end or np.linalg.norm(ends[1] - ends[0]) < 1e-9
            turn = curve.period if same_sense else -curve.period
            t[1] = t[0] + (turn if closed else np.mod(t[1] - t[0], turn))
        t, points = polyline(curve, t[0], t[1], CHORD_MM)
        points[0], points[-1] = ends
        self._edges[entity.number] = Edge(curve, t, points)

    def _divide_lines(self, surface: Surface, numbers: list[int]) -> None:
        for number in numbers:
            edge = self._edges[number]
            is_bent = isinstance(edge.curve, Line) and not is_straight(edge.curve, surface)
            if is_bent and len(edge.t) == 2:
                t = np.linspace(*edge.t, LINE_PIECES + 1)
                points = edge.curve.evaluate(t)
                points[0], points[-1] = edge.points_mm
                self._edges[number] = Edge(edge.curve, t, points)

    def _check_closed(self, entity: StepEntity) -> None:
        """Every edge has to bound as many faces in one direction as in the other."""
        numbers = {number for number, _ in self._sides}
        bad = [n for n in numbers if self._sides[n, True] != self._sides[n, False]]
        if bad:
            first = self._step.entity(min(bad))
            middle = self._edges[min(bad)].points_mm.mean(axis=0)
            raise OpenShellError(
                f"the solid #{entity.number} is open: {len(bad)} of {len(numbers)} edges do not "
                f"join two faces, the first is #{first.number} near "
                f"({middle[0]:.3f}, {middle[1]:.3f}, {middle[2]:.3f})",
                file=self._step.path,
                line=self._step.line(first.number),
                accepted="a closed solid",
                hint="sew the faces to a solid in the CAD system and export again",
            )


def is_straight(curve: Curve, surface: Surface) -> bool:
    """Whether a curve on a surface is straight in u and v."""
    return isinstance(curve, Line) and surface.kind in _RULED


def _own_name(name: object) -> str:
    """A name that says something; exporters write NONE, or the same for all."""
    text = name.strip() if isinstance(name, str) else ""
    return "" if text.upper() in ("NONE", "FACE", "ADVANCED_FACE") else text


def _shells(entity: StepEntity) -> list[int]:
    """References of the shells of a solid or of a surface model."""
    if len(entity.parts) > 1:
        named = {"MANIFOLD_SOLID_BREP", "BREP_WITH_VOIDS", "SHELL_BASED_SURFACE_MODEL"}
        values = [v for name in entity.parts if name in named for v in entity.parts[name]]
    else:
        values = entity.arguments[1:]
    return [n for value in values for n in (value if isinstance(value, list) else [value])]
