"""TOML files read into checked records; every complaint names file, line and key."""

from __future__ import annotations

import difflib
import re
import tomllib
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import Annotated, Any, TypeVar

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    Strict,
    TypeAdapter,
    ValidationError,
)
from pydantic_core import PydanticCustomError

from vmach.errors import InputError
from vmach.files.mistaken_file import mistaken_for
from vmach.files.text_file import read_text

__all__ = [
    "FileSection",
    "Finite",
    "Flag",
    "NonNegative",
    "Point",
    "Positive",
    "Whole",
    "check_section",
    "complaints",
    "line_of_key",
    "numbers_once",
    "read_toml",
    "read_toml_and_text",
]

#: beyond this a number in a file is a slip, whatever its unit: a kilometre, a radian in urad
_LARGEST = 1e6
#: and so is a number above 0 that is less: a picometre in mm. Its square divides, and may be 0
_SMALLEST = 1e-9

#: of a TOML file; those of the samples have less than a hundredth. Python reads as much in 5 s
_LARGEST_TOML_BYTES = 2**20
#: each is looked for in the whole text, and nobody reads more
_MOST_COMPLAINTS = 100
#: characters of a line or a value that a message shows
_LONGEST_QUOTE = 120


def _at_least(smallest: float, value: float) -> float:
    if value < smallest:
        raise ValueError(f"accepted: {smallest:g} or more")
    return value


_Number = Annotated[float, Strict()]  # "10" and true are no numbers
Finite = Annotated[_Number, Field(ge=-_LARGEST, le=_LARGEST, allow_inf_nan=False)]
Positive = Annotated[
    _Number,
    Field(gt=0, le=_LARGEST, allow_inf_nan=False),
    AfterValidator(lambda value: _at_least(_SMALLEST, value)),
]
NonNegative = Annotated[_Number, Field(ge=0, le=_LARGEST, allow_inf_nan=False)]
Flag = Annotated[bool, Strict()]
Whole = Annotated[int, Strict(), Field(ge=1)]
Point = tuple[Finite, Finite, Finite]

#: as pydantic reads a number that is a key; and its type of complaint where one is there twice
_WHOLE, _TWICE = TypeAdapter(int), "named_twice"

#: what pydantic asks for, by its type of complaint, in the words of this program
_ACCEPTED = {
    "bool_type": "true or false",
    "dict_type": "a table",
    "finite_number": "a finite number",
    "float_type": "a number",
    "int_type": "a whole number",
    "int_parsing": "a whole number",
    "list_type": "a list in brackets",
    "model_type": "a table",
    "string_type": "text in quotes",
    "tuple_type": "a list in brackets",
    "int_from_float": "a whole number",
    "date_type": "a date: 2025-01-31",
    "date_parsing": "a date: 2025-01-31",
    "date_from_datetime_parsing": "a date: 2025-01-31",
    "date_from_datetime_inexact": "a date: 2025-01-31",
    "string_too_short": "text in quotes, not empty",
    "string_pattern_mismatch": "text of the form {pattern}",
    "too_long": "a list of {max_length}",
    "too_short": "a list of {min_length} or more",
}


def numbers_once(what: str) -> BeforeValidator:
    """Refuse a table whose keys are numbers and that spells one of them twice, as 1 and 01.

    Parameters
    ----------
    what : str
        What a number is of, for messages: "tool".
    """

    def check(table: Any) -> Any:
        seen: set[int] = set()
        for key in table if isinstance(table, Mapping) else ():
            try:
                number = _WHOLE.validate_python(key)
            except ValidationError:  # told by the keys' own check
                continue
            if number in seen:
                said = {"what": what, "number": number, "key": key}
                raise PydanticCustomError(_TWICE, "{what} {number} is named twice", said)
            seen.add(number)
        return table

    return BeforeValidator(check)


