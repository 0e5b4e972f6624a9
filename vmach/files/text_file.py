"""Text files as users have them: UTF-8 with or without a byte order mark, any line end."""

from __future__ import annotations

import csv
import math
import re
import stat
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from vmach.errors import InputError

__all__ = [
    "DECIMAL_COMMA_HINT",
    "as_written",
    "column_hint",
    "csv_rows",
    "decimal_number",
    "numbered_csv_rows",
    "read_bytes",
    "read_text",
]

#: a number as instruments and CMMs write it; Python's own reading takes 1_000 and other digits too
_DECIMAL = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")

#: what may have made more cells of a row than its heading has
DECIMAL_COMMA_HINT = "is there a decimal comma? Numbers need a point"
#: of a file that is read whole: ten million rows of points have about as many bytes
_LARGEST_BYTES = 2**30


def read_text(path: Path, *, what: str, largest_bytes: int = _LARGEST_BYTES) -> str:
    """Text of a file, line ends as ``\\n``, without a byte order mark.

    Parameters
    ----------
    path : Path
    what : str
        What the file is, for messages: "job file", "error table".
    largest_bytes : int
        Size that is still read.

    Raises
    ------
    InputError
        As `read_bytes`; or not UTF-8 (with the line).
    """
    try:
        text = read_bytes(path, what=what, largest_bytes=largest_bytes).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise _not_utf8(path, what, error) from None
    return text.replace("\r\n", "\n").replace("\r", "\n")


def as_written(text: str, path: Path) -> bytes:
    """A text with the line ends, and the byte order mark, of the file whose place it takes.

    Of a file with both kinds of line ends, the more frequent ones.
    """
    before = path.read_bytes()
    ends = before.count(b"\r\n")
    if ends > before.count(b"\n") - ends:
        text = text.replace("\n", "\r\n")
    return (b"\xef\xbb\xbf" if before.startswith(b"\xef\xbb\xbf") else b"") + text.encode()


def read_bytes(path: Path, *, what: str, largest_bytes: int = _LARGEST_BYTES) -> bytes:
    """Content of a file. A device or a pipe, which may never end, is not opened.

    Parameters
    ----------
    path : Path
    what : str
        What the file is, for messages.
    largest_bytes : int
        Size that is still read.

    Raises
    ------
    InputError
        No such file, a folder, a device, not readable, too large.
    """
    try:
        mode = path.stat().st_mode
        if stat.S_ISDIR(mode):
            raise InputError(f"{what} is a folder, not a file", file=path)
        if not stat.S_ISREG(mode):
            raise InputError(
                f"{what} is a device or a pipe, not a file",
                file=path,
                hint="save its content as a file first",
            )
        with path.open("rb") as file:
            content = file.read(largest_bytes + 1)
    except FileNotFoundError:
        raise InputError(f"{what} not found", file=path) from None
    except OSError as error:
        raise InputError(f"{what} cannot be read: {error.strerror}", file=path) from None
    except InputError:
        raise
    except ValueError:  # what the system says to a zero byte
        raise InputError(f"{what} has a zero byte in its name", file=path) from None
    if len(content) > largest_bytes:
        accepted = f"at most {largest_bytes / 2**20:g} MiB"
        raise InputError(f"{what} is too large", file=path, accepted=accepted)
    return content


def check_is_file(path: Path, *, what: str) -> None:
    """Refuse what a program reads itself, where it is no file.

    Raises
    ------
    InputError
        No such file, a folder, a device.
    """
    if path.is_dir():
        raise InputError(f"{what} is a folder, not a file", file=path, accepted="a file")
    if not path.exists():
        raise InputError(f"{what} not found", file=path)
    if not path.is_file():
        raise InputError(f"{what} is a device or a pipe, not a file", file=path, accepted="a file")


def csv_rows(lines: Iterable[str], path: Path) -> Iterator[list[str]]:
    """Rows of a CSV file, as `csv.reader` gives them.

    Raises
    ------
    InputError
        A cell of more than 131,072 characters; with the line.
    """
    return (row for _, row in numbered_csv_rows(lines, path))


def numbered_csv_rows(
    lines: Iterable[str], path: Path, *, strict: bool = False
) -> Iterator[tuple[int, list[str]]]:
    """The same with the line that each row ends on.

    Parameters
    ----------
    lines : iterable of str
    path : Path
        The file, for messages.
    strict : bool
        Whether a quotation mark without its partner is refused.

    Raises
    ------
    InputError
    """
    reader = csv.reader(lines, strict=strict)
    ended = 0
    try:
        for row in reader:
            yield reader.line_num, row
            ended = reader.line_num
    except csv.Error as error:
        raise InputError(
            f"no row of a CSV file: {error}",
            file=path,
            line=ended + 1,
            hint="look for a quotation mark without its partner",
        ) from None


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
