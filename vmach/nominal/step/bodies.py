"""Which bodies of a STEP file are the part, and what is said of the others.

Source: ISO 10303-42 (solid and surface models).
"""

from __future__ import annotations

from vmach.base.note import Kind, Note
from vmach.errors import InputError
from vmach.nominal.step.assembly import SOLIDS, SURFACE_MODELS, placed_bodies
from vmach.nominal.step.exchange_file import StepEntity, StepFile
from vmach.nominal.step.geometry import GeometryReader
from vmach.nominal.step.solids import OpenShellError, Solid, SolidReader

__all__ = ["read_bodies"]

#: endings of documents that hold geometry
_GEOMETRY_FILES = (".stp", ".step", ".p21", ".stpz")

#: so many names of other files are listed
_LISTED = 10


def read_bodies(step: StepFile) -> tuple[list[Solid], list[Note]]:
    """The solids that make the part, in the workpiece frame, and notes on what was left aside.

    Solids are taken; surface models beside them are construction geometry. In a file without
    solids the surface models that close are taken.

    Raises
    ------
    InputError
        No body that encloses a volume, or one that cannot be read.
    """
    bodies = placed_bodies(step)
    solids = [body for body in bodies if any(body[0].is_a(kind) for kind in SOLIDS)]
    surfaces = [body[0] for body in bodies if not any(body[0].is_a(kind) for kind in SOLIDS)]
    if solids:
        taken = [SolidReader(step, geometry).read(entity) for entity, geometry in solids]
    else:
        taken, surfaces = _closed_models(step, bodies)
    others = _other_files(step)
    if not taken:
        raise _no_solid(step, others)
    return taken, _notes(step, taken, surfaces, others)


def _closed_models(
    step: StepFile, bodies: list[tuple[StepEntity, GeometryReader]]
) -> tuple[list[Solid], list[StepEntity]]:
    """Surface models that enclose a volume, and those that do not."""
    taken, left, errors = [], [], []
    for entity, geometry in bodies:
        try:
            taken.append(SolidReader(step, geometry).read(entity))
        except OpenShellError as error:
            left.append(entity)
            errors.append(error)
    if errors and not taken:
        raise errors[0]
    return taken, left


def _notes(
    step: StepFile, taken: list[Solid], left: list[StepEntity], others: list[str]
) -> list[Note]:
    notes = []
    if len(taken) > 1:
        said = f"{len(taken)} solids are taken together"
        notes.append(Note.plain(Kind.BODIES, said, len(taken), "1"))
    if left:
        first = f"#{left[0].number} in line {step.line(left[0].number)}"
        count = f"{len(left)} surface models, the first" if len(left) > 1 else "a surface model"
        said = f"left aside beside the solid: {count} {first}"
        notes.append(Note.plain(Kind.BODIES, said, len(left), "1", place=f"#{left[0].number}"))
    touching = sum(solid.touching_edges for solid in taken)
    if touching:
        said = f"the solid touches itself along {touching} edge{'s' if touching > 1 else ''}"
        notes.append(Note.plain(Kind.BODIES, said, touching, "1"))
    if others:
        said = f"parts in other files are left out: {_list(others)}"
        notes.append(Note.plain(Kind.BODIES, said, len(others), "1", place=others[0]))
    return notes


def _no_solid(step: StepFile, others: list[str]) -> InputError:
    if others:
        return InputError(
            f"no solid in the STEP file: the parts of the assembly lie in other files, "
            f"{_list(others)}",
            file=step.path,
            accepted=", ".join(SOLIDS + SURFACE_MODELS),
            hint="export the assembly into one file, or give the file of one part",
        )
    if any(True for _ in step.of_type("TESSELLATED_SOLID")):
        return InputError(
            "no solid in the STEP file: the part is tessellated, it has triangles but no surfaces",
            file=step.path,
            accepted=", ".join(SOLIDS + SURFACE_MODELS),
            hint="export the body with exact geometry, or as STL",
        )
    return InputError(
        "no solid in the STEP file",
        file=step.path,
        accepted=", ".join(SOLIDS + SURFACE_MODELS),
        hint="export the body as a solid (AP203, AP214 or AP242), not as wires or a mesh",
    )


def _list(names: list[str]) -> str:
    more = f" and {len(names) - _LISTED} more" if len(names) > _LISTED else ""
    return ", ".join(names[:_LISTED]) + more


def _other_files(step: StepFile) -> list[str]:
    """Names of the files in which parts are defined, in the order of the file."""
    return list(
        dict.fromkeys(
            name
            for document in step.of_type("DOCUMENT_FILE")
            for name in document.parts["DOCUMENT_FILE"][:2]
            if isinstance(name, str) and name.lower().endswith(_GEOMETRY_FILES)
        )
    )
