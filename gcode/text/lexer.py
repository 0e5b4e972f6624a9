"""One line of RS274/NGC text to one block: words, settings, comment, O-word."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from gcode.errors import ProgramError
from gcode.text.expressions import Expression, Reader

__all__ = ["Block", "OWord", "compact", "read_block"]

_WORDS = frozenset("abcdefhijklpqrstxyz@^$")

_PLAIN = re.compile(r"([a-z])([+-]?(?:\d+\.?\d*|\.\d+))")
_LABEL = re.compile(r"/?(?:n\d+(?:\.\d+)?)?")
_CONTROL = re.compile(r"/?(?:n\d+(?:\.\d+)?)?(?:o|m0*9[89](?!\d))")
_KEYWORDS = ("sub", "endsub", "call", "do", "while", "repeat", "if", "elseif", "else", "endif",
             "break", "continue", "endwhile", "endrepeat", "return")  # fmt: skip


@dataclass(slots=True)
class OWord:
    """Control flow in a block.

    Attributes
    ----------
    keyword : str
        ``sub``, ``call``, ... ; ``program`` for a bare O number; ``m98`` and ``m99``.
    name : str or expression
        Name, or the number's expression.
    values : list of expression
        Arguments of a call, the condition, or the returned value.
    """

    keyword: str
    name: str | Expression
    values: list[Expression] = field(default_factory=list)


@dataclass(slots=True)
class Block:
    """What a line says, with expressions not yet evaluated.

    Attributes
    ----------
    words : dict
        Lower-case letter -> value, all letters but G, M, N, O.
    g_codes, m_codes : list of expression
        In the order of the text.
    settings : list of tuple
        Parameter (name or index expression) and value, in the order of the text.
    comment : str or None
        The last comment in parentheses.
    control : OWord or None
        O-word, M98 or M99.
    constant : bool
        No value depends on a parameter.
    """

    words: dict[str, Expression] = field(default_factory=dict)
    g_codes: list[Expression] = field(default_factory=list)
    m_codes: list[Expression] = field(default_factory=list)
    settings: list[tuple[str | Expression, Expression]] = field(default_factory=list)
    comment: str | None = None
    control: OWord | None = None
    constant: bool = True


def compact(text: str) -> str:
    """Lower case without white space outside comments, as the controller reads a line.

    Raises
    ------
    ProgramError
        For a comment that is nested or not closed.
    """
    if "(" not in text and ";" not in text:
        return text.translate(_SQUEEZE).lower()
    pieces, position = [], 0
    while position < len(text):
        character = text[position]
        if character == ";":
            pieces.append(text[position:])
            break
        if character == "(":
            stop = text.find(")", position)
            if stop < 0:
                raise ProgramError("comment is not closed", column=position + 1, hint="add ')'")
            if "(" in text[position + 1 : stop]:
                raise ProgramError("comment inside a comment", column=position + 1)
            pieces.append(text[position : stop + 1])
            position = stop + 1
            continue
        stop = min(
            (at for at in (text.find("(", position), text.find(";", position)) if at >= 0),
            default=len(text),
        )
        pieces.append(text[position:stop].translate(_SQUEEZE).lower())
        position = stop
    return "".join(pieces)


_SQUEEZE = {ord(character): None for character in " \t\r\x0b\x0c"}


def is_control(text: str) -> bool:
    """Tell whether a compact line holds an O-word, M98 or M99 and so may end skipping."""
    return _CONTROL.match(text) is not None


def read_block(text: str, *, in_subroutine: bool = False) -> Block:
    """Read one compact line.

    Parameters
    ----------
    text : str
        From `compact`.
    in_subroutine : bool
        M99 returns from a subroutine rather than ending the program.

    Raises
    ------
    ProgramError
        For anything that is not RS274/NGC.
    """
    block = Block()
    label = _LABEL.match(text)
    reader = Reader(text)
    reader.position = label.end() if label else 0
    rest = text[reader.position :]
    if rest.startswith("o"):
        _read_oword(reader, block)
        return block
    called = re.match(r"m0*(9[89])(?!\d)", rest)
    if called and (called[1] == "98" or in_subroutine):
        reader.position += called.end()
        _read_fanuc_call(reader, block, f"m{called[1]}")
        return block
    while reader.position < len(text):
        _read_item(reader, block)
    return block


def _read_item(reader: Reader, block: Block) -> None:
    """Read one word, parameter setting or comment."""
    text, start = reader.text, reader.position
    plain = _PLAIN.match(text, start)
    if plain:
        reader.position = plain.end()
        _add_word(block, plain[1], float(plain[2]))
        return
    letter = text[start]
    if letter == "(":
        reader.position = text.index(")", start) + 1
        block.comment = text[start + 1 : reader.position - 1]
    elif letter == ";":
        reader.position = len(text)
    elif letter == "#":
        reader.position += 1
        name = reader.parameter_name()
        reader.expect("=", "in a parameter setting")
        block.settings.append((name, reader.value()))
        block.constant = False
    else:
        if not (letter in _WORDS or letter in "gm"):
            hint = "decimals follow a point" if letter == "," else None
            raise ProgramError(
                f"bad character '{letter}'",
                column=start + 1,
                hint=hint,
                accepted="words of RS274/NGC: A-F G H I J K L M P Q R S T X Y Z",
            )
        reader.position += 1
        _add_word(block, letter, reader.value())


def _add_word(block: Block, letter: str, value: Expression) -> None:
    if callable(value):
        block.constant = False
    if letter == "g":
        block.g_codes.append(value)
    elif letter == "m":
        block.m_codes.append(value)
    elif letter not in _WORDS:
        hint = "U V W axes do not exist here" if letter in "uvw" else None
        raise ProgramError(
            f"word '{letter.upper()}' is not known",
            hint=hint,
            accepted="A-F G H I J K L M P Q R S T X Y Z",
        )
    elif letter in block.words:
        raise ProgramError(f"two {letter.upper()} words in one block")
    else:
        block.words[letter] = value


def _read_oword(reader: Reader, block: Block) -> None:
    reader.expect("o", "before a name")
    block.constant = False
    name: str | Expression
    if reader.accept("<"):
        stop = reader.text.find(">", reader.position)
        if stop < 0:
            raise ProgramError("name of the O-word is not closed", hint="write O<name>")
        name, reader.position = reader.text[reader.position : stop], stop + 1
    else:
        name = reader.value()
    keyword = re.match(r"[a-z]*", reader.text[reader.position :])[0]
    keyword = next(
        (k for k in sorted(_KEYWORDS, key=len, reverse=True) if keyword.startswith(k)), keyword
    )
    reader.position += len(keyword)
    if keyword == "" and reader.peek() in ("", "(", ";"):
        keyword = "program"
    elif keyword not in _KEYWORDS:
        raise ProgramError(
            f"unknown command '{keyword or reader.peek()}' after an O-word",
            accepted=" ".join(_KEYWORDS),
        )
    block.control = OWord(keyword, name)
    if keyword in ("while", "if", "elseif", "repeat"):
        if reader.peek() != "[":
            raise ProgramError(f"left bracket missing after '{keyword}'")
        block.control.values.append(reader.bracket())
    elif keyword in ("endsub", "return") and reader.peek() == "[":
        block.control.values.append(reader.bracket())
    while keyword == "call" and reader.peek() in ("[", "("):
        if reader.peek() == "(":
            _read_item(reader, block)
        else:
            block.control.values.append(reader.bracket())
    _read_trailing_comments(reader, block)


def _read_fanuc_call(reader: Reader, block: Block, keyword: str) -> None:
    if keyword == "m99":
        block.control = OWord("m99", "")
        _read_trailing_comments(reader, block)
        return
    while reader.position < len(reader.text):
        _read_item(reader, block)
    if "p" not in block.words:
        raise ProgramError("M98 without a P word", hint="P names the subprogram: M98 P100")
    block.constant = False
    block.control = OWord("m98", block.words["p"])


def _read_trailing_comments(reader: Reader, block: Block) -> None:
    while reader.position < len(reader.text):
        if reader.peek() not in ("(", ";"):
            raise ProgramError(
                f"unexpected '{reader.peek()}' after an O-word",
                column=reader.position + 1,
                accepted="a comment",
            )
        _read_item(reader, block)
