"""Uncertainty contributors of a laser measurement as a user writes them."""

from __future__ import annotations

from pathlib import Path

from vmach.iso230.uncertainty import Budget
from vmach.toml_file import FileSection, NonNegative, read_toml

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
    """The contributors in a TOML file; without one those of Table 8 of the KTH thesis."""
    file = _BudgetFile() if path is None else read_toml(path, _BudgetFile, what="budget file")
    return Budget(
        wavelength_mm=file.wavelength_um * 1e-3,
        air_mm=file.air_um * 1e-3,
        dead_path_mm=file.dead_path_um * 1e-3,
        resolution_mm=file.resolution_um * 1e-3,
        misalignment_rad=file.misalignment_mrad * 1e-3,
        abbe_offset_mm=file.abbe_offset_mm,
        angle_rad=file.angle_urad * 1e-6,
        eve_mm=file.eve_um * 1e-3,
    )
