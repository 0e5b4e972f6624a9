"""What if: effects with other sizes than the job's, and a machine with other data."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from vmach.effects import EffectInstance, label_of, set_up_effect
from vmach.errors import InputError
from vmach.job import Job
from vmach.machine import Variant
from vmach.workbench.model.machine_changes import MachineChange, changed_machine
from vmach.workbench.model.point_set import PointSet

__all__ = ["Change", "changed_mm", "read_changes"]


@dataclass(frozen=True)
class Change:
    """An effect with other parameters than the job's.

    Attributes
    ----------
    now : EffectInstance
    before : EffectInstance or None
        As it is in the job.
    """

    now: EffectInstance
    before: EffectInstance | None

    def moved_mm(self, points: PointSet, variant: Variant) -> np.ndarray:
        """What the change does to the deviations, (C,) mm; the arms are those of the job."""
        moved = points.moved_by(self.now)
        return moved if self.before is None else moved - points.moved_by(self.before)


def read_changes(
    wanted: Sequence[Mapping[str, Any]], job: Job, effects: Sequence[EffectInstance]
) -> tuple[Change | MachineChange, ...]:
    """Changes from what the page says: a list of ``{"effect", "target", "parameters"}``.

    Among them may be ``{"component", "offset", "measured_at_mm"}`` for the machine's data.

    Raises
    ------
    InputError
        Not such a list; an unknown effect, target or parameter, or a size out of bounds.
    """
    in_job = {effect.label: effect for effect in effects}
    changes: list[Change | MachineChange] = []
    of_machine = [one for one in wanted if isinstance(one, Mapping) and "component" in one]
    if of_machine:
        changes.append(changed_machine(job.machine, of_machine))
    for one in wanted:
        if one in of_machine:
            continue
        if not isinstance(one, Mapping) or not isinstance(one.get("parameters"), Mapping):
            raise InputError(f"what if: {one!r}", accepted='{"effect", "target", "parameters"}')
        name, target = str(one.get("effect", "")), str(one.get("target") or "")
        before = in_job.get(label_of(name, target))
        given = {**({} if before is None else before.parameters), **one["parameters"]}
        now = set_up_effect(name, target, given, job=job)
        changes.append(Change(EffectInstance(now.effect, target, now.parameters, job), before))
    return tuple(changes)


def changed_mm(
    points: PointSet, changes: Sequence[Change | MachineChange], variant: Variant = Variant.ABBE
) -> np.ndarray:
    """What all changes do to the deviations, (C,) mm."""
    moved = (change.moved_mm(points, variant) for change in changes)
    return sum(moved, start=np.zeros(len(points)))
