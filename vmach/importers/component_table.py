"""Error tables as the project writes them: one component error a file, and what names it."""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np

from vmach.importers.importer import Section
from vmach.importers.questions import Questions
from vmach.importers.source_file import SourceFile
from vmach.machine.component_errors import COMPONENT_NAMES, component_of
from vmach.machine.tables.runs import Runs

__all__ = ["component_question", "error_section", "named_error", "runs_text", "unit_of"]

#: digits of values in um and urad, of positions in mm
_VALUE_DIGITS, _POSITION_DIGITS = 6, 6


def unit_of(name: str) -> str:
    """``um`` of a length, ``urad`` of an angle."""
    return "urad" if component_of(name)[2] else "um"


def named_error(text: str) -> str | None:
    """The component error that a text names, such as ``EXX``; None for none, or several."""
    found = {name for name in COMPONENT_NAMES if re.search(rf"(?<![A-Z]){name}(?![A-Z])", text)}
    return found.pop() if len(found) == 1 else None


def component_question(source: SourceFile, questions: Questions, *, said: str | None = None) -> str:
    """Which error a file holds: as told, as its name or its head says, or asked.

    Parameters
    ----------
    source : SourceFile
    questions : Questions
    said : str or None
        What the file itself says, where it has a place for it.

    Raises
    ------
    InputError
        No component error.
    """
    said = (
        said or named_error(source.path.name.upper()) or named_error("\n".join(source.lines[:40]))
    )
    return questions.choice(
        "error",
        f"which error does {source.path.name} hold? EXX is the positioning of X",
        COMPONENT_NAMES,
        said=said,
    )


def runs_text(runs: Runs, name: str) -> str:
    """The table of a component error, runs side by side, values in um or urad."""
    unit = unit_of(name)
    columns: Mapping[str, np.ndarray] = {
        f"{way}_{number}_{unit}": run
        for way, sides, numbers in (
            ("forward", runs.forward, runs.forward_number),
            ("backward", runs.backward, runs.backward_number),
        )
        for number, run in zip(numbers.tolist(), sides, strict=True)
    }
    lines = [",".join(["position_mm", *columns])]
    for place, *values in zip(runs.position_mm, *columns.values(), strict=True):
        cells = ["" if np.isnan(v) else f"{v + 0.0:.{_VALUE_DIGITS}g}" for v in values]
        at = f"{round(place, _POSITION_DIGITS) + 0.0:.{_POSITION_DIGITS}f}"  # 0.0: no -0
        lines.append(",".join([at.rstrip("0").rstrip("."), *cells]))
    return "\n".join(lines) + "\n"


def error_section(
    name: str,
    file: str,
    questions: Questions,
    *,
    zero_mm: float = 0.0,
    is_down: bool = False,
    comment: str = "",
) -> tuple[Section, ...]:
    """The section of a machine file that names the table."""
    values: dict[str, object] = {"table": file}
    if zero_mm:
        values["position_zero_mm"] = zero_mm
    if is_down:
        values |= {"reverse": True, "reverse_deviations": True}
    if "measured_at" in questions.given and not component_of(name)[2]:
        values["measured_at_mm"] = questions.point("measured_at", "where the reflector stood")
    return (Section("machine", f"errors.{name}", values, comment=comment),)
