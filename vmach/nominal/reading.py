"""Read nominal CAD, whatever its format."""

from __future__ import annotations

from pathlib import Path

from vmach.errors import InputError
from vmach.nominal.part import NominalPart

__all__ = ["LENGTH_UNITS_MM", "read_nominal"]


#: units of length that a job can name for CAD that does not say its own
LENGTH_UNITS_MM = {"um": 1e-3, "mm": 1.0, "cm": 10.0, "m": 1e3, "inch": 25.4}


def read_nominal(path: str | Path, unit: str | None = None) -> NominalPart:
    """Read the nominal CAD of a part from a STEP or an STL file, by its ending.

    Parameters
    ----------
    path : path
    unit : str, optional
        One of `LENGTH_UNITS_MM`: the unit of an STL file (mm where not given), or of a STEP file
        that names none.

    Raises
    ------
    InputError
        Another ending, a file that does not hold a closed solid, or one whose unit is not known.
    """
    path = Path(path)
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        raise InputError(
            f"nominal CAD with the ending {path.suffix!r}", file=path, accepted=", ".join(_READERS)
        )
    try:
        return reader(path, None if unit is None else LENGTH_UNITS_MM[unit])
    except InputError as error:
        if error.file is not None:
            raise
        # of the geometry, which does not know its file
        raise InputError(error.what, file=path, accepted=error.accepted, hint=error.hint) from None


def _read_step(path: Path, unit_mm: float | None) -> NominalPart:
    from vmach.nominal.step.part import read_step_part  # late: commands without CAD do not wait

    return read_step_part(path, unit_mm)


def _read_stl(path: Path, unit_mm: float | None) -> NominalPart:
    from vmach.nominal.mesh.stl_part import read_stl_part  # late, too

    return read_stl_part(path, unit_mm)


_READERS = {".step": _read_step, ".stp": _read_step, ".stl": _read_stl}
