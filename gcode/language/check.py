"""What a dialect must have, looked at when it is loaded."""

from __future__ import annotations

import ast
import difflib
import inspect
import re
from collections.abc import Mapping
from pathlib import Path

from gcode.errors import ProgramError
from gcode.geometry.arc_tolerance import ArcTolerance
from gcode.language.confirmation import TRUTHS
from gcode.language.dialect import Dialect
from gcode.language.translate import Translated
from gcode.writing.block_text import BlockText
from gcode.writing.line_edit import LineEdit

__all__ = ["check_dialect"]

_PATTERN = (re.Pattern, type(None))
#: attribute -> what its value must be
_TYPES = {"name": str, "title": str, "source": str, "synonyms": tuple, "marks": _PATTERN,
          "file_endings": tuple, "rank": int, "is_rs274": bool, "arcs": ArcTolerance,
          "reads": tuple, "own_words": _PATTERN, "unlike": _PATTERN, "flow_lines": _PATTERN,
          "unwritable": _PATTERN, "inch_decimals": int, "ending": frozenset,
          "floating_tap": bool, "is_written": bool, "options": Mapping,
          "confirmed": Mapping}  # fmt: skip
#: attribute -> what class it must be derived from
_CLASSES = {"reader": Translated, "text": BlockText, "edit": LineEdit}
_OBLIGATORY = ("name", "title", "source")
_NAME = re.compile(r"[a-z][a-z0-9_-]*")


def check_dialect(kind: type[Dialect], others: Mapping[str, type[Dialect]]) -> None:
    """Look whether a dialect is complete and says nothing that nobody reads.

    Parameters
    ----------
    kind : type
    others : mapping
        Names and synonyms that are taken.

    Raises
    ------
    ProgramError
        With the file and the line at fault.
    """
    if not (isinstance(kind, type) and issubclass(kind, Dialect)):
        raise ProgramError(f"'{kind}' is no dialect", accepted="a subclass of gcode.Dialect")
    known = {name for name in vars(Dialect) if not name.startswith("_")}
    for name in vars(kind):
        if not name.startswith("_") and name not in known:
            near = difflib.get_close_matches(name, known, 1)
            raise _error(kind, name, f"unknown attribute '{name}'",
                         accepted=", ".join(sorted(known)),
                         hint=f"did you mean '{near[0]}'?" if near else None)  # fmt: skip
    for name in _OBLIGATORY:
        if not vars(kind).get(name):
            raise _error(kind, None, f"dialect {kind.__name__} has no {name}",
                         hint=f'give it a line {name} = "..."')  # fmt: skip
    _check_types(kind)
    unknown = sorted(set(kind.confirmed) - set(TRUTHS))
    if unknown:
        raise _error(kind, "confirmed", f"confirmed by '{unknown[0]}'",
                     accepted=", ".join(TRUTHS))  # fmt: skip
    if not _NAME.fullmatch(kind.name):
        raise _error(kind, "name", f"name = '{kind.name}'", accepted="lower case letters")
    for name in (kind.name, *kind.synonyms):
        if name in others or name == "auto":
            whose = others[name].title if name in others else "recognised from the text"
            raise _error(kind, "name", f"the name '{name}' is taken: {whose}")
    if kind.reader is Translated and kind.run.__func__ is Dialect.run.__func__:
        raise _error(kind, None, f"dialect {kind.__name__} reads nothing",
                     accepted="a reader, or its own run")  # fmt: skip


def _check_types(kind: type[Dialect]) -> None:
    for name, wanted in _TYPES.items():
        value = getattr(kind, name)
        if not isinstance(value, wanted) or (wanted is int and isinstance(value, bool)):
            types = wanted if isinstance(wanted, tuple) else (wanted,)
            accepted = " or ".join(t.__name__.replace("NoneType", "None") for t in types)
            raise _error(kind, name, f"{name} = {value!r}", accepted=accepted)
        if isinstance(value, re.Pattern) and not isinstance(value.pattern, str):
            raise _error(kind, name, f"{name} = {value!r}", accepted="a pattern of text",
                         hint=f"leave the b in front of {value.pattern!r} out")  # fmt: skip
    for name, base in _CLASSES.items():
        value = getattr(kind, name)
        if not (isinstance(value, type) and issubclass(value, base)):
            raise _error(kind, name, f"{name} = {value!r}",
                         accepted=f"a subclass of {base.__name__}")  # fmt: skip


def _error(kind: type, attribute: str | None, what: str, **more: str | None) -> ProgramError:
    file, line = _place(kind, attribute)
    return ProgramError(what, file=file, line=line, **more)


def _place(kind: type, attribute: str | None) -> tuple[Path | None, int | None]:
    """File and line of a class, or of one of its attributes."""
    try:
        file = Path(inspect.getsourcefile(kind) or "")
        tree = ast.parse(file.read_text(encoding="utf-8"))
    except (OSError, TypeError, SyntaxError):
        return None, None
    found = next((n for n in ast.walk(tree)
                  if isinstance(n, ast.ClassDef) and n.name == kind.__name__), None)  # fmt: skip
    if found is None:
        return file, None
    for node in found.body:
        targets = getattr(node, "targets", [getattr(node, "target", None)])
        names = [getattr(t, "id", None) for t in targets] + [getattr(node, "name", None)]
        if attribute is not None and attribute in names:
            return file, node.lineno
    return file, found.lineno
