"""Where a class, and each of its attributes, stands in its file: for messages about plug-ins."""

from __future__ import annotations

import ast
from pathlib import Path

__all__ = ["lines_of_class"]


def lines_of_class(kind: type, file: Path) -> dict[str, int]:
    """1-based line of a class under "", and of its attributes and functions by their names.

    Empty where the file has no class of that name.
    """
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8-sig"))):
        if isinstance(node, ast.ClassDef) and node.name == kind.__name__:
            lines = {"": node.lineno}
            for part in node.body:
                lines |= dict.fromkeys(_names_in(part), part.lineno)
            return lines
    return {}


def _names_in(part: ast.stmt) -> list[str]:
    if isinstance(part, ast.FunctionDef):
        return [part.name]
    if isinstance(part, ast.AnnAssign):
        return [part.target.id] if isinstance(part.target, ast.Name) else []
    if isinstance(part, ast.Assign):
        return [target.id for target in part.targets if isinstance(target, ast.Name)]
    return []
