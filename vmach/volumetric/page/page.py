"""accuracy.html: cones that can be turned, the figures and where they come from, in one file.

Source: Huddersfield paper, figure 5 (cone plot); ISO 230-6 (diagonals).
"""

from __future__ import annotations

import base64
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
from markupsafe import Markup

from vmach.base.units import um_from_mm
from vmach.report.page.kit import (
    asset,
    render_page,
    script_json,
    style_sheet,
    viewer_scripts,
)
from vmach.report.page.payload import encode_mesh
from vmach.report.result import Colouring, DisplayMesh
from vmach.volumetric.cones import SIDES, cone_mesh
from vmach.volumetric.field import ErrorField

__all__ = ["accuracy_page"]

_HERE = Path(__file__).parent
#: light to dark, in steps that a grey print and every common kind of colour vision keeps apart
_STOPS = ("#cfe8f3", "#8ecae6", "#4aa3c7", "#2a6f97", "#8a4f7d", "#b5305a", "#7a0c2e")
#: contributions that are shown
_SHARES = 12


def accuracy_page(
    report: Mapping[str, Any],
    field: ErrorField,
    pictures: Mapping[str, bytes],
    *,
    dark_pictures: Mapping[str, bytes],
    command: str,
) -> str:
    """The page; it asks the network for nothing.

    Parameters
    ----------
    report : mapping
        The figures, as in ``accuracy.json``.
    field : ErrorField
        A coarse one: every point has a cone.
    pictures, dark_pictures : mapping of file name to PNG
        On light and on dark paper.
    command : str
        What was typed.
    """
    mesh = _mesh(field)
    largest_um = um_from_mm(float(field.magnitude_mm.max()))
    shares = list(report["contributions_percent"].items())[:_SHARES]
    counted = {one["component"]: one for one in report["double_counting"]}
    data = {
        "colour_stops": _STOPS,
        "largest_um": largest_um,
        "marks": [end["nose_mm"] for end in report["volumetric"]["between"]],
    }
    return render_page(
        _HERE / "page.html.jinja",
        report=report,
        shares=[(name, share, counted.get(name)) for name, share in shares],
        pictures={name: _png_uri(data) for name, data in pictures.items()},
        dark_pictures={name: _png_uri(data) for name, data in dark_pictures.items()},
        started_at=datetime.now(UTC).isoformat(timespec="seconds"),
        command=command,
        count=len(field.error_mm),
        page_data=script_json(data),
        payload=encode_mesh(mesh),
        css=style_sheet(asset("page.css", _HERE)).replace("ACCURACY_RAMP", ", ".join(_STOPS)),
        scripts=[*viewer_scripts(), asset("page.js", _HERE)],
    )


def _mesh(field: ErrorField) -> DisplayMesh:
    """Cones, coloured by the length of the error, in the box of the volume."""
    vertices, triangles = cone_mesh(field)
    box, edges = _box(field.volume.low_mm, field.volume.high_mm)
    # the ramp runs over both signs: its middle is half of the largest error
    half = 0.5 * float(field.magnitude_mm.max())
    value = np.repeat(field.magnitude_mm, SIDES + 2) - half
    return DisplayMesh(
        np.vstack([vertices, box]),
        np.vstack([triangles, edges + len(vertices)]),
        {"error": Colouring(np.r_[value, np.zeros(len(box))], np.ones(len(vertices) + len(box)))},
    )


def _box(low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The twelve edges of a box as flat triangles, which show as lines."""
    corners = np.array(np.meshgrid([0, 1], [0, 1], [0, 1], indexing="ij")).reshape(3, -1).T
    places, edges = [], []
    for one in corners:
        for axis in np.flatnonzero(one == 0):
            other = one.copy()
            other[axis] = 1
            edges.append([len(places), len(places) + 1, len(places) + 2])
            places += [one, 0.5 * (one + other), other]
    return low + np.array(places) * (high - low), np.array(edges)


def _png_uri(picture: bytes) -> Markup:
    return Markup("data:image/png;base64,") + base64.b64encode(picture).decode("ascii")
