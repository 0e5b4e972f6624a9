"""Which control a program was written for."""

from __future__ import annotations

import re
from pathlib import Path

from gcode.errors import ProgramError

__all__ = ["DIALECTS", "SYNONYMS", "choose_dialect", "detect_dialect", "dialect_name",
           "dialect_of"]  # fmt: skip

#: Controls by name: whose language a program is written in.
DIALECTS = ("linuxcnc", "fanuc", "haas", "sinumerik", "heidenhain")

#: Other names that are accepted: of the language, of the maker.
SYNONYMS = {"rs274": "linuxcnc", "siemens": "sinumerik", "klartext": "heidenhain"}

#: Only so much of a program is searched for the words of a dialect, bytes.
_HEAD = 30_000
_FLAGS = re.IGNORECASE | re.MULTILINE
_START = r"^[ \t]*(?:N?\d+[ \t]+)?"  # line or block number
_HEIDENHAIN = re.compile(_START + r"(?:BEGIN PGM|BLK FORM|TOOL CALL|CYCL DEF)\b", _FLAGS)
_SINUMERIK = re.compile(
    r"^[ \t]*(?:%_N_\w+|;\$PATH=)"
    rf"|{_START}(?:DEF[ \t]+(?:REAL|INT|BOOL|STRING)|PROC[ \t]|EXTERN[ \t]|ENDFOR|ENDWHILE"
    r"|STOPRE|WORKPIECE[ \t]*\(|CYCLE\d+[ \t]*\(|TRANS[ \t]|ATRANS[ \t]|MSG[ \t]*\(\")"
    r"|^[^(;\n]*\b(?:[XYZFS]|CR|TURN|AP|RP)[ \t]*=[ \t]*[-+.\dA-Z]",
    _FLAGS,
)
_FANUC = re.compile(
    r"^[ \t]*(?:N\d+[ \t]*)?(?:IF[ \t]*\[[^\n]*\][ \t]*(?:GOTO|THEN)|WHILE[ \t]*\[[^\n]*\][ \t]*DO"
    r"|GOTO[ \t]*[\d#\[]|END[ \t]*[123]\b)|^[^(;\n]*\bG0*6[56](?![\d.])",
    _FLAGS,
)


def detect_dialect(text: str) -> str:
    """Guess the dialect of a program from words that no other dialect has."""
    if _HEIDENHAIN.search(text):
        return "heidenhain"
    if _FANUC.search(text):
        return "fanuc"
    return "sinumerik" if _SINUMERIK.search(text) else "linuxcnc"


def dialect_name(name: str) -> str:
    """The one name of a dialect, or ``auto``.

    Raises
    ------
    ProgramError
        There is no such dialect.
    """
    found = SYNONYMS.get(name.lower(), name.lower())
    if found not in ("auto", *DIALECTS):
        raise ProgramError(f"unknown dialect '{name}'", accepted="auto, " + ", ".join(DIALECTS))
    return found


def dialect_of(path: str | Path, name: str = "auto") -> str:
    """The dialect in which `read_program` will read a file; arguments and errors as there."""
    with Path(path).open("rb") as file:
        return choose_dialect(name, file.read(_HEAD))


def choose_dialect(name: str, data: bytes) -> str:
    """Return the dialect asked for, or detect it for ``auto``; raises ProgramError."""
    found = dialect_name(name)
    return detect_dialect(data[:_HEAD].decode("latin-1")) if found == "auto" else found
