"""Text files as users have them: UTF-8 with or without a byte order mark, any line end."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from pathlib import Path

from vmach.errors import InputError

__all__ = ["column_hint", "decimal_number", "read_text"]

#: a number as instruments and CMMs write it; Python's own reading takes 1_000 and other digits too
_DECIMAL = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")


def read_text(path: Path, *, what: str) -> str:
    """Text of a file, line ends as ``\\n``, without a byte order mark.

    Parameters
    ----------
    path : Path
    what : str
        What the file is, for messages: "job file", "error table".

    Raises
    ------
    InputError
        No such file, a folder, not readable, not UTF-8 (with the line).
    """
    try:
        return path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise InputError(f"{what} not found", file=path) from None
    except IsADirectoryError:
        raise InputError(f"{what} is a folder, not a file", file=path) from None
    except UnicodeDecodeError as error:
        raise _not_utf8(path, what, error) from None
    except OSError as error:
        raise InputError(f"{what} cannot be read: {error.strerror}", file=path) from None


def column_hint(header: Sequence[str]) -> str | None:
    """What to do about a CSV heading whose columns are not separated by commas, if so."""
    if any(separator in cell for cell in header for separator in ";\t"):
        return "separate the columns by commas, with a decimal point"
    return None


def decimal_number(cell: str) -> float:
    """Value of a cell that holds a decimal number in plain digits; NaN where it does not."""
    text = cell.strip()
    return float(text) if _DECIMAL.fullmatch(text) else math.nan


def _not_utf8(path: Path, what: str, error: UnicodeDecodeError) -> InputError:
    before = error.object[: error.start]
    if b"\0" in error.object:
        return InputError(
            f"{what} is no text: it holds zero bytes",
            file=path,
            accepted="UTF-8",
            hint="of a spreadsheet, or of a file in UTF-16, save a copy as CSV in UTF-8",
        )
    return InputError(
        f"{what} is not UTF-8: byte 0x{error.object[error.start]:02x}",
        file=path,
        line=before.count(b"\n") + 1,
        accepted="UTF-8",
        hint="save it as UTF-8 in the editor",
    )
