"""The error that a program's text can cause."""

from __future__ import annotations

from pathlib import Path

__all__ = ["ProgramError", "UnknownToolError"]

#: characters of a block that a message shows
_SHOWN = 60


class ProgramError(ValueError):
    """A program, or a file that goes with it, cannot be read or obeyed.

    The message reads ``FILE:LINE: what: 'BLOCK'; accepted: ... (hint: ...)``.

    Parameters
    ----------
    what : str
        What is wrong, with the value or the word.
    file : path, optional
        The file at fault.
    line : int, optional
        1-based line in `file`.
    column : int, optional
        1-based column of the word at fault.
    accepted : str, optional
        What would be accepted.
    hint : str, optional
        What to do about it.
    """

    def __init__(
        self,
        what: str,
        *,
        file: str | Path | None = None,
        line: int | None = None,
        column: int | None = None,
        accepted: str | None = None,
        hint: str | None = None,
    ) -> None:
        self.what, self.file, self.line, self.column = what, file, line, column
        self.accepted, self.hint, self.block = accepted, hint, ""
        super().__init__(what)

    def located(self, *, file: str | Path | None, line: int | None) -> ProgramError:
        """Fill in where it happened, unless that is known already; returns the error itself."""
        self.file = file if self.file is None else self.file
        self.line = line if self.line is None else self.line
        return self

    def in_block(self, text: str) -> ProgramError:
        """Show the block at fault; returns the error itself."""
        text = text.strip()
        self.block = text if len(text) <= _SHOWN else text[:_SHOWN] + "..."
        return self

    def __str__(self) -> str:
        parts = [str(self.file)] if self.file is not None else []
        parts += [str(n) for n in (self.line, self.column) if n is not None] if parts else []
        text = ":".join(parts) + ": " + self.what if parts else self.what
        if self.block and self.block not in self.what:
            text += f": '{self.block}'"
        if self.accepted:
            text += f"; accepted: {self.accepted}"
        if self.hint:
            text += f" (hint: {self.hint})"
        return text


class UnknownToolError(ProgramError):
    """A program asks for a tool that is not in the tool table.

    Attributes
    ----------
    number : int or None
        The tool that the table lacks; None where the program says a name, or means an offset.
    """

    number: int | None = None
