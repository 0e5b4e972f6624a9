"""What remains, in parts, as the discrepancy takes them; and what the measuring machine did."""

from __future__ import annotations

import numpy as np

from gcode import WORK_OFFSETS
from vmach.diagnosis.inference.remains import OF_DEVICE, effects_mm, rms_um, taken_mm
from vmach.diagnosis.inference.verdicts import Inference
from vmach.diagnosis.inference.weighing import Explanation, Weighing
from vmach.fit.noise.measuring_machine import stated_of_device
from vmach.fit.survey import Survey

__all__ = ["clamped_by_work_offset", "of_device_mm", "remains_by_um"]

#: members of the discrepancy, for people
_WORDS = {
    "floors": "offsets of floors",
    "walls": "offsets of walls, or of sizes of holes",
    "runs": "offsets of runs",
    "form": "slope and bend of features or runs",
    "time": "wandering in time",
    "places": "errors of single places",
    "reversals": "lost motion that varies along an axis",
    "field": "a smooth field over the volume",
    "bend": "bend and twist of the part",
}
_FORMS, _SCATTER = "forms over states", "scatter beyond the noise"
#: share of the variance that a part has at least to be told; chosen: less is looked into last
_NOTABLE = 0.1


def remains_by_um(found: Inference) -> dict[str, float]:
    """Root mean squares of the parts of what remains, the largest first; small ones left out.

    Parts follow each other in part: their squares need not add up to that of the whole.
    """
    weighing, told = found.among, found.told
    members = {
        _WORDS[name]: taken_mm(weighing, told, [name])
        for name in weighing.members.names
        if name not in OF_DEVICE
    }
    none = np.zeros(len(weighing.survey))
    forms = sum(effects_mm(weighing, told)[len(found.supports) :], none)
    parts = {name: rms_um(own) for name, own in {**members, _FORMS: forms}.items()}
    smooth = rms_um(sum(members.values(), forms))
    parts[_SCATTER] = float(np.sqrt(max(found.remains_um**2 - smooth**2, 0.0)))
    least = np.sqrt(_NOTABLE) * found.remains_um
    largest = sorted(parts.items(), key=lambda part: -part[1])
    return {name: size for name, size in largest if size > max(least, 1e-3)}


def of_device_mm(weighing: Weighing, found: Explanation) -> dict[str, np.ndarray]:
    """What the measuring machine did to the readings, by name, (n,) each.

    Source: closed form derived here: columns F of unit variance take F F^T C^-1 y of readings y
    whose covariance is C.
    """
    names = [name for name in weighing.members.names if name in OF_DEVICE]
    taken = {name: taken_mm(weighing, found, [name]) for name in names}
    survey, whiten = weighing.survey, found.posterior.whiten
    white = whiten(survey.residual_mm)
    for name, columns in stated_of_device(survey).items():
        if columns.any():  # else not stated
            own = columns @ (whiten(columns).T @ white)
            taken[name] = own - survey.aligned(own[:, None])[:, 0]
    return taken


def clamped_by_work_offset(survey: Survey) -> list[str]:
    """Work offsets of which each is a clamping of its own; none where they are not."""
    for m in survey.measurements:
        if m.clamping is not None:
            cut_in = m.states.moves.work_offset[m.states.move]
            both = set(zip(m.clamping.tolist(), cut_in.tolist(), strict=True))
            if len(both) == len(set(m.clamping.tolist())) == len(used := np.unique(cut_in)) > 1:
                return [WORK_OFFSETS[k - 1] for k in used]
    return []
