"""The text of an exchange structure (ISO 10303-21) cut into statements and tokens.

All patterns are possessive: they give nothing back, so the time grows with the length of the text
whatever it holds.

Source: ISO 10303-21.
"""

from __future__ import annotations

import codecs
import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from vmach.errors import InputError
from vmach.files.text_file import read_bytes

__all__ = ["MOST_DIGITS", "Statement", "read_text", "statements", "tokens"]

#: Between apostrophes; one inside is written twice. The control directive ``\S\'`` is a section
#: sign, but a path in a text may end in ``\S\`` as well: then a bracket or comma follows.
_INSIDE = r"(?:[^'\\]++|''|\\S\\'(?!\s*+[,)])|\\)*+"
_STRING = rf"'{_INSIDE}'"

#: a text can only be an argument or the end of a list
_ARGUMENT = rf"{_STRING}(?=\s*+[,)}}])"

_BODY = re.compile(rf"(?:{_ARGUMENT}|[^';]++)*+")
_STATEMENT = re.compile(
    rf"\s*+(?:#(?P<number>\d++)\s*+=\s*+)?+"
    rf"(?P<body>(?P<keyword>!?[A-Za-z_][\w-]*+)?+(?:{_ARGUMENT}|[^';]++)*+);"
)
_STRING_OR_COMMENT = re.compile(rf"{_STRING}|/\*")
_TOKEN = re.compile(
    rf"\s*+(?:(?P<string>{_STRING})|\#(?P<reference>\d++)|\.(?P<word>\w++)\."
    r"|(?P<real>[-+]?\d++\.\d*+(?:[eE][-+]?\d++)?)|(?P<integer>[-+]?\d++)"
    r'|(?P<keyword>!?[A-Za-z_]\w*+)|(?P<binary>"[0-9A-Fa-f]*+")|(?P<mark>[(),*$])|(?P<unknown>\S))'
)
_END = "END-ISO-10303-21"

#: an entity's number, and any other whole one, fits 64 bits
MOST_DIGITS = 18

#: so much of a text is repeated in a message
_SHOWN = 40


class Statement(NamedTuple):
    """One instance of an entity.

    Attributes
    ----------
    number : int
        Of the instance, ``#12``.
    keyword : str or None
        Name of its type in capitals; None for complex instances.
    start, end : int
        Where its text, without the number, lies in the whole one.
    """

    number: int
    keyword: str | None
    start: int
    end: int


def read_text(path: Path) -> str:
    """Text of a STEP file without its comments, whose line breaks stay.

    Raises
    ------
    InputError
        The file cannot be read, is no STEP file, is cut short or has a comment without an end.
    """
    data = read_bytes(path, what="nominal CAD").removeprefix(codecs.BOM_UTF8)
    text = data.decode("latin-1").replace("\r\n", "\n")
    if not text.lstrip().startswith("ISO-10303-21"):
        raise InputError(
            f"not a STEP file: it begins with {text.lstrip()[:_SHOWN]!r}",
            file=path,
            accepted="a file that begins with ISO-10303-21;",
        )
    if _END not in text[-2000:]:
        raise InputError(
            f"the STEP file is cut short: {_END} is missing",
            file=path,
            line=text.count("\n") + 1,
            hint="copy or export it again",
        )
    return _without_comments(text, path) if "/*" in text else text


def _without_comments(text: str, path: Path) -> str:
    kept, position = [], 0
    while match := _STRING_OR_COMMENT.search(text, position):
        kept.append(text[position : match.start()])
        end = match.end()
        if match[0] == "/*":
            end = text.find("*/", match.end()) + 2
            if end == 1:
                raise InputError(
                    f"a comment without an end: {text[match.start() :][:_SHOWN]!r}",
                    file=path,
                    line=_line(text, match.start()),
                    accepted="/* ... */",
                )
            kept.append("\n" * text.count("\n", match.start(), end) or " ")
        else:
            kept.append(match[0])
        position = end
    return "".join([*kept, text[position:]])


def statements(text: str, path: Path) -> Iterator[Statement]:
    """The instances of a text in their order; headers and names of sections are passed over.

    Raises
    ------
    InputError
        A text in apostrophes without an end, or one that holds a single apostrophe.
    """
    position = 0
    while match := _STATEMENT.match(text, position):
        number, keyword = match["number"], match["keyword"]
        if number is not None:
            if len(number) > MOST_DIGITS:
                raise InputError(
                    f"an entity numbered with {len(number)} digits",
                    file=path,
                    line=_line(text, match.start("number")),
                    accepted=f"at most {MOST_DIGITS} digits",
                )
            name = keyword.upper() if keyword else None
            yield Statement(int(number), name, *match.span("body"))
        elif text.startswith(_END, match.start("body")):
            return
        position = match.end()
    _check_rest(text, position, path)


def _check_rest(text: str, position: int, path: Path) -> None:
    """Say what ended the statements at a position."""
    start = _BODY.match(text, position).end()
    if start == len(text):
        if not text[position:].strip():
            return
        raise InputError(
            f"a statement without a semicolon: {text[position:].strip()[:_SHOWN]!r}",
            file=path,
            line=_line(text, position),
            accepted=";",
        )
    string = re.compile(_STRING).match(text, start)
    end = len(text) if string is None else string.end()
    shown = text[start:end] if end - start <= _SHOWN else text[start : start + _SHOWN] + "..."
    what = "does not end" if string is None else f"is followed by {text[end : end + 8].strip()!r}"
    raise InputError(
        f"the text {shown.splitlines()[0]} {what}",
        file=path,
        line=_line(text, start),
        accepted="a text between apostrophes, then a comma or a bracket",
        hint="an apostrophe inside a text is written twice: 'Bob''s nut'",
    )


def _line(text: str, position: int) -> int:
    return text.count("\n", 0, position) + 1


def tokens(text: str) -> list[tuple[str, str]]:
    """Kind and text of each token of an instance.

    Raises
    ------
    ValueError
        A character that belongs to no token.
    """
    found = [(match.lastgroup, match[match.lastindex]) for match in _TOKEN.finditer(text)]
    for kind, token in found:
        if kind == "unknown":
            raise ValueError(f"unknown token {token!r}")
    return found
