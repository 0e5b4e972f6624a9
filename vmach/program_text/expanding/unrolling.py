"""Loops, subprograms and expressions written out: blocks with numbers, in the order they run."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from itertools import pairwise

from gcode import PlainLines, Program, ProgramError, Step, block_items
from vmach.errors import InputError
from vmach.program_text.expanding.expanded_text import Expanded, LineBuilder, number_text

__all__ = ["unrolled"]

#: a program that runs more lines than this is not written out
_MOST_LINES = 200_000
#: codes whose P is a pause
_PAUSING = {"G4", "G74", "G76", "G77", "G82", "G84", "G86", "G88", "G89"}
_FLOW = "loop, branch or subprogram: blocks in the order in which they run"
_NUMBERS = "parameters and expressions: their values"
_LABEL = re.compile(r"^(\s*/?\s*)N\s*(\d+(?:\.\d*)?)\s*", re.IGNORECASE)
_COMMENT = re.compile(r"\([^)\n]*\)|;.*")
#: a parameter, brackets, or a sign before a sign, as LinuxCNC reads it: Z--8 is Z8
_EXPRESSION = re.compile(r"[#\[]|[+-]\s*[+-]")
_PROGRAM_NUMBER = re.compile(r"\s*(?:O|:)\s*\d+\s*", re.IGNORECASE)
_MODAL_MEMORY = {70, 71, 72, 73}


def unrolled(program: Program) -> Expanded | None:
    """Write out control flow and expressions; None where there are none.

    Raises
    ------
    InputError
        The program runs too many lines, or a line cannot stand in another order.
    """
    outline = program.outline
    jumps = any(_first(after) <= _last(before) for before, after in pairwise(outline))
    if not jumps and not any(
        isinstance(step, Step) and _has_expression(program, step) for step in outline
    ):
        return None
    steps = program.steps
    if jumps and len(steps) > _MOST_LINES:
        raise InputError(
            f"the program runs {len(steps)} lines",
            file=program.path,
            accepted=f"at most {_MOST_LINES} where loops and subprograms are written out",
        )
    lines = LineBuilder(program)
    if jumps:
        _write_in_running_order(program, steps, lines)
    else:
        _write_numbers(program, steps, lines)
    return lines.result()


def _first(part: Step | PlainLines) -> int:
    return part.line if isinstance(part, Step) else part.first


def _last(part: Step | PlainLines) -> int:
    return part.line if isinstance(part, Step) else part.last


def _code(program: Program, line: int) -> str:
    """Text of a line without comments."""
    return _COMMENT.sub("", program.source.line(line))


def _has_expression(program: Program, step: Step) -> bool:
    if not program.language.is_rs274 or not step.blocks:
        return False
    code = _code(program, step.line)
    return _EXPRESSION.search(code) is not None and bool(step.words or step.g_codes or step.m_codes)


def _write_numbers(program: Program, steps: list[Step], lines: LineBuilder) -> None:
    """Every line in its place, values in place of expressions."""
    of_line = {step.line: step for step in steps}
    for line in range(1, len(program.source) + 1):
        step = of_line.get(line)
        if step is not None and _has_expression(program, step):
            lines.write(line, _with_values(program, step, settings=True), _NUMBERS)
        else:
            lines.keep(line)


def _write_in_running_order(program: Program, steps: list[Step], lines: LineBuilder) -> None:
    for line in range(1, steps[0].line):
        lines.keep(line)
    seen: set[float] = set()
    last_of_block = _block_ends(program)
    first = last = 0  # lines of the block that runs
    for step in steps:
        if first < step.line <= last:  # it has gone with its first line
            continue
        first, last = step.line, last_of_block(step.line)
        text = _running_text(program, step, first=not lines.written and not lines.reasons)
        if text is None:
            lines.drop(step.line, _FLOW)
            continue
        label = _LABEL.match(text)
        if label and not program.language.text.renumbers:
            number = float(label[2])
            text = text if number not in seen else label[1] + text[label.end() :]
            seen.add(number)
        if text == program.source.line(step.line):
            lines.keep(step.line, last)
        else:
            lines.write(step.line, text, _FLOW)
    last = max(step.line for step in steps)
    if any(line.strip() == "%" for line in program.source.lines[:1]):
        closing = (k for k in range(last + 1, len(program.source) + 1)
                   if program.source.lines[k - 1].strip() == "%")  # fmt: skip
        for line in closing:
            lines.keep(line)


def _block_ends(program: Program) -> Callable[[int], int]:
    """Gives the last line of the block that begins in a line."""
    text = program.language.text(program.source)
    if program.language.is_rs274 or text.plain is None:
        return lambda line: line
    return text.plain(program.source, {}).last_line


def _running_text(program: Program, step: Step, *, first: bool) -> str | None:
    """What a line becomes where it runs; None where nothing of it is left."""
    text = program.source.line(step.line)
    if not program.language.is_rs274:
        flow = program.language.flow_lines
        if step.is_flow or step.assignment:
            return step.assignment or None
        return None if flow is not None and flow.match(text) else text
    code = _code(program, step.line)
    if memory := _MODAL_MEMORY & {int(m) for m in step.m_codes}:
        raise InputError(
            f"M{min(memory)} cannot be written out together with loops and subprograms",
            file=program.path,
            line=step.line,
        )
    if not code.strip(" \t%/"):
        return _comments(text, step) if step.comment else text
    if first and _PROGRAM_NUMBER.fullmatch(code):
        return text
    if step.blocks == 0 or "#" in code or "[" in code:
        return _with_values(program, step, settings=False) if step.blocks else _comments(text, step)
    return text


def _comments(text: str, step: Step) -> str | None:
    """Comments of a line, parameters in messages as the control shows them."""
    found = [c for c in _COMMENT.findall(text) if c.strip() != ";"]
    return " ".join(_shown(c, step) for c in found) or None


def _shown(comment: str, step: Step) -> str:
    return f"({step.comment})" if "#" in comment and step.comment else comment


def _with_values(program: Program, step: Step, *, settings: bool) -> str | None:
    """The line with numbers; parameter settings stay only where asked for."""
    text = program.source.line(step.line)
    try:
        pointed = program.language.pointed_pause and bool(step.g_names & _PAUSING)
        items = list(_items(text, step, settings=settings, pointed_pause=pointed))
    except (ProgramError, StopIteration):
        raise InputError(
            f"a block inside a control statement cannot be written out: '{text.strip()}'",
            file=program.path,
            line=step.line,
            hint="write the block on a line of its own",
        ) from None
    letter = re.search(r"[A-Za-z]", _code(program, step.line))
    lower = letter is not None and letter.group().islower()
    words = [w if w[0] in "(;" else (w.lower() if lower else w.upper()) for w in items]
    if not any(w[0] not in "(;/N" for w in words):
        words = [w for w in words if w[0] in "(;"]
    return " ".join(words).replace("/ ", "/") or None


def _items(text: str, step: Step, *, settings: bool, pointed_pause: bool) -> Iterator[str]:
    """Words with their values; a pause that had no count of milliseconds keeps its point."""
    g_codes, m_codes = iter(step.g_codes), iter(step.m_codes)
    for kind, value in block_items(text):
        if kind == "#":
            if settings:
                yield value
        elif kind in "(;":
            yield _shown(value, step)
        elif kind in "/N":
            yield kind + value.removeprefix("/")
        elif kind in "GM":
            yield kind + number_text(kind, next(g_codes if kind == "G" else m_codes))
        elif kind == "P" and pointed_pause and not value.isdigit():
            yield kind + number_text("X", step.words[kind])
        else:
            yield kind + number_text(kind, step.words[kind])
