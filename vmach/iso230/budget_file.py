"""Uncertainty contributors of a laser measurement as a user writes them.

Source: ISO/TR 230-9; KTH thesis, Table 8, for the assumed contributors.
"""

from __future__ import annotations

from pathlib import Path

from vmach.base.units import mm_from_um, rad_from_urad
from vmach.errors import InputError
from vmach.files.toml_file import FileSection, NonNegative, read_toml
from vmach.iso230.uncertainty import Budget

__all__ = ["read_budget"]


class _BudgetFile(FileSection):
    """Keys of a budget file; what is left out is as in Table 8 of the KTH thesis."""

    wavelength_um: NonNegative = 0.06
    air_um: NonNegative = 0.9
    dead_path_um: NonNegative = 0.0
    resolution_um: NonNegative = 0.002
    misalignment_mrad: NonNegative = 5.0
    abbe_offset_mm: NonNegative = 25.0
    angle_urad: NonNegative = 60.0
    eve_um: NonNegative = 1.5


def read_budget(path: Path | None) -> Budget:
    """The contributors in a TOML file; without one those of Table 8 of the KTH thesis.

    Raises
    ------
    InputError
        A file that cannot be read, or that says no contributor: all would be assumed.
    """
    file = _BudgetFile() if path is None else read_toml(path, _BudgetFile, what="budget file")
    if path is not None and not file.model_fields_set:
        raise InputError(
            "the budget file names no contributor",
            file=path,
            accepted=", ".join(_BudgetFile.model_fields),
            hint="without --budget those of a thesis are assumed",
        )
    return Budget(
        wavelength_mm=mm_from_um(file.wavelength_um),
        air_mm=mm_from_um(file.air_um),
        dead_path_mm=mm_from_um(file.dead_path_um),
        resolution_mm=mm_from_um(file.resolution_um),
        misalignment_rad=file.misalignment_mrad * 1e-3,
        abbe_offset_mm=file.abbe_offset_mm,
        angle_rad=rad_from_urad(file.angle_urad),
        eve_mm=mm_from_um(file.eve_um),
    )
