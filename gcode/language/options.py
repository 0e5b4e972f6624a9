"""How a program is run, and how its control is set."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from gcode.errors import ProgramError

__all__ = ["INCREMENT_SYSTEMS", "ControlSettings", "RunOptions"]

#: what a number without a decimal point counts, see `gcode.dialects.fanuc.block`
INCREMENT_SYSTEMS = ("calculator", "IS-A", "IS-B", "IS-C")


@dataclass(frozen=True)
class ControlSettings:
    """Switches and parameters of a control that the program does not say.

    Attributes
    ----------
    increment : str or None
        One of `INCREMENT_SYSTEMS`; None where nobody has said it.
    block_delete : bool or frozenset of int
        Skip blocks that begin with a slash; or those of some switches, 1 for a bare slash.
    ignore_m : frozenset of int
        Machine builder's M codes that move nothing.
    options : mapping of str to str
        Parameters of one control, by the names of its `Dialect.options`.
    """

    increment: str | None = None
    block_delete: bool | frozenset[int] = False
    ignore_m: frozenset[int] = frozenset()
    options: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.increment is not None and self.increment not in INCREMENT_SYSTEMS:
            raise ProgramError(f"increment = '{self.increment}'",
                               accepted=", ".join(INCREMENT_SYSTEMS))  # fmt: skip


@dataclass(frozen=True)
class RunOptions:
    """How a program is run.

    Attributes
    ----------
    control : ControlSettings
    max_blocks : int
        Give up after so many blocks.
    fast : bool
        Use the compiled reader for plain motion, where the dialect has it.
    folder : Path or None
        Where programs that are called are looked for.
    """

    control: ControlSettings
    max_blocks: int
    fast: bool
    folder: Path | None = None

    def skips(self, switch: int) -> bool:
        """Whether the blocks of a switch of the optional block skip are skipped."""
        wanted = self.control.block_delete
        return wanted if isinstance(wanted, bool) else switch in wanted
