"""Point clouds of a scan: PLY, XYZ, ASC; each point is laid on the nearest nominal surface."""

from __future__ import annotations

import io
import re

import numpy as np

from vmach.files.text_file import decimal_number
from vmach.importers.importer import Imported, Importer
from vmach.importers.measured_points import laid_on_part, points_file
from vmach.importers.questions import Questions
from vmach.importers.source_file import SourceFile

__all__ = ["Scan"]

#: more points than this say no more of a part; evenly chosen ones are kept
_MOST_POINTS = 20_000
_TEXT = (".xyz", ".asc", ".pts")
#: a PLY file says within these what it holds
_HEADER_BYTES = 100_000


class Scan(Importer):
    """Coordinates of points, in the coordinate system of the CAD.

    Normals and colours behind the coordinates are not looked at: the nominal surface has normals.
    """

    name = "scan"
    title = "Point cloud of a scan"
    reads = ".ply (any encoding), .xyz, .asc, .pts: three numbers a line; needs --job with a CAD"
    rank = 20
    keys = {"unit": "of the coordinates: mm, inch, um, cm or m", "points": "kept at most"}

    def recognises(self, source: SourceFile) -> bool:
        return source.suffix in (".ply", *_TEXT)

    def read(self, source: SourceFile, questions: Questions) -> Imported:
        cloud = _ply(source) if source.suffix == ".ply" else coordinates(source, least=3)
        most = int(questions.number("points", "points kept at most", unit="1",
                                    default=float(_MOST_POINTS)))  # fmt: skip
        chosen = cloud
        if len(cloud) > most > 0:
            chosen = cloud[np.linspace(0, len(cloud) - 1, most).astype(int)]
        points, told = laid_on_part(chosen[:, :3], source, questions)
        if len(chosen) < len(cloud):
            told += (f"{len(chosen)} of {len(cloud)} points are kept, evenly chosen",)
        return points_file(points, source, told)


def coordinates(source: SourceFile, *, least: int) -> np.ndarray:
    """Lines of at least so many numbers, (P, `least`).

    Raises
    ------
    InputError
        A line that is not; with its number.
    """
    rows: list[list[float]] = []
    for number, line in enumerate(source.lines, 1):
        words = _words(line)
        if not words or line.lstrip().startswith(("#", "//")):
            continue
        values = [decimal_number(word) for word in words[:least]]
        if len(values) < least or not np.isfinite(values).all() or np.abs(values).max() > 1e6:
            if not rows and len(words) == 1:  # a count of points, as some programs begin with
                continue
            raise source.error(
                f"'{line.strip()[:60]}'", line=number, accepted=f"{least} numbers, at most 1e6"
            )
        rows.append(values)
    if not rows:
        raise source.error("no points in the file", accepted="three numbers a line")
    return np.array(rows)


def _words(line: str) -> list[str]:
    """Numbers of a line between blanks, semicolons or commas; else commas are decimal ones."""
    words = line.replace(";", " ").split()
    if len(words) > 2 and all(re.fullmatch(r"[+-]?\d*(,\d+)?", word) for word in words):
        return [word.replace(",", ".") for word in words]
    return line.replace(";", " ").replace(",", " ").split()


def _ply(source: SourceFile) -> np.ndarray:
    import trimesh  # late: it takes half a second, and only scans need it

    try:
        found = trimesh.load(io.BytesIO(source.content), file_type="ply", process=False)
        points = np.asarray(getattr(found, "vertices", None), dtype=float)
    except Exception as error:  # whatever trimesh makes of a broken file
        raise source.error(f"is no PLY: {error}", line=1, accepted="a PLY file") from None
    if points.ndim != 2 or points.shape[1:] != (3,) or not len(points):
        raise source.error("holds no points", line=1, accepted="vertices with x, y and z")
    if not (np.abs(points) <= 1e6).all():
        raise source.error("holds a coordinate that is no number, or beyond 1e6", line=1,
                           accepted="finite coordinates of every vertex")  # fmt: skip
    said = re.search(rb"^element vertex +(\d+)\s*$", source.content[:_HEADER_BYTES], re.MULTILINE)
    if said and int(said[1]) != len(points):
        raise source.error(
            f"says {int(said[1])} vertices and has {len(points)}",
            line=1,
            accepted="a file that was copied whole",
        )
    return points
