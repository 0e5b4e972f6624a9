"""Which bodies a STEP file holds, and where its assembly structure places them.

Source: ISO 10303-44 (product structure), ISO 10303-43 (representations and their
transformations).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from vmach.errors import InputError
from vmach.nominal.frame import Frame
from vmach.nominal.step.exchange_file import Reference, StepEntity, StepFile
from vmach.nominal.step.geometry import GeometryReader
from vmach.nominal.step.length_unit import angle_unit_rad, length_unit_mm

__all__ = ["SOLIDS", "SURFACE_MODELS", "placed_bodies"]

SOLIDS = ("MANIFOLD_SOLID_BREP", "BREP_WITH_VOIDS")
SURFACE_MODELS = ("SHELL_BASED_SURFACE_MODEL",)
_REPRESENTATIONS = (
    "SHAPE_REPRESENTATION",
    "ADVANCED_BREP_SHAPE_REPRESENTATION",
    "MANIFOLD_SURFACE_SHAPE_REPRESENTATION",
)

#: an assembly in an assembly ... more often than this is taken for a circle
_DEEPEST = 50

#: an assembly of more parts than this is refused before it fills the memory
_MOST_PARTS = 100_000

_WORLD = Frame(np.zeros(3), np.eye(3))


def placed_bodies(step: StepFile) -> list[tuple[StepEntity, GeometryReader]]:
    """Solids and surface models of the file, each with its geometry in the workpiece frame.

    A body that several representations list, as exporters do to say its volume or its colour, is
    returned once for each place that the assembly gives it.

    Raises
    ------
    InputError
        Representations that are damaged, or that contain themselves.
    """
    try:
        assembly = _Assembly(step)
        found = [
            (root, *body) for root in assembly.roots() for body in assembly.bodies(root, _WORLD)
        ]
    except (TypeError, ValueError, IndexError, KeyError, RecursionError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(
            f"the structure of the STEP file is damaged ({error})",
            file=step.path,
            hint="export it again",
        ) from None
    # a root that places nothing and lists what is placed elsewhere only says something about it
    owner = {body.number: root for root, body, _ in found if assembly.is_assembly(root)}
    for root, entity, _ in found:
        owner.setdefault(entity.number, root)
    return [
        (entity, geometry)
        for root, entity, geometry in found
        if owner[entity.number] is root or assembly.is_assembly(root)
    ]


class _Assembly:
    """Representations (lists of items in one context of units) and how they are related.

    A plain relationship says that two representations are the same thing in the same place; one
    with a transformation puts the first into the second.
    """

    def __init__(self, step: StepFile) -> None:
        self._step = step
        self._same: dict[int, set[int]] = {}
        self._parts: dict[int, list[tuple[int, StepEntity]]] = {}
        self._placed: set[int] = set()
        self._visits = 0
        for entity in step.of_type("REPRESENTATION_RELATIONSHIP"):
            self._relate(entity, entity.parts["REPRESENTATION_RELATIONSHIP"])
        for entity in step.of_type("SHAPE_REPRESENTATION_RELATIONSHIP"):
            if len(entity.parts) == 1:
                self._relate(entity, entity.arguments)
        self._shapes = [
            e.number
            for kind in _REPRESENTATIONS
            for e in step.of_type(kind)
            if not e.is_a("DRAUGHTING_MODEL")  # a view, which shows the part once more
        ]
        # mapped items in other representations are views and notes, not parts
        for number in self._shapes:
            for item in self._items(number):
                if item.is_a("MAPPED_ITEM"):
                    self._placed.add(int(step.entity(item.arguments[1]).arguments[1]))

    def _arguments(self, number: int) -> list:
        """Name, items and context of a representation."""
        entity = self._step.entity(number)
        arguments = entity.parts.get("REPRESENTATION", entity.arguments)
        if len(arguments) < 3 or not isinstance(arguments[1], list):
            raise self._step.error(entity, "no representation", "a name, items and a context")
        return arguments

    def _items(self, number: int) -> list[StepEntity]:
        items = self._arguments(number)[1]
        return [self._step.entity(item) for item in items if isinstance(item, Reference)]

    def _relate(self, entity: StepEntity, arguments: list) -> None:
        one, other = (int(reference) for reference in arguments[2:4])
        placing = entity.parts.get("REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION")
        if placing is None:
            self._same.setdefault(one, {one}).add(other)
            self._same.setdefault(other, {other}).add(one)
        else:
            self._parts.setdefault(other, []).append((one, self._step.entity(placing[0])))
            self._placed.add(one)

    def _group(self, number: int) -> frozenset[int]:
        """All representations that are the same thing as this one."""
        group, waiting = {number}, [number]
        while waiting:
            new = self._same.get(waiting.pop(), set()) - group
            group |= new
            waiting += new
        return frozenset(group)

    def roots(self) -> list[frozenset[int]]:
        """Groups of representations that no other one contains."""
        groups = dict.fromkeys(self._group(number) for number in sorted(self._shapes))
        return [group for group in groups if not group & self._placed]

    def is_assembly(self, group: frozenset[int]) -> bool:
        """Whether a group places others."""
        return any(number in self._parts for number in group) or any(
            item.is_a("MAPPED_ITEM") for number in group for item in self._items(number)
        )

    def bodies(
        self, group: frozenset[int], placement: Frame, depth: int = 0
    ) -> Iterator[tuple[StepEntity, GeometryReader]]:
        """Bodies of a group and of all that it contains, each with its geometry."""
        self._visits += 1
        if depth > _DEEPEST:
            what = f"an assembly contains itself, at {depth} levels"
            raise InputError(what, file=self._step.path)
        if self._visits > _MOST_PARTS:
            raise InputError(
                f"{self._visits} or more parts in the assembly",
                file=self._step.path,
                accepted=f"at most {_MOST_PARTS}",
            )
        seen: set[int] = set()
        for number in sorted(group):
            geometry = self._geometry(number, placement)
            for item in self._items(number):
                if any(item.is_a(kind) for kind in SOLIDS + SURFACE_MODELS):
                    if item.number not in seen:
                        seen.add(item.number)
                        yield item, geometry
                elif item.is_a("MAPPED_ITEM"):
                    _, source, target = item.arguments
                    origin, child, *_ = self._step.entity(source).arguments
                    inside = self._between(child, origin, number, target).after(placement)
                    yield from self.bodies(self._group(int(child)), inside, depth + 1)
            for child, operator in self._parts.get(number, ()):
                _, _, origin, target, *_ = operator.arguments
                inside = self._between(child, origin, number, target).after(placement)
                yield from self.bodies(self._group(child), inside, depth + 1)

    def _between(self, child: int, origin: int, parent: int, target: int) -> Frame:
        """Where the child's world frame lies in the parent when `origin` is put on `target`."""
        inner = self._geometry(child, _WORLD).frame(origin)
        outer = self._geometry(parent, _WORLD).frame(target)
        axes = inner.axes.T @ outer.axes
        return Frame(outer.origin - inner.origin @ axes, axes)

    def _geometry(self, number: int, placement: Frame) -> GeometryReader:
        context = self._step.entity(self._arguments(number)[2])
        length_mm = length_unit_mm(self._step, context)
        angle_rad = angle_unit_rad(self._step, context)
        return GeometryReader(self._step, length_mm, angle_rad, placement)
