"""Which way errors count in the machine file that a table is for."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from vmach.files.toml_file import read_toml
from vmach.machine.chain import Chain
from vmach.machine.files.machine_schema import MachineSchema
from vmach.machine.sign_convention import SignConvention, sign_to_relative
from vmach.machine.tables.error_table import RAD_PER

__all__ = ["Convention"]


@dataclass(frozen=True)
class Convention:
    """Chain and sign of a machine file.

    Attributes
    ----------
    chain, sign, angle : str
        As in the file, `angle` being the unit of squareness. Without a file, the tool moves in
        all axes, and errors are relative.
    """

    chain: str = "t (C) Z Y X b w"
    sign: str = SignConvention.RELATIVE.value
    angle: str = "urad"

    @classmethod
    def of(cls, path: Path | None) -> Convention:
        """That of a machine file.

        Raises
        ------
        InputError
            The file cannot be read.
        """
        if path is None:
            return cls()
        said = read_toml(path, MachineSchema, what="machine file")
        Chain.parse(said.chain)
        return cls(said.chain, said.convention.sign, said.convention.angle)

    def factor(self, name: str) -> float:
        """From an error of the tool relative to the workpiece to one as the file counts it."""
        return sign_to_relative(SignConvention(self.sign), Chain.parse(self.chain), name)

    def in_angle_unit(self, angle_rad: float) -> float:
        """An angle in the unit of the file."""
        return float(f"{angle_rad / RAD_PER[self.angle]:.9g}")
