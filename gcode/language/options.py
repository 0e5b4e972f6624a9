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
    ignore_calls : frozenset of str
        Machine builder's subprograms and measuring cycles that move nothing that counts, as
        ``L_TIME``, ``O9810`` or ``TCH PROBE 411``.
    variables : mapping of str to float
        Values of the machine builder's variables and of machine data, as ``_GUD[2]`` and
        ``$MN_USER_DATA_INT[1]``.
    subprograms : Path or None
        Folder of further subprograms, behind that of the program.
    options : mapping of str to str
        Parameters of one control, by the names of its `Dialect.options`.
    """

    increment: str | None = None
    block_delete: bool | frozenset[int] = False
    ignore_m: frozenset[int] = frozenset()
    ignore_calls: frozenset[str] = frozenset()
    variables: Mapping[str, float] = field(default_factory=dict)
    subprograms: Path | None = None
    options: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.increment is not None and self.increment not in INCREMENT_SYSTEMS:
            raise ProgramError(f"increment = '{self.increment}'",
                               accepted=", ".join(INCREMENT_SYSTEMS))  # fmt: skip

    def ignores(self, name: str) -> bool:
        """Whether a call, by its name in any case of letters, is left out."""
        return name.upper() in {call.upper() for call in self.ignore_calls}


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

    @property
    def folders(self) -> tuple[Path, ...]:
        """Where programs that are called are looked for, first come first."""
        return tuple(f for f in (self.folder, self.control.subprograms) if f is not None)
