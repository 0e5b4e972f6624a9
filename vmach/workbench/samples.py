"""The samples that come with a copy of vmach's sources."""

from __future__ import annotations

from pathlib import Path

import vmach

__all__ = ["sample_jobs"]

_JOBS = ("job.toml", "corner.toml", "toolpath1.toml")
_ABOUT = {
    "missing_effect": "A measured part with a hidden cause: find it, add it, watch the error fall",
    "iso10791_7": "Contouring test piece on a machining centre",
    "freecad_pocket": "A bracket, programmed by FreeCAD",
    "mazak_ajv25": "The machine of a thesis and its toolpath",
    "spline_slot": "A free-form slot on a portal machine",
}


def sample_jobs() -> list[dict[str, str]]:
    """Job and what it is; empty where vmach was installed without its sources."""
    root = Path(vmach.__file__).parents[1] / "samples"
    found = []
    for name, about in _ABOUT.items():
        jobs = sorted((root / name).glob("*.toml"))
        named = [path for path in jobs if path.name in _JOBS]
        if named:
            found.append({"job": str(named[0].resolve()), "name": name, "about": about})
    return found
