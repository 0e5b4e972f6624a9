"""Points of a part as the project's own file has them, nominal beside measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vmach.base.units import um_from_mm
from vmach.importers.importer import Imported, Section
from vmach.importers.questions import Questions
from vmach.importers.source_file import SourceFile
from vmach.instruments.kinds.holes import Holes as HolesInstrument
from vmach.nominal import NominalPart, read_nominal
from vmach.nominal.nearest import feet_on

__all__ = [
    "Holes",
    "Points",
    "holes_file",
    "laid_on_part",
    "length_factor",
    "normals_on_part",
    "points_file",
    "sized_holes",
]

#: a measured point further from the nominal surface belongs to something else, mm
_FARTHEST_MM = 2.0
#: a nominal point of a report that is farther from the CAD is not one of this part
_OFF_MM = 0.1
#: ratios of the sizes of part and points from which on the unit is asked about
_INCHES = (0.8 / 25.4, 1.25 / 25.4)
#: share of points that may lie astray, as a table under the part does
_MOST_ASTRAY = 0.5
_UNITS = {"mm": 1.0, "inch": 25.4, "um": 1e-3, "cm": 10.0, "m": 1e3}


@dataclass(frozen=True)
class Points:
    """P points, in mm; `nominal_mm` and `normal` are (P, 3)."""

    id: Sequence[str] | np.ndarray
    feature: Sequence[str] | np.ndarray
    nominal_mm: np.ndarray
    normal: np.ndarray
    measured_mm: np.ndarray


@dataclass(frozen=True)
class Holes:
    """H holes, bores or bosses: centres and diameters in mm, (H, 2) and (H,), or no diameters."""

    id: Sequence[str] | np.ndarray
    nominal_mm: np.ndarray
    measured_mm: np.ndarray
    nominal_d_mm: np.ndarray | None
    measured_d_mm: np.ndarray | None


def points_file(points: Points, source: SourceFile, told: Sequence[str] = ()) -> Imported:
    """The file of points that `measured` of a job names."""
    lines = ["id,feature,x,y,z,i,j,k,mx,my,mz"]
    columns = np.hstack([points.nominal_mm, points.normal, points.measured_mm])
    for name, feature, row in zip(points.id, points.feature, columns, strict=True):
        lines.append(f"{_word(name)},{_word(feature)}," + ",".join(f"{v + 0.0:.9g}" for v in row))
    file = f"{source.path.stem}_points.csv"
    apart_mm = np.einsum("ij,ij->i", points.measured_mm - points.nominal_mm, points.normal)
    apart_um = um_from_mm(apart_mm)
    said = (
        f"{source.path.name}: {len(lines) - 1} points, deviations "
        f"{apart_um.min():.1f} .. {apart_um.max():.1f} um, mean {apart_um.mean():.1f} um"
    )
    section = Section("job", "", {"measured": file})
    return Imported({file: "\n".join(lines) + "\n"}, (section,), (said, *told))


def holes_file(
    holes: Holes, source: SourceFile, questions: Questions, told: Sequence[str] = ()
) -> Imported:
    """The file of a ``kind = "holes"``, and its section."""
    u_um = questions.number(
        "u_um", "standard uncertainty of a measured position or diameter", unit="um", default=1.0
    )
    columns = np.column_stack([holes.nominal_mm, holes.measured_mm])
    lines = ["id,x,y,mx,my"]
    if holes.nominal_d_mm is not None and holes.measured_d_mm is not None:
        columns = np.column_stack([columns, holes.nominal_d_mm, holes.measured_d_mm])
        lines = ["id,x,y,mx,my,d,md"]
    for name, row in zip(holes.id, columns, strict=True):
        lines.append(f"{_word(name)}," + ",".join(f"{v:.9g}" for v in row))
    file = f"{source.path.stem}_holes.csv"
    section = Section(
        "job",
        "measurements",
        {"kind": HolesInstrument.name, "file": file, "u_um": u_um},
        is_array=True,
    )
    said = f"{source.path.name}: {len(lines) - 1} holes, bores or bosses"
    return Imported({file: "\n".join(lines) + "\n"}, (section,), (said, *told))


def sized_holes(holes: Holes) -> tuple[Holes, tuple[str, ...]]:
    """Holes whose diameters are known, or all of them where none is; and what is said of it.

    Parameters
    ----------
    holes : Holes
        A diameter that is not known is NaN.
    """
    if holes.nominal_d_mm is None or holes.measured_d_mm is None:
        known = np.zeros(len(holes.id), dtype=bool)
    else:
        known = np.isfinite(holes.nominal_d_mm) & np.isfinite(holes.measured_d_mm)
    if known.all():
        return holes, ()
    if not known.any():
        alone = Holes(holes.id, holes.nominal_mm, holes.measured_mm, None, None)
        return alone, ("no diameter was measured: the holes have places alone",)
    assert holes.nominal_d_mm is not None and holes.measured_d_mm is not None
    some = Holes(
        np.asarray(holes.id)[known], holes.nominal_mm[known], holes.measured_mm[known],
        holes.nominal_d_mm[known], holes.measured_d_mm[known],
    )  # fmt: skip
    return some, (f"{np.sum(~known)} holes without a measured diameter are left out",)


def _word(text: str) -> str:
    return text.replace(",", " ").replace('"', "").replace("\n", " ").strip()


def length_factor(source: SourceFile, questions: Questions, said: str | None) -> float:
    """Millimetres per unit of the file: as it says, as told, or asked."""
    if said is not None and "unit" not in questions.given:
        return _UNITS[said]
    unit = questions.choice(
        "unit", f"unit of the coordinates in {source.path.name}", tuple(_UNITS), said=said
    )
    return _UNITS[unit]


def laid_on_part(
    measured: np.ndarray, source: SourceFile, questions: Questions, *, radius_mm: float = 0.0
) -> tuple[Points, tuple[str, ...]]:
    """Points of a scan or of a probe, each laid on the nominal surface below it.

    Parameters
    ----------
    measured : (P, 3) array
        In the unit of the file.
    source : SourceFile
    questions : Questions
        With the job, whose nominal CAD they are laid on.
    radius_mm : float
        Of the probe's ball, whose centre was recorded.

    Raises
    ------
    InputError
        There is no nominal CAD, or the points belong to another part or another unit.
    """
    part = _nominal(source, questions)
    factor = length_factor(source, questions, _likely_unit(measured, part, source, questions))
    measured_mm = factor * measured
    feet = feet_on(part, measured_mm)
    surface = measured_mm - radius_mm * feet.normal
    near = np.abs(feet.distance_mm - radius_mm) < _FARTHEST_MM
    if np.count_nonzero(near) < (1.0 - _MOST_ASTRAY) * len(near) or not near.any():
        far = np.abs(feet.distance_mm - radius_mm)
        raise source.error(
            f"{np.count_nonzero(~near)} of {len(near)} points are more than {_FARTHEST_MM:g} mm "
            f"from {part.path.name}, the median is {np.median(far):.3g} mm",
            accepted="points of this part, in the coordinates of its CAD",
            hint="align the scan with the CAD first; --set unit=inch where it is in inches",
        )
    kept = np.flatnonzero(near)
    points = Points(
        [str(k + 1) for k in kept], feet.feature[kept], feet.point_mm[kept], feet.normal[kept],
        surface[kept],
    )  # fmt: skip
    told: tuple[str, ...] = ()
    if factor != 1.0:
        told += (f"unit: {1 / factor:g} per mm; laid on {part.path.name}",)
    if len(kept) < len(near):
        lost = len(near) - len(kept)
        told += (f"{lost} points further than {_FARTHEST_MM:g} mm from the part are left out",)
    return points, told


def normals_on_part(
    nominal_mm: np.ndarray, source: SourceFile, questions: Questions, lines: np.ndarray
) -> np.ndarray:
    """Outward normals of the CAD at nominal points of a report that states none, (P, 3).

    Parameters
    ----------
    nominal_mm : (P, 3) array
    source : SourceFile
    questions : Questions
        With the job, whose nominal CAD has them.
    lines : (P,) int array
        Where each point stands.

    Raises
    ------
    InputError
        There is no nominal CAD, or a nominal point is not on it.
    """
    part = _nominal(source, questions)
    feet = feet_on(part, nominal_mm)
    off = np.abs(feet.distance_mm)
    if (off > _OFF_MM).any():
        first = int(np.argmax(off > _OFF_MM))
        raise source.error(
            f"{np.count_nonzero(off > _OFF_MM)} of {len(off)} nominal points are more than "
            f"{_OFF_MM:g} mm from {part.path.name}, this one {off[first]:.3g} mm",
            line=int(lines[first]),
            accepted="a report of this part, in the coordinates of its CAD",
            hint="columns i, j, k state the normals of points that the CAD does not have",
        )
    return feet.normal


def _nominal(source: SourceFile, questions: Questions) -> NominalPart:
    job = questions.job
    if job is None or job.nominal is None:
        raise source.error(
            "points without nominal ones need the CAD of the part",
            accepted="--job JOB with a nominal STEP or STL",
        )
    return read_nominal(job.nominal, job.nominal_unit)


def _likely_unit(
    measured: np.ndarray, part: NominalPart, source: SourceFile, questions: Questions
) -> str | None:
    """Millimetres, unless the points are the size of the part in inches: then it is asked."""
    own, wanted = (np.linalg.norm(np.ptp(p, axis=0)) for p in (measured, part.bounds_mm))
    if not own or not _INCHES[0] < own / wanted < _INCHES[1]:
        return "mm"
    if questions.ask is None and "unit" not in questions.given:
        raise source.error(
            f"the points span {own:.4g}, the part {wanted:.4g} mm: are they in inches?",
            accepted="--set unit=inch, or --set unit=mm where they cover a small part of it",
        )
    return None
