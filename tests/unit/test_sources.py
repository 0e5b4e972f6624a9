"""Every file that states physics or a procedure of a standard names its source.

The source is a paragraph ``Source: ...`` of the module's docstring, or the class attribute `source`
of each effect: a standard, a paper, a textbook, a manual, or "closed form derived here: ..." with
the derivation in a line.
"""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

from vmach.effects.catalogue import catalogue

ROOT = Path(__file__).parents[2]

ROOMS = (
    "gcode/geometry",
    "gcode/motion",
    "gcode/moves",
    "stock/collision",
    "stock/exact",
    "stock/solid",
    "vmach/compensation",
    "vmach/controller_tables",
    "vmach/effects/laws",
    "vmach/features",
    "vmach/fit",
    "vmach/instruments/kinds",
    "vmach/iso230",
    "vmach/machine",
    "vmach/measurements",
    "vmach/nominal",
    "vmach/path",
    "vmach/prediction",
    "vmach/volumetric",
)

#: files of these rooms that calculate, but only to read, write, print or order the work of others
WITHOUT_PHYSICS = {
    "vmach/compensation/compensate.py",
    "vmach/compensation/figures.py",
    "vmach/controller_tables/figures.py",
    "vmach/controller_tables/make_tables.py",
    "vmach/controller_tables/table_task.py",
    "vmach/features/feature.py",
    "vmach/features/result.py",
    "vmach/machine/counted_positions.py",
    "vmach/machine/files/machine_file.py",
    "vmach/machine/from_arrays.py",
    "vmach/machine/single_errors.py",
    "vmach/nominal/part.py",
    "vmach/nominal/patches.py",
    "vmach/nominal/points.py",
    "vmach/volumetric/pictures.py",
    "vmach/volumetric/printing.py",
    "vmach/volumetric/volume_text.py",
}

SOURCE = re.compile(r"^Source: \S", re.MULTILINE)


def modules():
    for room in ROOMS:
        for path in sorted((ROOT / room).rglob("*.py")):
            if path.name != "__init__.py":
                yield path.relative_to(ROOT).as_posix()


def names_a_source(text: str) -> bool:
    """Whether a module names its source for all that it states, or for each of its classes."""
    tree = ast.parse(text)
    if SOURCE.search(ast.get_docstring(tree) or ""):
        return True
    classes = [node for node in tree.body if isinstance(node, ast.ClassDef)]
    stated = [c for c in classes if any(_is_source(line) for line in c.body)]
    return bool(stated)


def calculates(text: str) -> bool:
    """Whether a module multiplies, divides or raises to a power; a path's slash has text in it."""
    products = (ast.Mult, ast.Div, ast.Pow, ast.MatMult)
    return any(
        isinstance(node, ast.BinOp)
        and isinstance(node.op, products)
        and not any(_is_text(side) for side in (node.left, node.right))
        for node in ast.walk(ast.parse(text))
    )


def _is_text(node: ast.expr) -> bool:
    said = node.value if isinstance(node, ast.Constant) else None
    return isinstance(node, ast.JoinedStr) or isinstance(said, str)


def _is_source(node: ast.stmt) -> bool:
    target = node.targets[0] if isinstance(node, ast.Assign) else None
    return isinstance(target, ast.Name) and target.id == "source"


@pytest.mark.parametrize("path", sorted(modules()))
def test_file_with_physics_names_its_source(path):
    text = (ROOT / path).read_text(encoding="utf-8")
    if not calculates(text):
        return
    assert names_a_source(text) != (path in WITHOUT_PHYSICS), (
        f"{path}: add 'Source: ...' to its docstring"
    )


def test_list_of_files_without_physics_is_true():
    assert set(modules()) >= WITHOUT_PHYSICS


def test_every_effect_names_the_source_of_its_law():
    assert [effect.name for effect in catalogue().values() if len(effect.source) < 10] == []


def test_a_module_that_calculates_is_found():
    assert calculates("x = 2.0 * y\n") and calculates("x = y @ z\n")
    assert not calculates('x = folder / "name" / f"{y}"\n') and not calculates("x = y + 1\n")


def test_a_module_without_source_is_found():
    assert not names_a_source('"""A law."""\n')
    assert names_a_source('"""A law.\n\nSource: ISO 230-1.\n"""\n')
    assert names_a_source('class Law:\n    source = "ISO 230-1"\n')
