"""Read nominal CAD, whatever its format."""

from __future__ import annotations

from pathlib import Path

from vmach.errors import InputError
from vmach.nominal.part import NominalPart
from vmach.nominal.step_part import read_step_part
from vmach.nominal.stl_part import read_stl_part

__all__ = ["read_nominal"]

_READERS = {".step": read_step_part, ".stp": read_step_part, ".stl": read_stl_part}


def read_nominal(path: str | Path) -> NominalPart:
    """Read the nominal CAD of a part from a STEP or an STL file, by its ending.

    Raises
    ------
    InputError
        Another ending, or a file that does not hold a closed solid.
    """
    path = Path(path)
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        raise InputError(
            f"nominal CAD with the ending {path.suffix!r}", file=path, accepted=", ".join(_READERS)
        )
    return reader(path)
