"""What a run hands to the reports: inspected points, a mesh to colour, and what was run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np

from gcode import readable
from vmach.base.note import Note
from vmach.features.circular_test import CircularTest
from vmach.features.result import FeatureResult

__all__ = [
    "STATUSES",
    "Colouring",
    "Column",
    "DisplayMesh",
    "InputFile",
    "InspectedPoints",
    "RunRecord",
    "SolidComparison",
    "SolidDifference",
]

#: What happened at a surface point: an edge of material was found; stock still stands far above
#: it because no tool came near; or the point lies in a region that was removed altogether.
STATUSES = ("cut", "uncut", "gouged away")


def _frozen(owner: object, name: str, dtype: type, shape: tuple[int, ...]) -> np.ndarray:
    """Replace a field by a read-only array of the given type, checked for its shape."""
    array = np.array(getattr(owner, name), dtype=dtype, order="C")
    if array.shape != shape:
        raise ValueError(f"{type(owner).__name__}.{name} has shape {array.shape}; expected {shape}")
    array.setflags(write=False)
    object.__setattr__(owner, name, array)
    return array


def _finite(owner: object, name: str, shape: tuple[int, ...]) -> None:
    if not np.isfinite(_frozen(owner, name, np.float64, shape)).all():
        raise ValueError(f"{type(owner).__name__}.{name} holds values that are not finite")


@dataclass(frozen=True)
class Column:
    """One column of deviations of the inspected points: under one error model, or as measured.

    Attributes
    ----------
    name : str
        Short key, used for columns: ``"none"``, ``"htm"``, ``"abbe"``, ``"measured"``.
    label : str
        What people read: ``"Abbe-consistent"``.
    deviation_mm : (P,) float64
        Along the outward normal, positive where material is left. Finite where the status is
        ``"cut"``; anything, also NaN, elsewhere: no report counts those points.
    status : (P,) str
        One of `STATUSES`.
    remainder_mm : (P,) float64, optional
        Measured minus predicted after the alignment that the caller chose; finite where cut.
    weight : (P,) float64, optional
        How much each point counts in means and shares; 1 for all without it.
    is_signed : bool
        Whether the values have a direction; else they are sizes, as an uncertainty is.
    """

    name: str
    label: str
    deviation_mm: np.ndarray
    status: np.ndarray
    remainder_mm: np.ndarray | None = None
    weight: np.ndarray | None = None
    is_signed: bool = True

    def __post_init__(self) -> None:
        count = len(self.deviation_mm)
        deviation = _frozen(self, "deviation_mm", np.float64, (count,))
        status = _frozen(self, "status", np.str_, (count,))
        unknown = np.setdiff1d(status, STATUSES)
        if unknown.size:
            raise ValueError(
                f"column {self.name}: status {str(unknown[0])!r}; accepted: {STATUSES}"
            )
        if not np.isfinite(deviation[self.is_cut]).all():
            raise ValueError(f"column {self.name}: a cut point has no finite deviation")
        if self.weight is not None:
            _finite(self, "weight", (count,))
        if self.remainder_mm is not None:
            remainder = _frozen(self, "remainder_mm", np.float64, (count,))
            if not np.isfinite(remainder[self.is_cut]).all():
                raise ValueError(f"column {self.name}: a cut point has no finite remainder")

    @property
    def is_cut(self) -> np.ndarray:
        """(P,) bool: points that have a deviation."""
        return self.status == "cut"

    @property
    def remainder_rms_mm(self) -> float | None:
        """RMS of measured minus predicted; None where nothing was measured or cut."""
        if self.remainder_mm is None or not self.is_cut.any():
            return None
        return float(np.sqrt(np.mean(self.remainder_mm[self.is_cut] ** 2)))

    @property
    def remainder(self) -> Column:
        """Measured minus predicted as a column of its own, for maps and statistics."""
        if self.remainder_mm is None:
            raise ValueError(f"column {self.name} was not compared with a measurement")
        name, label = f"{self.name}_remainder", f"Measured − {self.label}"
        return Column(name, label, self.remainder_mm, self.status, weight=self.weight)


@dataclass(frozen=True)
class InspectedPoints:
    """P points on the nominal surface, in workpiece coordinates, and their deviations.

    Attributes
    ----------
    id, feature : (P,) str
        Name of the point and of the face or feature that it is on.
    point_mm, normal : (P, 3) float64
        Nominal point and outward unit normal.
    line, tool, move : (P,) int32
        NC line (1-based), tool number and index of the move that made the point; line 0 and
        move -1 where none did.
    time_s : (P,) float64
        Program time at which the point was made, 0 where it was not.
    columns : tuple of Column
        At least one; the last prediction (not ``"measured"``) is the one shown first.
    u_mm : (P,) float64, optional
        Standard uncertainty of the measured deviation.
    cause : (P,) str, optional
        What the deviation of the primary column consists of, largest shares first, in words.
    """

    id: np.ndarray
    feature: np.ndarray
    point_mm: np.ndarray
    normal: np.ndarray
    line: np.ndarray
    tool: np.ndarray
    move: np.ndarray
    time_s: np.ndarray
    columns: tuple[Column, ...]
    u_mm: np.ndarray | None = None
    cause: np.ndarray | None = None

    def __post_init__(self) -> None:
        count = len(self.point_mm)
        if self.cause is not None:
            _frozen(self, "cause", np.str_, (count,))
        _finite(self, "point_mm", (count, 3))
        _finite(self, "normal", (count, 3))
        _finite(self, "time_s", (count,))
        if self.u_mm is not None:
            _finite(self, "u_mm", (count,))
        for name, dtype in (("id", np.str_), ("feature", np.str_)):
            _frozen(self, name, dtype, (count,))
        for name in ("line", "tool", "move"):
            _frozen(self, name, np.int32, (count,))
        object.__setattr__(self, "columns", tuple(self.columns))
        names = [column.name for column in self.columns]
        if not names or len(set(names)) != len(names):
            raise ValueError(f"columns need different names, at least one; got {names}")
        for column in self.columns:
            if len(column.deviation_mm) != count:
                raise ValueError(
                    f"column {column.name} has {len(column.deviation_mm)} points; expected {count}"
                )

    def __len__(self) -> int:
        return len(self.point_mm)

    def __getitem__(self, name: str) -> Column:
        """Return the column of that name; KeyError where there is none."""
        for column in self.columns:
            if column.name == name:
                return column
        raise KeyError(name)

    @property
    def remainders(self) -> tuple[Column, ...]:
        """Measured minus predicted, of every column that was compared with a measurement."""
        return tuple(v.remainder for v in self.columns if v.remainder_mm is not None)

    @property
    def differences(self) -> tuple[Column, ...]:
        """HTM minus Abbe where both were predicted; a point that one did not cut has none."""
        names = {column.name for column in self.columns}
        if not {"htm", "abbe"} <= names:
            return ()
        htm, abbe = self["htm"], self["abbe"]
        both = htm.is_cut & abbe.is_cut
        apart = np.where(both, htm.deviation_mm - abbe.deviation_mm, np.nan)
        status = np.where(both, "cut", np.where(htm.is_cut, abbe.status, htm.status))
        return (Column("htm_minus_abbe", "HTM − Abbe", apart, status),)

    def with_remainders(self) -> InspectedPoints:
        """The same points with remainders and differences as columns, for what is drawn."""
        return replace(self, columns=(*self.columns, *self.remainders, *self.differences))

    @property
    def primary(self) -> Column:
        """The column that reports show first: the last one that is a prediction."""
        predicted = [column for column in self.columns if column.name != "measured"]
        return (predicted or self.columns)[-1]


@dataclass(frozen=True)
class Colouring:
    """A deviation for every vertex of a mesh, for display.

    Attributes
    ----------
    value_mm : (V,) float64
        Finite everywhere; 0 where `known` is false.
    known : (V,) bool
        Whether there is an inspected point near enough to speak for the vertex.
    """

    value_mm: np.ndarray
    known: np.ndarray

    def __post_init__(self) -> None:
        count = len(self.value_mm)
        _finite(self, "value_mm", (count,))
        _frozen(self, "known", np.bool_, (count,))


@dataclass(frozen=True)
class DisplayMesh:
    """A triangle mesh to colour, in workpiece coordinates.

    Attributes
    ----------
    vertices_mm : (V, 3) float64
    triangles : (T, 3) int32
        Rows of `vertices_mm`, counter-clockwise seen from outside. Vertices on a sharp edge
        occur once for each face, so that colours do not run over it.
    colourings : mapping of str to Colouring
        By the name of the column.
    """

    vertices_mm: np.ndarray
    triangles: np.ndarray
    colourings: Mapping[str, Colouring] = field(default_factory=dict)

    def __post_init__(self) -> None:
        count = len(self.vertices_mm)
        _finite(self, "vertices_mm", (count, 3))
        triangles = _frozen(self, "triangles", np.int32, (len(self.triangles), 3))
        if triangles.size and not (triangles.min() >= 0 and triangles.max() < count):
            raise ValueError(f"DisplayMesh.triangles refers outside the {count} vertices")
        for name, colouring in self.colourings.items():
            if len(colouring.value_mm) != count:
                raise ValueError(f"colouring {name} does not have {count} vertices")
        object.__setattr__(self, "colourings", MappingProxyType(dict(self.colourings)))


@dataclass(frozen=True)
class InputFile:
    """A file that a run read: its role (machine, program, ...), path as given, and contents."""

    role: str
    path: str
    sha256: str
    size_bytes: int


@dataclass(frozen=True)
class SolidDifference:
    """One place where the virtual part and the nominal CAD are apart.

    Attributes
    ----------
    depth_mm : float
        Largest distance of the surfaces: positive material left (excess), negative too much
        removed (gouge).
    point_mm, size_mm : tuple of 3 float
        Where that is, and the extent of the place in X, Y and Z.
    area_mm2, volume_mm3 : float
        Surface beyond the threshold; material, NaN where it could not be found.
    feature : str
        Face of the nominal CAD.
    line, tool : int
        NC line and tool that left the part's surface there; 0 where none did.
    """

    depth_mm: float
    point_mm: tuple[float, ...]
    size_mm: tuple[float, ...]
    area_mm2: float
    volume_mm3: float
    feature: str
    line: int
    tool: int

    @property
    def kind(self) -> str:
        """``excess`` or ``gouge``."""
        return "excess" if self.depth_mm > 0.0 else "gouge"


@dataclass(frozen=True)
class SolidComparison:
    """Places beyond a threshold: how many, and the deepest of them, deepest first."""

    threshold_mm: float
    count: int
    places: tuple[SolidDifference, ...]

    @property
    def said(self) -> str:
        """How many, in words."""
        return f"{self.count} place" + "s" * (self.count != 1)


@dataclass(frozen=True)
class RunRecord:
    """What was run, for the reader who wants to run it again.

    Attributes
    ----------
    title : str
        Name of the job.
    command : str
        Command line as typed.
    model : str
        Error model of the virtual part: ``"abbe"``, ``"htm"`` or ``"none"``.
    tolerance_mm : float
        Half width of the tolerance band about the nominal surface.
    started_at : str
        Date and time, ISO 8601.
    files : tuple of InputFile
    versions : mapping of str to str
        vmach, python, numpy, ...
    stages_s : mapping of str to float
        Duration of each stage of the run, in order.
    facts : mapping of str to str
        Anything else worth a row: machine, chain, number of moves, volume of the part.
    notes : tuple of Note
        The warnings of a run as records.
    warnings : tuple of str
        What the user should know before trusting the numbers.
    program_lines : tuple of str
        Text of the NC program; line n of `InspectedPoints.line` is entry n - 1.
    comparison : SolidComparison, optional
        The virtual part against the nominal CAD, where there is one.
    points_file : str
        Name of the table of all points that lies beside the page; empty where there is none.
    features : tuple of FeatureResult
        What the drawing asks for and what was found.
    circular_tests : tuple of CircularTest
    part, serial, revision : str
        Of the drawing, for the head of reports.
    """

    title: str
    command: str
    model: str
    tolerance_mm: float
    started_at: str = ""
    files: tuple[InputFile, ...] = ()
    versions: Mapping[str, str] = field(default_factory=dict)
    stages_s: Mapping[str, float] = field(default_factory=dict)
    facts: Mapping[str, str] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    notes: tuple[Note, ...] = ()
    program_lines: tuple[str, ...] = ()
    comparison: SolidComparison | None = None
    points_file: str = ""
    features: tuple[FeatureResult, ...] = ()
    circular_tests: tuple[CircularTest, ...] = ()
    part: str = ""
    serial: str = ""
    revision: str = ""

    def __post_init__(self) -> None:
        if not (np.isfinite(self.tolerance_mm) and self.tolerance_mm > 0):
            raise ValueError(f"RunRecord.tolerance_mm is {self.tolerance_mm}; expected > 0")
        for name in ("files", "warnings", "notes", "program_lines", "features", "circular_tests"):
            object.__setattr__(self, name, tuple(getattr(self, name)))
        for name in ("versions", "stages_s", "facts"):
            object.__setattr__(self, name, MappingProxyType(dict(getattr(self, name))))

    def nc_text(self, line: int) -> str:
        """Readable text of a 1-based NC line, empty where there is no such line."""
        if not 0 < line <= len(self.program_lines):
            return ""
        return readable(self.program_lines[line - 1]).strip()
