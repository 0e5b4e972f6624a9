"""The words of one line as they stand in its text, expressions included."""

from __future__ import annotations

from collections.abc import Iterator

from gcode.text.expressions import Reader
from gcode.text.lexer import compact

__all__ = ["block_items"]


def block_items(line: str) -> Iterator[tuple[str, str]]:
    """Split a block of RS274/NGC into its items, in the order of the text.

    Parameters
    ----------
    line : str
        Without its line ending.

    Yields
    ------
    tuple of str
        What it is and its text without blanks, in lower case: a letter in upper case and the
        text of the word's value (a number or an expression); ``(`` or ``;`` and a comment as it
        stands; ``#`` and a parameter setting; ``/``.

    Raises
    ------
    ProgramError
        The line is no block: O-words and calls are not split.
    """
    text = compact(line)
    reader = Reader(text)
    while reader.position < len(text):
        start = reader.position
        kind = text[start]
        if kind == "(":
            reader.position = text.index(")", start) + 1
        elif kind == ";":
            reader.position = len(text)
        else:
            reader.position += 1
            if kind == "#":
                reader.parameter_name()
                reader.expect("=", "in a parameter setting")
            if kind != "/":
                reader.value()
        whole = kind in "(;#/"
        yield kind.upper(), text[start if whole else start + 1 : reader.position]
