"""Collisions that a job's program runs into, with the line and the time of each."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from vmach.base.stage_clock import Progress, StageClock, silent
from vmach.effects import read_effects
from vmach.job import read_job
from vmach.machine import Variant
from vmach.path.preparation import prepare
from vmach.prediction import displaced_sweeps
from vmach.run.collisions import job_collisions

__all__ = ["ProgramCollision", "check_collisions"]


@dataclass(frozen=True)
class ProgramCollision:
    """One move that brings a part of the tool where it must not be.

    Attributes
    ----------
    kind : str
        ``rapid in material``, ``shank`` or ``holder``.
    line, tool : int
        1-based line of the program; tool number.
    time_s : float
        When the move begins.
    depth_mm : float
        Height of the material inside the body where it is greatest.
    place_mm : tuple of 3 float
        Where that is, workpiece coordinates.
    """

    kind: str
    line: int
    tool: int
    time_s: float
    depth_mm: float
    place_mm: tuple[float, ...]

    def __str__(self) -> str:
        x, y, z = self.place_mm
        return (
            f"line {self.line}: {self.kind}, T{self.tool}, {self.depth_mm:.3g} mm deep near "
            f"X{x:.1f} Y{y:.1f} Z{z:.1f}"
        )


def check_collisions(
    job_path: str | Path, *, progress: Progress = silent
) -> tuple[ProgramCollision, ...] | None:
    """Look for collisions on the displaced path, without inspecting the part.

    Returns
    -------
    tuple of ProgramCollision, or None
        In the order of the program; None where the job has no blank to collide with.

    Raises
    ------
    InputError, gcode.ProgramError, stock.StockError
    """
    clock = StageClock(progress)
    with clock.stage("read"):
        job = read_job(job_path)
        if job.blank is None:
            return None
        effects = read_effects(job.effects, file=job.path, job=job)
        preparation = prepare(job)
    with clock.stage("displace"):
        sweeps = displaced_sweeps(preparation, Variant.ABBE, effects)
    with clock.stage("collide") as step:
        found = job_collisions(preparation, sweeps, progress=step)
    moves = preparation.program.moves
    return tuple(
        ProgramCollision(
            one.kind,
            int(moves.line[one.move]),
            int(moves.tool[one.move]),
            float(moves.start_s[one.move]),
            float(one.depth_mm),
            tuple(float(x) for x in one.place_mm),
        )
        for one in sorted(found, key=lambda one: one.move)
    )
