"""What an NC program needs of a job: tools, work offsets, travel."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path

import numpy as np

from gcode import WORK_OFFSETS, MoveKind, Program, ProgramError, ToolEntry, read_program
from vmach.checkup.finding import Finding, Weight
from vmach.errors import InputError
from vmach.job.control import control_told
from vmach.job.schema import JobSchema

__all__ = ["Needs", "program_findings"]

#: a program may call any of these while it is read for what it needs
_ANY_TOOL = range(1, 10_000)


class Needs:
    """A program, read with every tool and work offset there could be.

    Parameters
    ----------
    file : Path
        The program.
    control : str
        As in a job.
    tools : mapping of int to ToolEntry
        Those that are known.

    Raises
    ------
    ProgramError
        It cannot be read.
    """

    def __init__(
        self, file: Path, *, control: str = "auto", tools: Mapping[int, ToolEntry] | None = None
    ) -> None:
        self._file = file
        known = {number: ToolEntry() for number in _ANY_TOOL} | dict(tools or {})
        self.program: Program = read_program(file, tools=known, dialect=control)
        moves = self.program.moves
        self._cuts = (moves.kind != MoveKind.DWELL) & moves.at_feed

    def _first_lines(self, values: np.ndarray) -> dict[int, int]:
        """Every value with which the program cuts, and the first line that does."""
        cut, lines = values[self._cuts], self.program.moves.line[self._cuts]
        return {int(v): int(lines[cut == v][0]) for v in np.unique(cut)}

    @property
    def tools(self) -> dict[int, int]:
        """Numbers of the tools that cut, and the first line of each; 0 for none."""
        return self._first_lines(self.program.moves.tool)

    @property
    def work_offsets(self) -> dict[str, int]:
        """Names of the work offsets in which it cuts, and the first line of each."""
        found = self._first_lines(self.program.moves.work_offset)
        return {WORK_OFFSETS[number - 1]: line for number, line in found.items()}

    def extent_mm(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest X Y Z at which it cuts, program coordinates, mm, (3,) each.

        Raises
        ------
        InputError
            It cuts nothing.
        """
        if not self._cuts.any():
            raise InputError(
                "the program cuts nothing",
                file=self._file,
                accepted="a program with moves at a feed",
                hint="is it a subprogram?",
            )
        moves = self.program.moves
        tip = (moves.end_mm - moves.tool_offset_mm)[self._cuts]
        return tip.min(axis=0), tip.max(axis=0)


def program_findings(file: Path, job: JobSchema, job_file: Path) -> Iterator[Finding]:
    """What a program asks for that its job does not say."""
    tools = {number: ToolEntry(name=tool.name) for number, tool in job.tools.items()}
    control = control_told() or (job.control.name if job.dialect is None else job.dialect)
    try:
        needs = Needs(file, control=control, tools=tools)
    except ProgramError as error:
        yield Finding.of_error(error)
        return
    if not needs.tools:
        yield Finding(Weight.MEND, "the program cuts nothing", file,
                      hint="is it a subprogram?")  # fmt: skip
    one_tool = set(needs.tools) == {0} and len(job.tools) == 1
    for number, line in needs.tools.items():
        if number not in job.tools and not one_tool:
            name = f"tool T{number}" if number else "a tool that it does not call"
            yield Finding(
                Weight.MEND,
                f"the program cuts with {name}, which {job_file.name} lacks",
                file,
                line,
                accepted=", ".join(f"T{k}" for k in job.tools) or "none is there",
                hint=f"add a table [tools.{number}] with shape, diameter_mm and length_mm"
                if number
                else "a job with one tool only may leave the T word out",
            )
    offsets = needs.work_offsets
    for name, line in offsets.items():
        if name not in job.work_offsets_mm:
            yield Finding(
                Weight.MEND,
                f"the program cuts in {name}, which [work_offsets_mm] lacks",
                file,
                line,
                accepted=", ".join(job.work_offsets_mm) or "none is there",
                hint=f"{name} = [x, y, z], the workpiece zero in machine coordinates",
            )
    if len(offsets) > 1 and job.workpiece_zero is None:
        yield Finding(
            Weight.MEND,
            f"the program cuts in {' and '.join(offsets)}; which one the part's CAD refers to is "
            "not said",
            job_file,
            accepted="workpiece_zero = one of " + ", ".join(offsets),
        )
