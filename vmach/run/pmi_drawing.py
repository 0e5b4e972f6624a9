"""What the CAD itself asks for, in the words of a drawing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from vmach.errors import InputError
from vmach.features.drawing.callout import Callout, read_callout
from vmach.features.evaluation import Requirement
from vmach.job.drawing import NamedFaces
from vmach.nominal import NominalPart
from vmach.nominal.step.pmi import PmiDimension, PmiTolerance

__all__ = ["PmiDrawing", "pmi_drawing"]

_SOURCE = "CAD"
#: digits of values from a file: a tenth of a nanometre
_DIGITS = 7


@dataclass(frozen=True)
class PmiDrawing:
    """Features as names of faces, datums by letters, requirements."""

    features: dict[str, tuple[str, ...]] = field(default_factory=dict)
    datums: dict[str, str] = field(default_factory=dict)
    requirements: tuple[Requirement, ...] = ()


def pmi_drawing(nominal: NominalPart | None, named: Sequence[NamedFaces]) -> PmiDrawing:
    """The drawing that a STEP file holds; empty where it holds none.

    Features get the names that the job gives to the same faces, else those of the CAD.
    """
    if nominal is None or not nominal.pmi:
        return PmiDrawing()
    naming = _Naming(nominal, named)
    datums = {}
    for datum in nominal.pmi.datums:
        if faces := naming.faces(datum.faces):
            datums.setdefault(datum.letter, naming.name(faces))
    requirements = []
    for one in nominal.pmi.tolerances:
        if faces := naming.faces(one.faces):
            requirements.append(_tolerance(naming.name(faces), one))
    for one in nominal.pmi.dimensions:
        faces, other = naming.faces(one.faces), naming.faces(one.other_faces)
        text = _dimension_text(one, naming.name(other) if other else "") if faces else ""
        if text:
            requirements.append(_requirement(naming.name(faces), text))
    return PmiDrawing(naming.features, datums, tuple(dict.fromkeys(requirements)))


class _Naming:
    """Names for sets of faces."""

    def __init__(self, nominal: NominalPart, named: Sequence[NamedFaces]) -> None:
        self._face = {face.number: face for face in nominal.faces if getattr(face, "number", 0)}
        self._named = {tuple(sorted(entry.faces)): entry.name for entry in named}
        self.features: dict[str, tuple[str, ...]] = {}

    def faces(self, numbers: Sequence[int]) -> tuple[str, ...]:
        """Names of the faces with these numbers in the file."""
        return tuple(self._face[n].name for n in numbers if n in self._face)

    def name(self, faces: tuple[str, ...]) -> str:
        """A name for the faces, the same every time."""
        known = self._named.get(tuple(sorted(faces)))
        titles = {face.name: face.title for face in self._face.values()}
        first = titles.get(faces[0]) or faces[0]
        name = known or (first if len(faces) == 1 else f"{first} and {len(faces) - 1} more")
        if self.features.get(name, faces) != faces:
            name = f"{name} ({', '.join(face.split()[1] for face in faces)})"
        self.features[name] = faces
        return name


def _tolerance(feature: str, one: PmiTolerance) -> Requirement:
    # A-A of ISO 5459, the common datum of several faces with one letter, is the feature A here
    datums = ["-".join(dict.fromkeys(label.split("-"))) for label in one.datums]
    text = " ".join([one.characteristic, f"{one.zone}{_number(one.value_mm)}", *datums])
    refused = ""
    if one.modifiers:
        words = one.modifiers[0].replace("_", " ").lower()
        refused = f"{words}: not evaluated"
    return _requirement(feature, text, refused)


def _dimension_text(one: PmiDimension, other: str) -> str:
    """A size or distance with limits; empty where the file states none that is evaluated."""
    if one.nominal is None or one.kind == "angle":
        return ""
    if one.fit:
        limits = one.fit
    elif one.lower is not None and one.upper is not None:
        low, high = (round(limit - one.nominal, _DIGITS) for limit in (one.lower, one.upper))
        limits = f"{high:+g} {low:+g}"
    else:
        return ""
    nominal = _number(one.nominal)
    if one.kind == "location":
        return f"distance {nominal} {limits} to {other}" if other else ""
    return f"{'R' if 'radius' in one.name.lower() else ''}{nominal} {limits}"


def _number(value: float) -> str:
    return f"{round(value, _DIGITS):.10g}"


def _requirement(feature: str, text: str, refused: str = "") -> Requirement:
    """A requirement; one that cannot be read is kept with the reason."""
    try:
        return Requirement(feature, read_callout(text), _SOURCE, refused)
    except InputError as error:
        callout = Callout(text, text.split()[0], 0.0)
        return Requirement(feature, callout, _SOURCE, refused or error.what)
