"""The drawing of a job on the points that were inspected."""

from __future__ import annotations

from collections.abc import Sequence
from difflib import get_close_matches
from fnmatch import fnmatchcase

import numpy as np

from vmach.errors import InputError
from vmach.features.evaluation import Drawing, Requirement
from vmach.features.feature import Feature, as_members, make_feature
from vmach.files.text_file import read_text
from vmach.files.toml_file import line_of_key
from vmach.job import Job
from vmach.nominal import NominalPart
from vmach.nominal.feature_surface import surface_of_face, surface_of_points
from vmach.nominal.points import SurfacePoints
from vmach.run.pmi_drawing import PmiDrawing, pmi_drawing

__all__ = ["FeatureFinder", "drawing_error", "job_drawing"]

#: a point of a file lies on a face of the CAD that is this near, with normals this much alike
_ON_FACE_MM, _ALONG = 5e-3, 0.99
#: names that a message lists
_LISTED = 12


def job_drawing(job: Job, nominal: NominalPart | None, points: SurfacePoints) -> Drawing | None:
    """Features, datums and requirements of a job; None where nothing is asked for.

    Raises
    ------
    InputError
        A name that no face and no point has, or a feature that no point lies on.
    """
    asked = job.drawing
    told = pmi_drawing(nominal, asked.features) if asked.reads_pmi else PmiDrawing()
    if not (asked.tolerances or told.requirements):
        return None
    finder = FeatureFinder(job, nominal, points)
    wanted = [("tolerances", name, name) for name, _ in asked.tolerances]
    wanted += [("datums", letter, name) for letter, name in asked.datums.items()]
    wanted += [("tolerances", name, callout.to) for name, callout in asked.tolerances if callout.to]
    features: dict[str, Feature] = {}
    for section, key, name in wanted:
        try:
            features.setdefault(name, finder.feature(name))
        except InputError as error:
            raise drawing_error(job, error, section, key, f"{section}.{key}") from None
    for name, faces in told.features.items():
        features.setdefault(name, finder.of_faces(name, faces))
    return Drawing(
        features,
        {**told.datums, **asked.datums},
        (*(Requirement(name, callout) for name, callout in asked.tolerances), *told.requirements),
        asked.association,
    )


def drawing_error(job: Job, error: InputError, section: str, key: str, said: str) -> InputError:
    """An error of the drawing with its place: `section` and `key` of the job file.

    `said` stands before a message that does not name the key itself.
    """
    what = error.what if key in error.what else f"{said}: {error.what}"
    line = line_of_key(read_text(job.path, what="job file"), [section, key])
    return InputError(what, file=job.path, line=line, accepted=error.accepted, hint=error.hint)


class FeatureFinder:
    """Finds faces and points by the names of a job."""

    def __init__(self, job: Job, nominal: NominalPart | None, points: SurfacePoints) -> None:
        self._job, self._points = job, points
        self._named = {entry.name: entry for entry in job.drawing.features}
        self._faces = {face.name: face for face in nominal.faces} if nominal else {}
        self._own_names = {
            title: name for name, face in self._faces.items() if (title := _title(face))
        }
        self._point_names = set(np.unique(points.feature).tolist())

    def feature(self, name: str) -> Feature:
        """The feature of a name of the job, of a face or of a point.

        Raises
        ------
        InputError
            Nothing has this name, or no point lies on it.
        """
        entry = self._named.get(name)
        patterns = entry.faces if entry else (name,)
        kind = entry.kind if entry else ""
        faces = self._matching(name, patterns)
        rows = [self._rows(face) for face in faces]
        surfaces = [self._surface(face, own, kind) for face, own in zip(faces, rows, strict=True)]
        try:
            return make_feature(name, surfaces, rows, faces)
        except InputError as error:
            raise self._error(name, error.what, error.accepted, error.hint) from None

    def of_faces(self, name: str, faces: Sequence[str]) -> Feature:
        """The feature of some faces of the CAD; it may have no points."""
        rows = [self._rows(face) for face in faces]
        surfaces = [self._surface(face, own, "") for face, own in zip(faces, rows, strict=True)]
        return Feature(name, as_members(surfaces, rows), tuple(faces))

    def _matching(self, name: str, patterns: Sequence[str]) -> list[str]:
        """Faces of the CAD, and features of the points, that names or patterns mean."""
        known = [*self._faces, *self._own_names, *sorted(self._point_names - set(self._faces))]
        found: list[str] = []
        for pattern in patterns:
            hits = [k for k in known if k == pattern or fnmatchcase(k, pattern)]
            if not hits:
                some = ", ".join(repr(k) for k in known[:_LISTED])
                more = f" and {len(known) - _LISTED} more" if len(known) > _LISTED else ""
                what = f"no face and no point is called {pattern!r}"
                hint = "'vmach features JOB --faces' lists them"
                if near := get_close_matches(pattern, [*self._named, *known], 1):
                    hint = f"is it {near[0]!r}? {hint}"
                raise self._error(name, what, some + more, hint)
            found += [self._own_names.get(k, k) for k in hits]
        return list(dict.fromkeys(found))

    def _rows(self, face: str) -> np.ndarray:
        """Points of a face, by name, else by place."""
        rows = np.flatnonzero(self._points.feature == face)
        if rows.size or face not in self._faces:
            return rows
        if self._point_names & set(self._faces):
            return rows  # sampled on the CAD: the face has no points
        return self._near(face)

    def _near(self, face: str) -> np.ndarray:
        """Points of a file that lie on a face of the CAD."""
        surface = self._surface(face, np.empty(0, dtype=int), "")
        if surface.kind == "free":
            return np.empty(0, dtype=int)
        distance, normals, _ = surface.rows(self._points.point_mm)
        alike = np.einsum("ij,ij->i", normals, self._points.normal) > _ALONG
        near = alike & (np.abs(distance) < _ON_FACE_MM)
        segments = self._faces[face].trim.segments_mm.reshape(-1, 3)
        if len(segments):
            low, high = segments.min(axis=0) - 0.1, segments.max(axis=0) + 0.1
            inside = (self._points.point_mm >= low) & (self._points.point_mm <= high)
            near &= inside.all(axis=1) | (surface.kind in ("sphere", "torus"))
        return np.flatnonzero(near)

    def _surface(self, face: str, rows: np.ndarray, kind: str):
        points, normals = self._points.point_mm[rows], self._points.normal[rows]
        try:
            if kind or face not in self._faces:
                return surface_of_points(kind or _guess(points, normals), points, normals)
            return surface_of_face(self._faces[face], points, normals)
        except InputError as error:
            raise self._error(face, error.what, error.accepted, error.hint) from None

    def _error(self, name: str, what: str, accepted: str | None, hint: str | None) -> InputError:
        told = what if name in what else f"feature {name!r}: {what}"
        return InputError(told, file=self._job.path, accepted=accepted, hint=hint)


def _title(face) -> str:
    """The name that the CAD gave to a face."""
    return getattr(face, "title", "")


def _guess(points: np.ndarray, normals: np.ndarray) -> str:
    """Kind of the surface that points of a file lie on."""
    for kind in ("plane", "cylinder", "sphere"):
        if len(points) < 4:
            break
        try:
            surface_of_points(kind, points, normals)
        except InputError:
            continue
        return kind
    return "free"
