"""A new job from what the start page asks for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from vmach.base.finite_number import is_number
from vmach.errors import InputError
from vmach.files.toml_text import quoted

__all__ = ["SHAPES", "new_job_text"]

#: shapes of a tool that the form offers, and what each needs beside diameter and length
SHAPES = {"flat": (), "ball": (), "bull": ("corner_radius_mm",), "drill": (), "chamfer": ()}
_MOST_TOOLS = 60
_LARGEST_MM = 1e5


def new_job_text(told: Mapping[str, Any]) -> str:
    """The text of a job file.

    Parameters
    ----------
    told : mapping
        Files ``machine`` and ``program``, and ``nominal`` and ``measured`` where there are any.
        ``zero_mm``: machine coordinates of G54; ``min_mm`` and ``max_mm`` of the blank, or none.
        ``tools``: number, shape, diameter_mm and length_mm of each.

    Raises
    ------
    InputError
        Something is missing or is no number.
    """
    lines = ["schema = 1"]
    for key in ("machine", "program", "nominal", "measured"):
        name = told.get(key)
        if name:
            lines.append(f"{key} = {quoted(str(name))}")
        elif key in ("machine", "program"):
            raise InputError(f"the {key} is missing", accepted="a file of the folder")
    lines += ["", "[work_offsets_mm]", f"G54 = {_three(told, 'zero_mm')}"]
    if told.get("min_mm") or told.get("max_mm"):
        lines += ["", "[stock]"]
        lines += [f"{key} = {_three(told, key)}" for key in ("min_mm", "max_mm")]
    return "\n".join([*lines, *_tools(told.get("tools")), ""])


def _tools(tools: Any) -> list[str]:
    if not isinstance(tools, Sequence) or not 0 < len(tools) <= _MOST_TOOLS:
        raise InputError("no tool is given", accepted=f"1 .. {_MOST_TOOLS} tools")
    lines = []
    for tool in tools:
        if not isinstance(tool, Mapping):
            raise InputError(f"tool {tool!r}", accepted="number, shape, diameter and length")
        number, shape = tool.get("number"), tool.get("shape")
        if not isinstance(number, int) or isinstance(number, bool) or number < 1:
            raise InputError(f"tool number {number!r}", accepted="a whole number, 1 or more")
        if shape not in SHAPES:
            raise InputError(f"tool {number}: shape {shape!r}", accepted=", ".join(SHAPES))
        lines += ["", f"[tools.{number}]", f'shape = "{shape}"']
        for key in ("diameter_mm", "length_mm", *SHAPES[shape]):
            lines.append(f"{key} = {_number(tool.get(key), f'tool {number}: {key}')}")
    return lines


def _three(told: Mapping[str, Any], key: str) -> str:
    values = told.get(key)
    if not isinstance(values, Sequence) or isinstance(values, str) or len(values) != 3:
        said = f"{key} is missing" if values is None else f"{key} = {values!r}"
        raise InputError(said, accepted="three numbers in mm: X, Y, Z")
    return "[" + ", ".join(_number(value, key) for value in values) + "]"


def _number(value: Any, what: str) -> str:
    if not is_number(value, _LARGEST_MM):
        said = f"{what} is missing" if value is None else f"{what} = {value!r}"
        raise InputError(said, accepted="a number in mm")
    return repr(value)