class FileSection(BaseModel):
    """A table of a TOML file: unknown keys and values of another type are errors."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=False)


Section = TypeVar("Section", bound=FileSection)


def read_toml(path: Path, schema: type[Section], *, what: str) -> Section:
    """Read a TOML file and check it against a schema.

    Parameters
    ----------
    path : Path
    schema : subclass of FileSection
    what : str
        What the file is, for messages: "job file", "machine file".

    Raises
    ------
    InputError
        Missing file, no TOML, unknown key, wrong type or value; with line and key.
    """
    return read_toml_and_text(path, schema, what=what)[0]


def read_toml_and_text(path: Path, schema: type[Section], *, what: str) -> tuple[Section, str]:
    """Like `read_toml`, with the text in which `line_of_key` finds what is complained of later.

    The file is read once, so that both are of the same state of it.

    Raises
    ------
    InputError
        The file is missing, no TOML, or not what its schema asks for.
    """
    text = read_text(path, what=what, largest_bytes=_LARGEST_TOML_BYTES)
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise mistaken_for(path, text, None, what=what) or _not_toml(
            path, what, text, error
        ) from None
    except ValueError:  # Python refuses to convert more than 4,300 digits
        raise InputError(f"{what} has a number of too many digits", file=path) from None
    except RecursionError:
        raise InputError(f"{what} has lists or tables nested too deeply", file=path) from None
    if mistaken := mistaken_for(path, text, data, what=what):
        raise mistaken
    return check_section(data, schema, file=path, text=text), text


def _not_toml(path: Path, what: str, text: str, error: tomllib.TOMLDecodeError) -> InputError:
    """Say where it stops to be TOML, with the line as it stands in files called ``.toml`` only.

    Any other may have been named by mistake, and what is in it is nobody else's business.
    """
    found = re.search(r"at line (\d+)", str(error))
    line = int(found.group(1)) if found else None
    written = text.splitlines()[line - 1].strip() if line else "the end of the file"
    place = f" at '{written[:_LONGEST_QUOTE]}'" if path.suffix == ".toml" else ""
    return InputError(
        f"{what} is not valid TOML{place}: {error}",
        file=path,
        line=line,
        hint="text stands in quotes, numbers have a decimal point",
    )


def check_section(
    data: Mapping[str, Any],
    schema: type[Section],
    *,
    file: Path,
    text: str,
    within: Sequence[str] = (),
) -> Section:
    """Check a table of a TOML file against a schema.

    Parameters
    ----------
    data : mapping
        The table.
    schema : subclass of FileSection
    file, text : Path, str
        Where the table stands, for messages.
    within : sequence of str
        Keys that lead to the table.

    Raises
    ------
    InputError
        Unknown key, wrong type or value; with line and key.
    """
    try:
        return schema.model_validate(data)
    except ValidationError as error:
        first = next(_complaints(error, data, schema, file=file, text=text, within=within))
        raise first from None


def complaints(path: Path, schema: type[Section], *, what: str) -> list[InputError]:
    """All that a TOML file has wrong, 100 at most, where `read_toml` raises the first."""
    try:
        text = read_text(path, what=what, largest_bytes=_LARGEST_TOML_BYTES)
        data = tomllib.loads(text)
        if mistaken := mistaken_for(path, text, data, what=what):
            return [mistaken]
        schema.model_validate(data)
    except ValidationError as error:
        found = _complaints(error, data, schema, file=path, text=text)
        return list(islice(found, _MOST_COMPLAINTS))
    except InputError as error:
        return [error]
    except (ValueError, RecursionError):
        try:
            read_toml(path, schema, what=what)
        except InputError as error:
            return [error]
    return []


def _complaints(
    error: ValidationError,
    data: Mapping[str, Any],
    schema: type[Section],
    *,
    file: Path,
    text: str,
    within: Sequence[str] = (),
) -> Iterator[InputError]:
    """One error a complaint; a misspelt key is also a missing one, so what was written is first.

    Each looks through the text for its line, so that no more are made than are asked for.
    """
    found = [(_keys_of(complaint, data), complaint) for complaint in error.errors()]
    told = sorted(_of_each_value(found), key=lambda one: one[1]["type"] != "extra_forbidden")
    for keys, complaint, accepted in told:
        line = line_of_key(text, [*within, *keys])
        yield _complaint(complaint, keys, schema, accepted=accepted, file=file, line=line)


def _of_each_value(
    found: Sequence[tuple[list[str], Mapping[str, Any]]],
) -> Iterator[tuple[list[str], Mapping[str, Any], str]]:
    """One complaint a value, with all that is accepted there, where a value may be of two kinds.

    Of a table or list that is of the right kind, what is wrong inside alone counts.
    """
    accepted: dict[tuple[str, ...], list[str]] = {}
    for keys, complaint in found:
        accepted.setdefault(tuple(keys), []).append(_accepted(complaint))
    seen = set()
    for keys, complaint in found:
        here = tuple(keys)
        inside = any(len(o) > len(here) and o[: len(here)] == here for o in accepted)
        if inside or here in seen:
            continue
        seen.add(here)
        yield keys, complaint, ", or ".join(dict.fromkeys(accepted[here]))


def _keys_of(complaint: Mapping[str, Any], data: Mapping[str, Any]) -> list[str]:
    """Keys that lead to what is wrong, without pydantic's own words for kinds of values."""
    keys: list[str] = []
    here: Any = data
    for part in complaint["loc"]:
        try:
            here = here[part]
        except (KeyError, IndexError, TypeError):  # not in the file
            if complaint["type"] != "missing":
                continue
        keys.append(str(part))
    return [*keys, complaint["ctx"]["key"]] if complaint["type"] == _TWICE else keys


