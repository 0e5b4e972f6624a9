"""What a job says about each of its tests: place, axis, tool length, uncertainty."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, ClassVar, Literal

from vmach.errors import InputError
from vmach.files.text_file import read_text
from vmach.files.toml_file import FileSection, Point, Positive, check_section, line_of_key
from vmach.job import Job
from vmach.plausibility import lengths_meant_mm

__all__ = [
    "ALONG",
    "KINDS",
    "Ballbar",
    "Diagonal",
    "Drift",
    "InstrumentSettings",
    "Laser",
    "Tip",
    "settings_of",
]


#: displacements along X, Y and Z of one place
ALONG = ("dx_um", "dy_um", "dz_um")


class InstrumentSettings(FileSection):
    """Keys of every ``[[measurements]]``, and the columns of its file.

    `readings` names those that hold what was read, `signs` those of the last motions.
    """

    columns: ClassVar[tuple[str, ...]]
    readings: ClassVar[tuple[str, ...]]
    signs: ClassVar[tuple[str, ...]] = ()

    file: str
    tool_length_mm: Positive
    u_um: Positive

    def mistaken(self) -> Iterator[dict[str, Any]]:
        """Keys that may have been mistaken, each with what it may have to be."""
        for length_mm in lengths_meant_mm(self.tool_length_mm):
            yield {"tool_length_mm": length_mm}


class Ballbar(InstrumentSettings):
    """Circles about a centre, both ways round."""

    columns = ("run", "feed_mm_min", "angle_deg", "t_s", "radius_um")
    readings = ("radius_um",)
    kind: Literal["ballbar"]
    plane: Literal["XY", "YZ", "ZX", "XZ", "YX", "ZY"] = "XY"
    centre_mm: Point
    radius_mm: Positive

    def mistaken(self) -> Iterator[dict[str, Any]]:
        """Also the plane: which of its axes angles count from."""
        yield from super().mistaken()
        yield {"plane": self.plane[::-1]}


class Laser(InstrumentSettings):
    """Positions of one axis, from both sides."""

    columns = ("run", "position_mm", "approach", "t_s", "deviation_um")
    readings = ("deviation_um",)
    signs = ("approach",)
    kind: Literal["laser"]
    axis: Literal["X", "Y", "Z"]
    at_mm: Point

    def mistaken(self) -> Iterator[dict[str, Any]]:
        """Also the axis that moved."""
        yield from super().mistaken()
        yield from ({"axis": axis} for axis in "XYZ" if axis != self.axis)


class Diagonal(InstrumentSettings):
    """Distances along a line that several axes make together."""

    columns = ("run", "distance_mm", "approach", "t_s", "deviation_um")
    readings = ("deviation_um",)
    signs = ("approach",)
    kind: Literal["diagonal"]
    from_mm: Point
    to_mm: Point


class Drift(InstrumentSettings):
    """The tool tip at one place against time."""

    columns = ("t_s", "spindle_rpm", *ALONG)
    readings = ALONG
    kind: Literal["drift"]
    at_mm: Point


class Tip(InstrumentSettings):
    """The tool tip at places all over the volume."""

    columns = ("t_s", *"XYZ", "sx", "sy", "sz", *ALONG)
    readings = ALONG
    signs = ("sx", "sy", "sz")
    kind: Literal["tip"]
    frame: Literal["offset", "rigid"] = "offset"


#: settings of every kind
KINDS: dict[str, type[InstrumentSettings]] = {
    "ballbar": Ballbar,
    "laser": Laser,
    "diagonal": Diagonal,
    "drift": Drift,
    "tip": Tip,
}


def settings_of(job: Job, number: int) -> InstrumentSettings:
    """One ``[[measurements]]`` of a job, counted from 0, checked.

    Raises
    ------
    InputError
        Unknown kind or key, a key missing, a value that is not accepted.
    """
    entry, within = job.measurements[number], ("measurements", str(number))
    text = read_text(job.path, what="job file")
    kind = entry.get("kind")
    if not isinstance(kind, str) or kind not in KINDS:
        raise InputError(
            "a measurement needs its kind" if kind is None else f"kind = {kind!r}",
            file=job.path,
            line=line_of_key(text, [*within, "kind"]),
            accepted=f"kind = {', '.join(KINDS)}",
        )
    return check_section(entry, KINDS[kind], file=job.path, text=text, within=within)
