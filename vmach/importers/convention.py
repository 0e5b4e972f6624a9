"""Which way errors count in the machine file that a table is for."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path

from vmach.errors import InputError
from vmach.files.text_file import read_text
from vmach.machine.chain import Chain
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
        """That of a machine file, as far as it says it."""
        if path is None:
            return cls()
        try:
            said = tomllib.loads(read_text(path, what="machine file"))
            sign = said["convention"]["sign"]
            angle = str(said["convention"]["angle"])
            found = cls(str(said["chain"]), SignConvention(sign).value, angle)
            Chain.parse(found.chain)
            found.in_angle_unit(0.0)
        except (KeyError, TypeError, ValueError, RecursionError) as error:
            if isinstance(error, InputError) and error.file is not None:
                raise
            raise InputError(
                f"chain, sign and angle cannot be read: {error}",
                file=path,
                accepted="chain, and sign and angle in [convention]",
                hint="'vmach check' says what the machine file lacks",
            ) from None
        return found

    def factor(self, name: str) -> float:
        """From an error of the tool relative to the workpiece to one as the file counts it."""
        return sign_to_relative(SignConvention(self.sign), Chain.parse(self.chain), name)

    def in_angle_unit(self, angle_rad: float) -> float:
        """An angle in the unit of the file."""
        return float(f"{angle_rad / RAD_PER[self.angle]:.9g}")
