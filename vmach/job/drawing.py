"""What the drawing asks for, as a job says it: ``[[features]]``, ``[datums]``, ``[tolerances]``."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from vmach.errors import InputError
from vmach.features.drawing.callout import Callout, distance_to_itself, read_callout

if TYPE_CHECKING:
    from vmach.job.schema import JobSchema

__all__ = ["JobDrawing", "NamedFaces", "read_drawing"]


@dataclass(frozen=True)
class NamedFaces:
    """A feature of the job: names or patterns of faces, and their kind where the CAD has none."""

    name: str
    faces: tuple[str, ...]
    kind: str = ""


@dataclass(frozen=True)
class JobDrawing:
    """The drawing of a job.

    Attributes
    ----------
    features : tuple of NamedFaces
    datums : mapping of letter to str
        Name of a feature or a face.
    tolerances : tuple of (str, Callout)
        Feature or face, and what is asked of it.
    association : str
        How datums are laid, see `vmach.features.datum_system`.
    reads_pmi : bool
        Whether tolerances in the STEP file count too.
    part, serial, revision : str
        For the head of reports.
    logo : Path or None
    """

    features: tuple[NamedFaces, ...] = ()
    datums: Mapping[str, str] = field(default_factory=dict)
    tolerances: tuple[tuple[str, Callout], ...] = ()
    association: str = "least squares"
    reads_pmi: bool = True
    part: str = ""
    serial: str = ""
    revision: str = ""
    logo: Path | None = None


def read_drawing(data: JobSchema, folder: Path, at: Callable[..., dict[str, Any]]) -> JobDrawing:
    """The drawing of a job file.

    Parameters
    ----------
    data : JobSchema
    folder : Path
        Of the job file.
    at : callable
        File and line of a key, for messages.

    Raises
    ------
    InputError
        A callout that cannot be read, a letter that is none, a name that occurs twice.
    """
    names = [entry.name for entry in data.features]
    for number, name in enumerate(names):
        if name in names[:number]:
            raise InputError(f"two features are called {name!r}", accepted="different names",
                             **at("features", str(number), "name"))  # fmt: skip
    for letter in data.datums:
        if not (len(letter) == 1 and letter.isascii() and letter.isupper()):
            raise InputError(f"datum {letter!r}", accepted="one capital letter",
                             **at("datums", letter))  # fmt: skip
    tolerances = []
    for name, texts in data.tolerances.items():
        for text in [texts] if isinstance(texts, str) else texts:
            tolerances.append((name, _callout(text, name, at("tolerances", name))))
    told = data.drawing
    return JobDrawing(
        features=tuple(_faces(entry) for entry in data.features),
        datums=dict(data.datums),
        tolerances=tuple(tolerances),
        association=told.association,
        reads_pmi=told.pmi,
        part=told.part,
        serial=told.serial,
        revision=told.revision,
        logo=_logo(told.logo, folder, at("drawing", "logo")),
    )


def _faces(entry: Any) -> NamedFaces:
    faces = entry.faces if entry.faces is not None else entry.name
    return NamedFaces(
        entry.name, (faces,) if isinstance(faces, str) else tuple(faces), entry.kind or ""
    )


def _callout(text: str, feature: str, where: dict[str, Any]) -> Callout:
    try:
        found = read_callout(text)
        if found.to == feature:
            raise distance_to_itself(found, feature)
        return found
    except InputError as error:
        raise InputError(error.what, accepted=error.accepted, hint=error.hint, **where) from None


def _logo(name: str | None, folder: Path, where: dict[str, Any]) -> Path | None:
    if name is None:
        return None
    path = folder / name
    if not path.is_file() or path.suffix.lower() not in (".png", ".jpg", ".jpeg"):
        raise InputError(f"logo = '{name}'", accepted="a PNG or JPEG file that is there", **where)
    return path