def _complaint(
    first: Mapping[str, Any],
    keys: list[str],
    schema: type[FileSection],
    *,
    accepted: str,
    file: Path,
    line: int | None,
) -> InputError:
    where: dict[str, Any] = {"file": file, "line": line}
    dotted = ".".join(keys)
    known = _known_keys(schema, keys[:-1])
    if first["type"] == "extra_forbidden":
        close = difflib.get_close_matches(keys[-1], known, n=1)
        hint = f"did you mean '{close[0]}'?" if close else None
        what = f"unknown key '{dotted}'"
        return InputError(what, **where, accepted=", ".join(known), hint=hint)
    if first["type"] == _TWICE:
        return InputError(first["msg"], **where, accepted="every number once", hint="take one out")
    if first["type"] == "missing" and keys[-1].isdigit():
        what = f"'{'.'.join(keys[:-1])}' = {_value(first['input'])}"
        return InputError(what, **where, accepted="a longer list")
    if first["type"] == "missing":
        return InputError(f"key '{dotted}' is missing", **where, accepted=", ".join(known))
    what = f"'{dotted}' = {_value(first['input'])}"
    return InputError(what, **where, accepted=accepted)


def _value(found: Any) -> str:
    """A value as a message tells it: of a long table or list its beginning."""
    text = repr(found)
    return text if len(text) <= _LONGEST_QUOTE else f"{text[:_LONGEST_QUOTE]} …"


def _accepted(complaint: Mapping[str, Any]) -> str:
    message: str = complaint["msg"].removeprefix("Value error, ").removeprefix("accepted: ")
    words = _ACCEPTED.get(complaint["type"])
    if words is None:
        return message.removeprefix("Input should be ")
    return words.format(**complaint.get("ctx", {}))


def _known_keys(schema: type[FileSection], keys: list[str]) -> list[str]:
    """Names accepted in the table that `keys` lead to, as far as the schema tells."""
    current: type[FileSection] = schema
    for key in keys:
        fields = getattr(current, "model_fields", {})
        names = {(field.alias or name): field for name, field in fields.items()}
        if key in names:
            current = _section_in(names[key].annotation) or current
    return [field.alias or name for name, field in current.model_fields.items()]


def _section_in(annotation: object) -> type[FileSection] | None:
    """The `FileSection` inside an annotation such as ``dict[str, Tool] | None``."""
    if isinstance(annotation, type) and issubclass(annotation, FileSection):
        return annotation
    for part in getattr(annotation, "__args__", ()):
        found = _section_in(part)
        if found is not None:
            return found
    return None


#: one part of a dotted key, which may stand in quotes; and a line that sets a key
_KEY_PART = re.compile(r"\"[^\"]*\"|'[^']*'|[^.\s\"']+")
_ASSIGNMENT = re.compile(rf"\s*((?:{_KEY_PART.pattern})(?:\s*\.\s*(?:{_KEY_PART.pattern}))*)\s*=")


def line_of_key(text: str, keys: list[str]) -> int | None:
    """1-based line where a dotted key, or the table closest to it, is written.

    Tables in an array are counted from 0: ``["measurements", "1", "kind"]``.
    """
    table: list[str] = []
    best, depth = None, 0
    seen: Counter[str] = Counter()
    for number, line in enumerate(text.splitlines(), 1):
        header = re.match(r"\s*(\[+)\s*([^\]]+?)\s*\]+", line)
        assignment = _ASSIGNMENT.match(line)
        if header:
            table = _split_key(header.group(2))
            if header.group(1) == "[[":
                seen[header.group(2)] += 1
                table = [*table, str(seen[header.group(2)] - 1)]
            here = table
        elif assignment:
            here = table + _split_key(assignment.group(1))
        else:
            continue
        path = [key for key in keys if not key.isdigit() or key in here]
        shared = min(len(here), len(path))
        if here[:shared] == path[:shared] and shared > depth:
            best, depth = number, shared
    return best


def _split_key(dotted: str) -> list[str]:
    return [part.strip("\"'") for part in _KEY_PART.findall(dotted)]
