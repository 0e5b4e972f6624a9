"""What an instrument is: one class that says all that vmach has to know of it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Protocol

import numpy as np

from vmach.files.toml_file import FileSection, Positive
from vmach.path.circumstances import Circumstances
from vmach.path.toolpath import PathStates
from vmach.plausibility import lengths_meant_mm

if TYPE_CHECKING:
    from markupsafe import Markup

    from vmach.job import Job
    from vmach.machine import Machine
    from vmach.measurements.columns import Columns
    from vmach.measurements.measurement import Measurement
    from vmach.path.preparation import Preparation

__all__ = ["Curves", "Instrument", "ModelOfTest", "PlannedTest"]


class ModelOfTest(Protocol):
    """The model of the machine that a test is compared with."""

    @property
    def machine(self) -> Machine:
        """With its errors; its chain and rotary axes tell where a tool is that follows them."""
        ...

    @property
    def travel_mm(self) -> np.ndarray:
        """Lowest and highest position of X, Y, Z, (2, 3)."""
        ...

    @property
    def rapid_mm_per_min(self) -> float:
        """Of every axis."""
        ...

    @property
    def preparation(self) -> Preparation:
        """The job's program, read and split, for what was measured of its part."""
        ...

    def moved_mm(self, states: PathStates) -> np.ndarray:
        """Displacement of the tool's point of interest at P states, (P, 3) mm."""
        ...

    def predicted_mm(self, states: PathStates, sensing: np.ndarray) -> np.ndarray:
        """What readings along `sensing` (P, 3) at P states should be, (P,) mm."""
        ...


@dataclass(frozen=True)
class Curves:
    """Readings of one measurement in um, (P,) each: predictions by "before" and "after".

    `open_law` is the standard uncertainty that the effects' laws leave. What the instrument leaves
    free is taken off.
    """

    measurement: Measurement
    path: Circumstances
    measured: np.ndarray
    predicted: dict[str, np.ndarray]
    open_law: np.ndarray


@dataclass(frozen=True)
class PlannedTest:
    """A test that could be run, with n readings.

    Attributes
    ----------
    name : str
    text : str
        What to do, in words.
    settings : dict
        Keys of its ``[[measurements]]``.
    states : PathStates
        The machine at each reading.
    sensing : (n, 3) float64
        Unit vector along which a displacement of the tool shows.
    nuisance : (n, K) float64
        Columns of what the instrument leaves free.
    maps_work_space : bool
        Whether it sees the tool tip all over the work space.
    """

    name: str
    text: str
    settings: dict[str, Any]
    states: PathStates
    sensing: np.ndarray
    nuisance: np.ndarray
    maps_work_space: bool = False


class Instrument(FileSection):
    """An instrument, and the keys of a ``[[measurements]]`` that it reads.

    A subclass is one file: the class attributes below, the keys of the job's section as fields,
    and `read`. Everything else has a default.

    An object of the class is one section of a job.
    """

    #: what the job calls it: ``kind = "laser"``
    name: ClassVar[str]
    #: heading of its picture
    title: ClassVar[str]
    #: columns that its file has to have; those of `text_columns` hold words, the others numbers
    columns: ClassVar[tuple[str, ...]]
    text_columns: ClassVar[tuple[str, ...]] = ("run",)
    #: columns that its file may have besides
    optional_columns: ClassVar[tuple[str, ...]] = ()
    #: whether its columns are run, place, side and reading, so that runs may stand side by side
    has_runs: ClassVar[bool] = False
    #: whether the program of the job tells when and where the tool was, and not the file
    follows_program: ClassVar[bool] = False
    #: those that hold what was read, in um; and the signs of the last motions, 1, -1 or 0
    readings: ClassVar[tuple[str, ...]]
    signs: ClassVar[tuple[str, ...]] = ()
    #: whether columns of `readings` may be missing but for one: not every sensor was there
    has_sensors: ClassVar[bool] = False
    #: when a reading is positive
    sign_meaning: ClassVar[str]
    #: what the instrument leaves free, in a word or two
    left_free: ClassVar[str]
    #: whether it reads its own length in ever other directions, so that this may drift by itself
    turns: ClassVar[bool] = False
    #: effects that are a result of this test by its standard; {axis} is the one that it senses
    results: ClassVar[tuple[str, ...]] = ()
    #: those that its readings are by definition, whatever else does the same to them
    defines: ClassVar[tuple[str, ...]] = ()
    #: whether its picture has room for a band of what the effects' laws leave open
    shows_law_band: ClassVar[bool] = False
    #: how many of its diagrams stand side by side on paper
    abreast: ClassVar[Literal[2, 3]] = 2
    #: keys by which two tests of the kind may have been exchanged
    exchanged_keys: ClassVar[tuple[str, ...]] = ()
    #: whether a job names its file in a ``[[measurements]]``
    is_section_of_job: ClassVar[bool] = True
    #: how often it is used; of tests that do as well the more frequent is planned first
    commonness: ClassVar[int] = 0

    kind: str
    file: str
    tool_length_mm: Positive
    u_um: Positive

    def read(self, table: Columns, model: ModelOfTest) -> Measurement:
        """The readings of a file, with what the model says of them.

        Parameters
        ----------
        table : Columns
            Of the file: checked numbers, in the order of time.
        model : ModelOfTest

        Raises
        ------
        InputError
            Places outside the travel, motion that cannot have been.
        """
        raise NotImplementedError

    def mistaken(self) -> Iterator[dict[str, Any]]:
        """Keys that may have been mistaken, each with what it may have to be."""
        if self.tool_length_mm is None:  # that of the program's tool
            return
        for length_mm in lengths_meant_mm(self.tool_length_mm):
            yield {"tool_length_mm": length_mm}

    @classmethod
    def left_free_by(cls, measurement: Measurement) -> str:
        """What is left free of a measurement, in words; that of the class unless overridden."""
        return cls.left_free

    @classmethod
    def blocks(cls, measurement: Measurement) -> np.ndarray:
        """Readings that are held out together, (P,) str; whole groups unless overridden."""
        return measurement.group

    @classmethod
    def planned(cls, job: Job) -> Iterator[PlannedTest]:
        """Tests with it that can be run on the machine of a job; none unless overridden."""
        return iter(())

    @classmethod
    def plots(cls, curves: Curves) -> Sequence[tuple[str, Markup]]:
        """Diagrams of its readings, each with a title; none unless overridden."""
        return ()
