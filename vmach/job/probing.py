"""How a job's workpiece zero and tool lengths were set on its machine."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vmach.job.schema import ProbingEntry

if TYPE_CHECKING:
    from vmach.job.tool import JobTool

__all__ = ["Probing", "read_probing"]


@dataclass(frozen=True)
class Probing:
    """Where edge finder, probe and tools touched, from the workpiece zero.

    Attributes
    ----------
    at_mm : (3, 3) float64
        Places where X, Y and Z were touched, one a row.
    probe_length_mm : float
        From the spindle nose to the tip of probe or edge finder.
    tools : {"touched", "preset"}
        Lengths by touch on the machine, or measured off it.
    tools_at_mm : (3,) float64
        Where the tools touched for their lengths.
    approach : tuple of int
        Sign of the last motion of each axis at a touch.
    """

    at_mm: np.ndarray
    probe_length_mm: float
    tools: str
    tools_at_mm: np.ndarray
    approach: tuple[int, int, int]


def read_probing(said: ProbingEntry | None, tools: Mapping[int, JobTool]) -> Probing | None:
    """What a job says; a probe of unknown length is as long as the job's first tool."""
    if said is None:
        return None
    places = [said.zero_at_mm if own is None else own
              for own in (said.x_at_mm, said.y_at_mm, said.z_at_mm)]  # fmt: skip
    tools_at = places[2] if said.tools_at_mm is None else said.tools_at_mm
    length = said.probe_length_mm
    if length is None:
        length = tools[min(tools)].length_mm if tools else 0.0
    return Probing(np.array(places), length, said.tools, np.array(tools_at), said.approach)
