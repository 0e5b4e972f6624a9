"""What a machine file leaves out, where its tables come from, and what was done to them."""

from __future__ import annotations

from collections.abc import Iterator

from vmach.base.note import Kind, Level, Note
from vmach.base.units import um_from_mm, urad_from_rad
from vmach.machine.component_errors import COMPONENT_NAMES
from vmach.machine.machine import Machine

__all__ = ["statement_notes"]

#: tables measured further apart may be of another state of the machine
_SAME_STATE_DAYS = 31


def statement_notes(machine: Machine) -> Iterator[Note]:
    """Provenance, dates, what is missing, rows that were filled, curves that were chosen."""
    yield from _provenance(machine)
    yield from _what_is_missing(machine)
    yield from machine.notes
    yield from _chosen_curves(machine)


def _provenance(machine: Machine) -> Iterator[Note]:
    """Tables that nobody measured, and tables of one machine from different times."""
    for kind in ("reconstructed", "assumed"):
        names = [name for name, c in machine.components.items() if c.provenance == kind]
        if names:
            yield Note(Level.NOTE, Kind.PROVENANCE, " ".join(names), f"{kind}, not measured")
    dated = {name: c.measured_on for name, c in machine.components.items() if c.measured_on}
    first = min(dated, key=lambda name: dated[name], default="")
    last = max(dated, key=lambda name: dated[name], default="")
    if dated and (dated[last] - dated[first]).days > _SAME_STATE_DAYS:
        said = f"measured on {dated[first]} and on {dated[last]}: still the same machine?"
        yield Note(Level.DOUBT, Kind.PROVENANCE, f"{first} {last}", said)


def _what_is_missing(machine: Machine) -> Iterator[Note]:
    missing = [name for name in COMPONENT_NAMES if name not in machine.components]
    if missing:
        said = "no table, taken as zero"
        yield Note(Level.NOTE, Kind.MISSING, " ".join(missing), said)
    if machine.unplaced:
        said = "no measured_at_mm: only the conventional arms can be used"
        yield Note(Level.NOTE, Kind.MISSING, " ".join(machine.unplaced), said)


def _chosen_curves(machine: Machine) -> Iterator[Note]:
    """What cross-validation chose, against the best and the linear curve."""
    for name, component in machine.components.items():
        if not component.evidence:
            continue
        scale, unit = (urad_from_rad, "urad") if component.is_angle else (um_from_mm, "um")
        ranked = sorted(component.evidence, key=lambda score: score.rms)
        scores = ", ".join(f"{s.interpolation} {scale(s.rms):.3g}" for s in ranked[:4])
        yield Note(
            Level.NOTE, Kind.CURVE, name,
            f"'{component.interpolation}' by cross-validation; left-out points are missed by "
            f"({unit} RMS): {scores}",
        )  # fmt: skip
