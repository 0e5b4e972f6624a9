"""Programs: read a file, run it, and hold text and moves together."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from gcode.control.predefined import install_predefined
from gcode.errors import ProgramError, UnknownToolError
from gcode.geometry.arc_tolerance import ArcTolerance, arc_tolerance
from gcode.language.confirmation import unconfirmed_words
from gcode.language.dialect import Dialect
from gcode.language.options import ControlSettings, RunOptions
from gcode.language.registry import Recognition, choose_dialect, dialect_called
from gcode.language.unread_controls import name_unread_control
from gcode.motion.frames import load_offsets
from gcode.moves.clock import MachineLimits
from gcode.moves.moves import Moves
from gcode.moves.resolve import to_moves
from gcode.run import run_program
from gcode.state.controller import Controller, mapping_of_systems
from gcode.state.record import Record
from gcode.state.tools import OffsetEntry, ToolEntry, offset_memory
from gcode.state.trace import PlainLines, Step, Trace
from gcode.text.parameters import system_base
from gcode.text.source import Source, readable, readable_quotes

#: Smaller programs are read before the compiled reader would be loaded, bytes.
_FAST_FROM = 50_000
#: what notes on the reading are about, in the place of a word
OF_READING = frozenset(("increment", "units", "%", "two motions", "not confirmed"))
#: begins as programs of FANUC and its relatives do
_NUMBERED = re.compile(rb"\s*%?\s*[O:]\d", re.IGNORECASE)
_PERCENT_LINE = re.compile(rb"\s*%[ \t\r]*\n")
_PROGRAM_END = re.compile(rb"(?<![A-Z])M *(?:0?2|30|99|17)(?![\d.])", re.IGNORECASE)

__all__ = ["Note", "Program", "read_program"]


@dataclass(frozen=True)
class Note:
    """A word that does not change where the tool goes, or a reading that may be another's.

    Attributes
    ----------
    line : int
        1-based.
    word : str
        As ``M8``; one of `OF_READING` where the note says how the program was read.
    meaning : str
        What the word would do, or how it was read.
    """

    line: int
    word: str
    meaning: str

    @property
    def is_of_reading(self) -> bool:
        """Whether it says how the program was read."""
        return self.word in OF_READING


@dataclass(frozen=True)
class Program:
    """One program, read completely.

    Attributes
    ----------
    path : Path
        Where it came from.
    dialect : str
        One of `gcode.dialect_names`.
    source : Source
        Exact text; `Source.words` gives the words of a line, `Source.rewritten` writes back.
    notes : tuple of Note
        Words that are irrelevant to geometry.
    record : Record
        Canonical calls in the active work system.
    limits : MachineLimits
        For the clock.
    home_mm : (3,) array or None
        Nose position at the start, where it is known.
    options : mapping
        How it was read: arguments of `read_program`.
    assumed : str
        Which control it was read for, and why.
    """

    path: Path
    dialect: str
    source: Source
    notes: tuple[Note, ...]
    record: Record = field(repr=False)
    limits: MachineLimits = field(repr=False)
    home_mm: np.ndarray | None = field(repr=False)
    options: Mapping[str, object] = field(repr=False)
    assumed: str = ""

    @property
    def language(self) -> type[Dialect]:
        """The dialect itself."""
        return dialect_called(self.dialect)

    @cached_property
    def steps(self) -> list[Step]:
        """Lines in the order in which they are obeyed, by reading the program once more."""
        return self._traced(fast=False)

    @cached_property
    def outline(self) -> list[Step | PlainLines]:
        """The same as `steps`, but for lines of plain motion, which are `PlainLines`."""
        return self._traced(fast=len(self.source.data) >= _FAST_FROM)

    def _traced(self, *, fast: bool) -> list:
        steps: list[Step | PlainLines] = []
        options = dict(self.options, dialect=self.dialect, fast=fast)
        read_program(self.source, **options, steps=steps)
        return steps

    @cached_property
    def moves(self) -> Moves:
        """What the machine does, one row a move; `Moves.line` leads back to the text."""
        try:
            return to_moves(self.record, limits=self.limits, home_mm=self.home_mm)
        except ProgramError as error:
            raise _placed(error, self.source) from None

    def with_text(self, source: Source) -> Program:
        """The same, told to be of another text: its moves are not made again."""
        return self._with(path=source.path, source=source)

    def without_record(self) -> Program:
        """The same for who asks for its moves and text: without canonical calls."""
        return self._with(record=Record())

    def moves_alone(self) -> Program:
        """The same for who asks for its moves: without text and canonical calls."""
        return self._with(source=Source(b"", self.path), record=Record())

    def _with(self, **changes: object) -> Program:
        other = replace(self, **changes)
        vars(other)["moves"] = self.moves
        return other


def _placed(error: ProgramError, source: Source) -> ProgramError:
    """The error with its file, and the block at fault where that is of the program itself."""
    error.located(file=source.path, line=None)
    if error.file != source.path or not error.line or error.line > len(source.lines):
        return error
    line = source.lines[error.line - 1]
    error.what = readable_quotes(error.what, line)
    return error.in_block(readable(line))


def read_program(
    path: str | Path | Source,
    *,
    work_offsets_mm: Mapping[str, Sequence[float]] | None = None,
    tools: Mapping[int, ToolEntry] | None = None,
    offsets: Mapping[int, OffsetEntry] | None = None,
    limits: MachineLimits | None = None,
    home_mm: Sequence[float] | None = None,
    dialect: str = "auto",
    arc_tolerances: str | ArcTolerance = "linuxcnc",
    block_delete: bool = False,
    control: ControlSettings | None = None,
    machine_unit_mm: float = 1.0,
    preview: bool = False,
    max_blocks: int = 3_000_000,
    fast: bool | None = None,
    steps: list[Step | PlainLines] | None = None,
) -> Program:
    """Read an NC program as a controller reads it.

    Parameters
    ----------
    path : path or Source
        The program.
    work_offsets_mm : mapping, optional
        ``G54`` ... ``G59.3`` -> machine coordinates of the workpiece zero, mm.
    tools : mapping, optional
        Tool number -> entry of the tool table.
    offsets : mapping, optional
        Number of H and D -> row of the offset memory; numbers that it lacks mean the tools.
    limits : MachineLimits, optional
        Rapid, acceleration, tool change; for the clock.
    home_mm : sequence of float, optional
        Nose position X Y Z at the start, machine coordinates. Where it is not given, the
        machine stands at the end of the first move, which so takes no time, and the program
        starts reading as if at machine zero.
    dialect : str
        ``auto`` (from the text), one of `gcode.dialect_names` or a synonym.
    arc_tolerances : str or ArcTolerance
        Which control's limits for arcs whose radii differ: ``linuxcnc``, ``grbl``,
        ``sinumerik``, ``heidenhain``.
    block_delete : bool
        Skip lines that begin with a slash.
    control : ControlSettings, optional
        Switches and parameters of the control; says also whether blocks are skipped.
    machine_unit_mm : float
        Unit of offsets in parameters (#5221 ...), 25.4 for a machine in inches.
    preview : bool
        After a tool change, take the last commanded point for the position even where an offset
        has changed since, as LinuxCNC's stand-alone interpreter does and a machine does not.
    max_blocks : int
        Give up after so many blocks more than the program has lines.
    fast : bool, optional
        Read stretches of plain motion with compiled code; the result is the same to the bit.
        By default for programs of 50 kB and more.
    steps : list of Step, optional
        Every line that is obeyed is appended, with its values and modes. Where `fast` is True,
        lines of plain motion one behind the other may be one `PlainLines`.

    Raises
    ------
    ProgramError
        With file and line, for anything that cannot be obeyed.
    OSError
        If the file cannot be read.
    """
    options = {name: value for name, value in locals().items() if name not in ("path", "steps")}
    source = path if isinstance(path, Source) else Source.read(path)
    if fast is None:
        fast = steps is None and len(source.data) >= _FAST_FROM
    settings = control or ControlSettings(block_delete=block_delete)
    folder = Path(source.path).parent if Path(source.path).is_file() else None
    how = RunOptions(settings, max_blocks, fast, folder)

    def run(spoken: type[Dialect]) -> Controller:
        spoken.check_options(settings.options)
        controller = Controller(dict(tools or {}), arc_tolerance(arc_tolerances), machine_unit_mm,
                                offsets=offset_memory(tools or {}, offsets or {}),
                                preview=preview)  # fmt: skip
        _prepare(controller, work_offsets_mm or {}, home_mm)
        if steps is not None:
            steps.clear()
            controller.trace = Trace(controller, steps)
        run_program(controller, source, spoken, how)
        return controller

    try:
        spoken, controller = _run_as_recognised(run, source, dialect)
    except ProgramError as error:
        raise _placed(error, source) from None
    if controller.trace is not None:
        controller.trace.end()
    _note_unconfirmed(controller, spoken.dialect)
    _note_open_end(controller, source)
    notes = tuple(Note(line, word, text) for (line, word), text in controller.notes.items())
    home = None if home_mm is None else np.array(home_mm, np.float64)
    record = controller.record
    vars(controller).clear()  # its functions refer to it: such rings keep long programs in memory
    return Program(source.path, spoken.dialect.name, source, notes, record,
                   limits or MachineLimits(), home, options, str(spoken))  # fmt: skip


def _run_as_recognised(
    run: Callable[[type[Dialect]], Controller], source: Source, name: str
) -> tuple[Recognition, Controller]:
    """Run in the dialect of the text's head; where that is refused, in that of the whole text."""
    data = source.data[source.mark :]
    spoken = choose_dialect(name, data, path=source.path)
    try:
        return spoken, run(spoken.dialect)
    except ProgramError as error:
        other = choose_dialect(name, data, path=source.path, whole=True)
        if other.dialect is spoken.dialect:
            if spoken.dialect.is_rs274:
                name_unread_control(data.decode("latin-1"))
            is_of_tools = isinstance(error, UnknownToolError)  # whatever the control
            if spoken.is_fallback and not is_of_tools and _NUMBERED.match(data):
                error.hint = "it begins with a program number: is it for FANUC or Haas?"
            seems = choose_dialect("auto", data, whole=True)
            if seems.dialect is not spoken.dialect and not seems.is_fallback:
                control = f"{seems.dialect.title} ({seems.dialect.name})"
                hints = filter(None, (error.hint, f"is it for {control}? {seems.reason}"))
                error.hint = "; ".join(hints)
            raise
        return other, run(other.dialect)


def _note_unconfirmed(controller: Controller, dialect: type[Dialect]) -> None:
    """One note on the words whose reading nothing but the manual supports."""
    words = unconfirmed_words(controller.used, dialect.confirmed)
    if words:
        controller.notes[(controller.used[words[0]], "not confirmed")] = (
            f"{', '.join(words)}: read after the maker's manual, confirmed by no second source"
        )


def _note_open_end(controller: Controller, source: Source) -> None:
    """One note on a text that a percent sign opens and nothing ends: half of a file, perhaps."""
    opening = _PERCENT_LINE.match(source.data, source.mark)
    if not opening or source.data.find(b"\n%", opening.end() - 1) >= 0:
        return
    if not _PROGRAM_END.search(source.data):
        line = source.data.rstrip().count(b"\n") + 1
        controller.notes[(line, "%")] = (
            "the program begins with % and has no end (%, M2, M30, M99): is the file cut short?"
        )


def _prepare(
    controller: Controller, work_offsets_mm: Mapping[str, Sequence[float]],
    home_mm: Sequence[float] | None,
) -> None:  # fmt: skip
    """Put work offsets and the start position into the controller's memory."""
    scale = 1.0 / controller.machine_unit_mm
    for system, offset in mapping_of_systems(work_offsets_mm).items():
        values = [float(v) for v in offset]
        if len(values) != 3 or not np.isfinite(values).all():
            raise ProgramError(f"work offset {list(offset)}", accepted="three numbers X Y Z in mm")
        controller.parameters.set_vector(system_base(system), [v * scale for v in values])
    load_offsets(controller)
    home = [0.0] * 3 if home_mm is None else [float(v) for v in home_mm]
    controller.position = controller.from_machine([*home, 0.0, 0.0, 0.0])
    controller.record.last = controller.record.last_straight = tuple(controller.position)
    controller.set_tool_parameters()
    install_predefined(controller)
