"""The exchange structure of ISO 10303-21 (STEP): text to entities that refer to each other.

Source: ISO 10303-21.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from vmach.errors import InputError
from vmach.nominal.step.lexer import MOST_DIGITS, Statement, read_text, statements, tokens

__all__ = ["Reference", "StepEntity", "StepFile"]

_REAL = r"\s*+([-+]?\d++\.\d*+(?:[eE][-+]?\d++)?)\s*+"
#: most instances are these: points and directions
_TRIPLE = re.compile(
    rf"([A-Za-z_]\w*+)\s*+\(\s*+'([^'\\]*+)'\s*+,\s*+\({_REAL},{_REAL},{_REAL}\)\s*+\)\s*+"
)

_TRUTH = {"T": True, "F": False, "U": None}


class Reference(int):
    """The number of another entity, ``#12``."""


@dataclass(frozen=True)
class StepEntity:
    """One instance: its number and, for each of its types, the list of arguments.

    Simple instances have one type; complex ones (such as rational B-splines) several.
    Arguments are numbers, text, booleans, enumeration words (text), `Reference`, lists, None
    for ``$`` and ``*``, and pairs (type, arguments) for typed values.
    """

    number: int
    parts: dict[str, list]

    @property
    def kind(self) -> str:
        """Name of the type, of the first one for complex instances."""
        return next(iter(self.parts))

    @property
    def arguments(self) -> list:
        """Arguments of the first type."""
        return self.parts[self.kind]

    def is_a(self, name: str) -> bool:
        """Whether the instance has the given type."""
        return name in self.parts


class StepFile:
    """A STEP file whose entities are parsed when they are asked for.

    Parameters
    ----------
    path : Path
    unit_mm : float, optional
        The unit of length, where the file names none.

    Raises
    ------
    InputError
        The file cannot be read, is no STEP file, is cut short or numbers an entity twice.
    """

    def __init__(self, path: Path, unit_mm: float | None = None) -> None:
        self.path, self.unit_mm = path, unit_mm
        self._text = read_text(path)
        self._spans: dict[int, tuple[int, int]] = {}
        self._entities: dict[int, StepEntity] = {}
        self._numbers_of: dict[str, list[int]] = {}
        for statement in statements(self._text, path):
            self._add(statement)
        if not self._spans:
            raise InputError("no entity in the STEP file", file=path)

    def _add(self, statement: Statement) -> None:
        number = statement.number
        if number in self._spans:
            raise InputError(
                f"entity #{number} occurs twice", file=self.path, line=self.line(number)
            )
        self._spans[number] = statement.start, statement.end
        names = [statement.keyword] if statement.keyword else self._parse(number).parts
        for name in names:
            self._numbers_of.setdefault(name, []).append(number)

    def entity(self, reference: int) -> StepEntity:
        """The entity with a number."""
        if reference not in self._entities:
            if reference not in self._spans:
                raise InputError(
                    f"entity #{reference} is referred to but missing",
                    file=self.path,
                    hint="the file is damaged; export it again",
                )
            self._entities[reference] = self._parse(reference)
        return self._entities[reference]

    def of_type(self, name: str) -> Iterator[StepEntity]:
        """All entities that have a type, in the order of the file."""
        return (self.entity(number) for number in self._numbers_of.get(name, ()))

    def error(self, entity: StepEntity, what: str, accepted: str | None = None) -> InputError:
        """An error that names the entity and its line."""
        return InputError(
            f"#{entity.number} {entity.kind}: {what}",
            file=self.path,
            line=self.line(entity.number),
            accepted=accepted,
        )

    def line(self, number: int) -> int:
        """Line of the text on which an entity begins."""
        return self._text.count("\n", 0, self._spans[number][0]) + 1

    def _parse(self, number: int) -> StepEntity:
        start, end = self._spans[number]
        try:
            return StepEntity(number, _parse_instance(self._text[start:end]))
        except (ValueError, IndexError, RecursionError):
            raise InputError(
                f"entity #{number} cannot be parsed", file=self.path, line=self.line(number)
            ) from None


def _parse_instance(text: str) -> dict[str, list]:
    if triple := _TRIPLE.fullmatch(text):
        return {
            triple[1].upper(): [triple[2], [float(triple[3]), float(triple[4]), float(triple[5])]]
        }
    found = tokens(text)
    kind, value = found[0]
    if kind == "keyword":
        arguments, end = _parse_list(found, 1)
        parts = {value.upper(): arguments}
    else:
        parts, end = {}, 1
        while found[end] != ("mark", ")"):
            if found[end][0] != "keyword":
                raise ValueError(f"a type was expected, not {found[end][1]!r}")
            name = found[end][1].upper()
            parts[name], end = _parse_list(found, end + 1)
        end += 1
    if end != len(found) or not parts:
        raise ValueError(f"text after the entity: {found[-1][1]!r}")
    return parts


def _parse_list(found: list[tuple[str, str]], at: int) -> tuple[list, int]:
    """Values between the bracket at `at` and the one that closes it, and the place after it."""
    if found[at] != ("mark", "("):
        raise ValueError(f"a bracket was expected, not {found[at][1]!r}")
    at, values = at + 1, []
    while found[at] != ("mark", ")"):
        if values and found[at] == ("mark", ","):
            at += 1
        value, at = _parse_value(found, at)
        values.append(value)
    return values, at + 1


def _parse_value(found: list[tuple[str, str]], at: int) -> tuple[object, int]:
    kind, text = found[at]
    if kind == "keyword":
        values, end = _parse_list(found, at + 1)
        return (text.upper(), values), end
    if (kind, text) == ("mark", "("):
        return _parse_list(found, at)
    if kind == "mark" and text not in "*$":
        raise ValueError(f"a value was expected, not {text!r}")
    return _VALUES[kind](text), at + 1


def _integer(text: str) -> int:
    if len(text) > MOST_DIGITS + 1:  # a sign is one more
        raise ValueError(f"a whole number of {len(text)} digits")
    return int(text)


_VALUES = {
    "string": lambda text: text[1:-1].replace("''", "'"),
    "reference": lambda text: Reference(text),
    "word": lambda text: _TRUTH.get(text.upper(), text.upper()),
    "real": float,
    "integer": _integer,
    "binary": str,
    "mark": lambda text: None,
}
