"""How far zones of form reach: the ends of the rows of points, half a distance from the edges.

Closed forms of the two errors that machines make most. A face of length L has n rows, L / n apart
and L / 2n from its edges. A bow of b over L is straight within b (1 - 1/n)^2 over the rows, n odd.
A twist of c x y, whose zone is c L^2 / 2 on a square, is flat within c L^2 (1 - 1/n)^2 / 2.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from vmach.features.drawing.callout import read_callout
from vmach.features.evaluation import Drawing, Requirement, evaluate
from vmach.features.feature import Points, make_feature
from vmach.nominal import read_nominal
from vmach.nominal.feature_surface import surface_of_face

PART = Path(__file__).parents[2] / "samples" / "iso10791_7" / "part.step"
#: a square plane of the sample, mm
NAME, LENGTH_MM = "face 5 plane", 170.0


@cache
def square(spacing_mm):
    """The face, its points and their outward normals, (P, 3) each."""
    part = read_nominal(PART)
    (face,) = (face for face in part.faces if face.name == NAME)
    points = part.sample(spacing_mm)
    mine = points.feature == NAME
    return face, points.point_mm[mine], points.normal[mine]


def value(spacing_mm, text, deviation):
    """The value of a callout on the face, whose deviation is a function of x and y from its middle,
    mm."""
    face, nominal, normal = square(spacing_mm)
    ends = face.trim.segments_mm.reshape(-1, 3)
    x, y, _ = (nominal - 0.5 * (ends.min(axis=0) + ends.max(axis=0))).T
    points = Points(nominal, normal, deviation(x, y), np.ones(len(x), bool))
    surface = surface_of_face(face, nominal, normal)
    feature = make_feature("face", [surface], [np.arange(len(x))], [NAME])
    (found,) = evaluate(
        Drawing({"face": feature}, {}, ()), Requirement("face", read_callout(text)), points
    )
    return found.value_mm


@pytest.mark.parametrize(("spacing_mm", "rows"), [(3.0, 57), (2.0, 85), (10.0, 17)])
def test_rows_end_half_a_distance_from_the_edges(spacing_mm, rows):
    _, nominal, _ = square(spacing_mm)
    assert np.ptp(nominal[:, 0]) == pytest.approx(LENGTH_MM * (1.0 - 1.0 / rows), abs=0.1)


@pytest.mark.parametrize(("spacing_mm", "rows"), [(3.0, 57), (2.0, 85), (10.0, 17)])
def test_zones_are_those_of_the_rows(spacing_mm, rows):
    bow_mm, twist_per_mm = 0.0127, 1e-6
    reach = (1.0 - 1.0 / rows) ** 2
    found = value(
        spacing_mm, "straightness 0.1 along X", lambda x, _: bow_mm * (2 * x / LENGTH_MM) ** 2
    )
    assert found == pytest.approx(bow_mm * reach, rel=1.5e-3)
    found = value(spacing_mm, "flatness 0.1", lambda x, y: twist_per_mm * x * y)
    assert found == pytest.approx(0.5 * twist_per_mm * LENGTH_MM**2 * reach, rel=1.5e-3)
