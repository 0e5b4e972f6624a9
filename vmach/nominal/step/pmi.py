"""Tolerances, sizes and datums that a STEP file says of its faces (AP242 semantic PMI).

Source: ISO 10303-242; ISO 10303-47 (shape tolerances: geometric and dimensional tolerances, datum
systems); ISO 10303-41 (shape aspects); recommended practices for PMI of the CAx-IF.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field

from vmach.errors import InputError
from vmach.nominal.step.exchange_file import Reference, StepEntity, StepFile
from vmach.nominal.step.length_unit import unit_in_si

__all__ = ["CHARACTERISTICS", "PmiDatum", "PmiDimension", "PmiTolerance", "StepPmi", "read_pmi"]

#: characteristic by the entity type of a geometric tolerance
CHARACTERISTICS = {
    "STRAIGHTNESS_TOLERANCE": "straightness",
    "FLATNESS_TOLERANCE": "flatness",
    "ROUNDNESS_TOLERANCE": "roundness",
    "CYLINDRICITY_TOLERANCE": "cylindricity",
    "LINE_PROFILE_TOLERANCE": "profile of line",
    "SURFACE_PROFILE_TOLERANCE": "profile",
    "PARALLELISM_TOLERANCE": "parallelism",
    "PERPENDICULARITY_TOLERANCE": "perpendicularity",
    "ANGULARITY_TOLERANCE": "angularity",
    "POSITION_TOLERANCE": "position",
    "COAXIALITY_TOLERANCE": "coaxiality",
    "CONCENTRICITY_TOLERANCE": "coaxiality",
    "SYMMETRY_TOLERANCE": "symmetry",
    "CIRCULAR_RUNOUT_TOLERANCE": "circular runout",
    "TOTAL_RUNOUT_TOLERANCE": "total runout",
}
_SIZES = ("DIMENSIONAL_SIZE", "DIMENSIONAL_SIZE_WITH_PATH", "DIMENSIONAL_SIZE_WITH_DATUM_FEATURE")
_LOCATIONS = ("DIMENSIONAL_LOCATION", "DIMENSIONAL_LOCATION_WITH_PATH",
              "DIRECTED_DIMENSIONAL_LOCATION")  # fmt: skip
_ANGLES = ("ANGULAR_SIZE", "ANGULAR_LOCATION")
#: shape aspects may be grouped this deep
_DEEPEST = 10


@dataclass(frozen=True)
class PmiDatum:
    """A datum letter and the STEP numbers of its faces; `targets` counts datum targets."""

    letter: str
    faces: tuple[int, ...]
    targets: int = 0


@dataclass(frozen=True)
class PmiTolerance:
    """A geometric tolerance.

    Attributes
    ----------
    number, name : int, str
        Of the entity.
    characteristic : str
    value_mm : float
    zone : str
        Empty, ``Ø`` or ``SØ``.
    datums : tuple of str
        Letters; common datums as ``A-B``.
    modifiers : tuple of str
        Of the tolerance and its datums, as the file names them.
    faces : tuple of int
        STEP numbers.
    """

    number: int
    name: str
    characteristic: str
    value_mm: float
    zone: str
    datums: tuple[str, ...]
    modifiers: tuple[str, ...]
    faces: tuple[int, ...]


@dataclass(frozen=True)
class PmiDimension:
    """A size, a distance (`kind` ``location``) or an ``angle``; mm or rad.

    Limits are None where the file states none; `fit` is a class such as ``H7``.
    """

    number: int
    name: str
    kind: str
    nominal: float | None
    lower: float | None
    upper: float | None
    fit: str
    faces: tuple[int, ...]
    other_faces: tuple[int, ...] = ()


@dataclass(frozen=True)
class StepPmi:
    """All that a file says; empty where it says nothing."""

    datums: tuple[PmiDatum, ...] = ()
    tolerances: tuple[PmiTolerance, ...] = ()
    dimensions: tuple[PmiDimension, ...] = ()
    names: dict[int, str] = field(default_factory=dict)  #: of faces, by what is said of them

    def __bool__(self) -> bool:
        return bool(self.tolerances or self.dimensions)


def read_pmi(step: StepFile) -> StepPmi:
    """Read the semantic PMI of a file.

    Raises
    ------
    InputError
        A tolerance whose entities are damaged.
    """
    reader = _Reader(step)
    found: list[list] = [[], [], []]
    sources = (reader.datums, reader.tolerances, reader.dimensions)
    for source, into in zip(sources, found, strict=True):
        try:
            into += source()
        except (TypeError, ValueError, IndexError, KeyError, AttributeError,
                RuntimeError) as error:  # fmt: skip
            if isinstance(error, InputError):
                raise
            raise InputError(
                f"the tolerances of the STEP file are damaged ({error})", file=step.path
            ) from None
    datums, tolerances, dimensions = found
    return StepPmi(tuple(datums), tuple(tolerances), tuple(dimensions), reader.face_names())


class _Reader:
    """Looks things up in both directions of the file's references."""

    def __init__(self, step: StepFile) -> None:
        self._step = step
        self._items: dict[int, list[int]] = defaultdict(list)
        for kind in ("GEOMETRIC_ITEM_SPECIFIC_USAGE", "ITEM_IDENTIFIED_REPRESENTATION_USAGE"):
            for usage in step.of_type(kind):
                _, _, aspect, _, items = usage.parts[kind][:5]
                if isinstance(aspect, Reference):
                    self._items[aspect] += _references(items)
        self._parts: dict[int, list[int]] = defaultdict(list)
        self._wholes: dict[int, list[int]] = defaultdict(list)
        for kind in ("SHAPE_ASPECT_RELATIONSHIP", "SHAPE_ASPECT_ASSOCIATIVITY",
                     "SHAPE_ASPECT_DERIVING_RELATIONSHIP",
                     "FEATURE_FOR_DATUM_TARGET_RELATIONSHIP"):  # fmt: skip
            for relation in step.of_type(kind):
                whole, part = relation.parts[kind][2:4]
                self._parts[whole].append(part)
                self._wholes[part].append(whole)

    def faces(self, aspect: int, depth: int = 0) -> list[int]:
        """STEP numbers of the faces that a shape aspect and its parts mean."""
        found = [n for n in self._items.get(aspect, ()) if self._is_face(n)]
        if depth < _DEEPEST:
            for part in self._parts.get(aspect, ()):
                if not self._step.entity(part).is_a("DATUM"):
                    found += self.faces(part, depth + 1)
        return list(dict.fromkeys(found))

    def _is_face(self, number: int) -> bool:
        entity = self._step.entity(number)
        return entity.is_a("ADVANCED_FACE") or entity.is_a("FACE_SURFACE")

    def face_names(self) -> dict[int, str]:
        """Names that shape aspects give to single faces."""
        names = {}
        for aspect, items in self._items.items():
            entity = self._step.entity(aspect)
            arguments = entity.parts.get("SHAPE_ASPECT", entity.arguments)
            name = arguments[0] if arguments and isinstance(arguments[0], str) else ""
            if name.strip() and len(items) == 1 and self._is_face(items[0]):
                names.setdefault(items[0], name.strip())
        return names

    # --- datums -----------------------------------------------------------------------------------

    def datums(self) -> Iterator[PmiDatum]:
        for datum in self._step.of_type("DATUM"):
            letter = str(datum.parts["DATUM"][-1]).strip()
            related = [*self._wholes.get(datum.number, ()), *self._parts.get(datum.number, ())]
            kinds = [self._step.entity(n) for n in related]
            targets = sum("DATUM_TARGET" in part for e in kinds for part in e.parts)
            faces = [f for n in related for f in self.faces(n)] or self.faces(datum.number)
            yield PmiDatum(letter, tuple(dict.fromkeys(faces)), targets)

    def _labels(self, systems: object) -> tuple[tuple[str, ...], list[str]]:
        """Letters in their order, and modifiers, of datum systems or older datum references."""
        labels, modifiers, single = [], [], []
        for number in _references(systems):
            entity = self._step.entity(number)
            if entity.is_a("DATUM_SYSTEM"):
                for compartment in _references(entity.parts["DATUM_SYSTEM"][-1]):
                    label, own = self._compartment(self._step.entity(compartment))
                    labels.append(label)
                    modifiers += own
            elif entity.is_a("DATUM_REFERENCE"):
                order, datum = entity.parts["DATUM_REFERENCE"][:2]
                single.append((order, self._letter(datum)))
        labels += [letter for _, letter in sorted(single)]
        return tuple(labels), modifiers

    def _compartment(self, entity: StepEntity) -> tuple[str, list[str]]:
        base, modifiers = next(a for a in entity.parts.values() if len(a) >= 6)[-2:]
        own = [str(m) for m in modifiers or () if isinstance(m, str)]
        if isinstance(base, Reference):
            return self._letter(base), own
        parts = [self._step.entity(n) for n in _references(base)]
        return "-".join(self._compartment(part)[0] for part in parts), own

    def _letter(self, number: int) -> str:
        return str(self._step.entity(number).parts["DATUM"][-1]).strip()

    # --- geometric tolerances ---------------------------------------------------------------------

    def tolerances(self) -> Iterator[PmiTolerance]:
        zones = self._zones()
        for kind, characteristic in CHARACTERISTICS.items():
            for entity in self._step.of_type(kind):
                yield self._tolerance(entity, characteristic, zones.get(entity.number, ""))

    def _zones(self) -> dict[int, str]:
        zones = {}
        for zone in self._step.of_type("TOLERANCE_ZONE"):
            tolerances, form = zone.parts["TOLERANCE_ZONE"][-2:]
            words = str(self._step.entity(form).arguments[0]).lower()
            shape = "SØ" if "spher" in words else "Ø" if "cylind" in words else ""
            zones.update(dict.fromkeys(_references(tolerances), shape))
        return zones

    def _tolerance(self, entity: StepEntity, characteristic: str, zone: str) -> PmiTolerance:
        arguments = entity.parts.get("GEOMETRIC_TOLERANCE", entity.arguments)
        name, _, magnitude, aspect = arguments[:4]
        systems = entity.parts.get("GEOMETRIC_TOLERANCE_WITH_DATUM_REFERENCE", [None])[0]
        if systems is None and len(entity.parts) == 1 and len(arguments) > 4:
            systems = arguments[4]
        datums, modifiers = self._labels(systems)
        own = entity.parts.get("GEOMETRIC_TOLERANCE_WITH_MODIFIERS", [[]])[0]
        modifiers = [str(m) for m in own] + modifiers
        modifiers += [part for part in entity.parts if part.startswith("UNEQUALLY_DISPOSED")]
        return PmiTolerance(
            entity.number, str(name or ""), characteristic, self._measure(magnitude), zone, datums,
            tuple(modifiers), tuple(self.faces(aspect)),
        )  # fmt: skip

    def _measure(self, number: int) -> float:
        """A length in mm or an angle in rad."""
        entity = self._step.entity(number)
        value, unit = (
            entity.parts.get("MEASURE_WITH_UNIT")
            or next(a for a in entity.parts.values() if len(a) >= 2 and isinstance(a[0], tuple))[:2]
        )
        size = unit_in_si(self._step, self._step.entity(unit))
        is_angle = "ANGLE" in value[0]
        return float(value[1][0]) * (size if is_angle else 1e3 * size)

    # --- dimensions -------------------------------------------------------------------------------

    def dimensions(self) -> Iterator[PmiDimension]:
        ranges = {}
        for entity in self._step.of_type("PLUS_MINUS_TOLERANCE"):
            limits, dimension = entity.arguments[:2]
            ranges[int(dimension)] = self._step.entity(limits)
        shown = {}
        for entity in self._step.of_type("DIMENSIONAL_CHARACTERISTIC_REPRESENTATION"):
            shown[int(entity.arguments[0])] = self._values(self._step.entity(entity.arguments[1]))
        for kinds, kind in ((_SIZES, "size"), (_LOCATIONS, "location"), (_ANGLES, "angle")):
            seen: set[int] = set()
            for name in kinds:
                for entity in self._step.of_type(name):
                    if entity.number not in seen:
                        seen.add(entity.number)
                        values = shown.get(entity.number, {})
                        yield self._dimension(entity, kind, values, ranges.get(entity.number))

    def _values(self, representation: StepEntity) -> dict[str, float]:
        arguments = representation.parts.get("REPRESENTATION", representation.arguments)
        found: dict[str, float] = {}
        for number in _references(arguments[1]):
            item = self._step.entity(number)
            if item.is_a("MEASURE_REPRESENTATION_ITEM") or item.is_a("MEASURE_WITH_UNIT"):
                label = item.parts.get("REPRESENTATION_ITEM", item.arguments[:1] or [""])
                word = str(label[0] if label else "").lower()
                key = next((k for k in ("upper", "lower") if k in word), "nominal")
                found[key] = self._item_measure(item)
        return found

    def _item_measure(self, item: StepEntity) -> float:
        if item.is_a("MEASURE_WITH_UNIT"):
            return self._measure(item.number)
        _, value, unit = item.parts["MEASURE_REPRESENTATION_ITEM"][:3]
        size = unit_in_si(self._step, self._step.entity(unit))
        return float(value[1][0]) * (size if "ANGLE" in value[0] else 1e3 * size)

    def _dimension(
        self, entity: StepEntity, kind: str, values: dict[str, float], limits: StepEntity | None
    ) -> PmiDimension:
        lower, upper, fit = values.get("lower"), values.get("upper"), ""
        nominal = values.get("nominal")
        if limits is not None and limits.is_a("LIMITS_AND_FITS"):
            form, zone, grade = (str(a or "") for a in limits.arguments[:3])
            fit = next((f"{word}{grade}" for word in (form, zone) if word.isalpha()), "")
        elif limits is not None and limits.is_a("TOLERANCE_VALUE") and nominal is not None:
            low, high = (self._measure(n) for n in limits.arguments[:2])
            lower, upper = nominal + low, nominal + high
        aspects, other = self._aspects(entity, kind)
        return PmiDimension(entity.number, self._word(entity), kind, nominal, lower, upper, fit,
                            aspects, other)  # fmt: skip

    def _word(self, entity: StepEntity) -> str:
        words = [a for arguments in entity.parts.values() for a in arguments if isinstance(a, str)]
        return words[0] if words else ""

    def _aspects(self, entity: StepEntity, kind: str) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """Faces that a dimension is of, or runs between."""
        own = entity.parts.get("SHAPE_ASPECT_RELATIONSHIP")
        numbers = _references([a for arguments in entity.parts.values() for a in arguments])
        if own is not None:
            numbers = _references(own)
        aspects = [tuple(self.faces(number)) for number in numbers]
        if kind == "size" or len(aspects) < 2:
            return (aspects[0] if aspects else ()), ()
        return aspects[0], aspects[1]


def _references(value: object) -> list[int]:
    """All references in an argument, also inside lists and typed values."""
    if isinstance(value, Reference):
        return [int(value)]
    if isinstance(value, list | tuple):
        return [number for part in value for number in _references(part)]
    return []
