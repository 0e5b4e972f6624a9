"""Which solids a STEP file holds, and where its assembly structure places them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from vmach.errors import InputError
from vmach.nominal.frame import Frame
from vmach.nominal.step_file import StepEntity, StepFile
from vmach.nominal.step_geometry import GeometryReader
from vmach.nominal.step_solids import Solid, SolidReader
from vmach.nominal.step_units import angle_unit_rad, length_unit_mm

__all__ = ["read_solids"]

_SOLIDS = ("MANIFOLD_SOLID_BREP", "BREP_WITH_VOIDS", "SHELL_BASED_SURFACE_MODEL")
_WORLD = Frame(np.zeros(3), np.eye(3))


def read_solids(step: StepFile) -> list[Solid]:
    """All solids of the file in the workpiece frame, mm.

    Raises
    ------
    InputError
        The file has no solid, or one that cannot be read.
    """
    found = _Assembly(step)
    solids = [
        SolidReader(step, geometry).read(entity)
        for root in found.roots()
        for entity, geometry in found.solids(root, _WORLD)
    ]
    if not solids:
        raise InputError(
            "no solid in the STEP file",
            file=step.path,
            accepted=", ".join(_SOLIDS),
            hint="export the body as a solid (AP203, AP214 or AP242), not as wires or a mesh",
        )
    return solids


class _Assembly:
    """Representations (lists of items in one context of units) and how they are related."""

    def __init__(self, step: StepFile) -> None:
        self._step = step
        self._representations = {
            entity.number: entity
            for kind in (
                "SHAPE_REPRESENTATION",
                "ADVANCED_BREP_SHAPE_REPRESENTATION",
                "MANIFOLD_SURFACE_SHAPE_REPRESENTATION",
                "FACETED_BREP_SHAPE_REPRESENTATION",
            )
            for entity in step.of_type(kind)
        }
        self._children: dict[int, list[tuple[int, StepEntity | None]]] = {}
        self._placed: set[int] = set()
        for entity in step.of_type("REPRESENTATION_RELATIONSHIP"):
            self._relate(entity, entity.parts["REPRESENTATION_RELATIONSHIP"])
        for entity in step.of_type("SHAPE_REPRESENTATION_RELATIONSHIP"):
            if len(entity.parts) == 1:
                self._relate(entity, entity.arguments)

    def _relate(self, entity: StepEntity, arguments: list) -> None:
        """Note who is placed in whom: rep_1 in rep_2 if transformed, else the shape in the name."""
        one, other = (int(reference) for reference in arguments[2:4])
        operator = None
        if entity.is_a("REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION"):
            part = entity.parts["REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION"]
            operator = self._step.entity(part[0])
        elif self._has_solid(one) and not self._has_solid(other):
            one, other = other, one
        parent, child = (other, one) if operator is not None else (one, other)
        self._children.setdefault(parent, []).append((child, operator))
        self._placed.add(child)

    def _items(self, number: int) -> list[StepEntity]:
        return [self._step.entity(item) for item in self._step.entity(number).arguments[1]]

    def _has_solid(self, number: int) -> bool:
        return any(item.kind in _SOLIDS for item in self._items(number))

    def roots(self) -> list[int]:
        """Representations that no other one contains."""
        mapped = {
            int(self._step.entity(entity.arguments[1]).arguments[1])
            for entity in self._step.of_type("MAPPED_ITEM")
        }
        return [n for n in self._representations if n not in self._placed | mapped]

    def solids(
        self, number: int, placement: Frame, depth: int = 0
    ) -> Iterator[tuple[StepEntity, GeometryReader]]:
        """Solids of a representation and of all that it contains, each with its geometry."""
        if depth > 50:
            raise self._step.error(self._step.entity(number), "an assembly that contains itself")
        geometry = self._geometry(number, placement)
        for item in self._items(number):
            if any(item.is_a(kind) for kind in _SOLIDS):
                yield item, geometry
            elif item.is_a("MAPPED_ITEM"):
                _, source, target = item.arguments
                origin, inner, *_ = self._step.entity(source).arguments
                inside = self._between(int(inner), origin, number, target)
                yield from self.solids(int(inner), inside.after(placement), depth + 1)
        for child, operator in self._children.get(number, ()):
            inside = placement
            if operator is not None:
                _, _, origin, target, *_ = operator.arguments
                inside = self._between(child, origin, number, target).after(placement)
            yield from self.solids(child, inside, depth + 1)

    def _between(self, child: int, origin: int, parent: int, target: int) -> Frame:
        """Where the child's world frame lies in the parent when `origin` is put on `target`."""
        inner = self._geometry(child, _WORLD).frame(origin)
        outer = self._geometry(parent, _WORLD).frame(target)
        axes = inner.axes.T @ outer.axes
        return Frame(outer.origin - inner.origin @ axes, axes)

    def _geometry(self, number: int, placement: Frame) -> GeometryReader:
        context = self._step.entity(self._step.entity(number).arguments[2])
        length_mm = length_unit_mm(self._step, context)
        angle_rad = angle_unit_rad(self._step, context)
        return GeometryReader(self._step, length_mm, angle_rad, placement)
