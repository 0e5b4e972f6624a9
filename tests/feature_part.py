"""A block with two bores, a pin, a slanting face and a ball, as inspected points."""

from __future__ import annotations

import numpy as np

from vmach.features.drawing.callout import read_callout
from vmach.features.evaluation import Drawing, Requirement, evaluate
from vmach.features.feature import Points, make_feature
from vmach.features.surface import Surface

#: the slanting face rises by this angle about Y
SLANT_RAD = np.radians(30.0)
BORE_MM, PIN_MM, BALL_MM = 20.0, 16.0, 12.0


def round_face(x, y, radius, heights, sign, count=36):
    """Rings of points about a vertical axis."""
    angle = np.arange(count) * 2 * np.pi / count
    away = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(count)])
    rings = [radius * away + [x, y, z] for z in heights]
    normals = np.tile(sign * away, (len(rings), 1))
    surface = Surface("cylinder", [x, y, 0.0], [0, 0, 1], radius, sign=sign)
    return np.vstack(rings), normals, surface


def flat_face(corner, u, v, normal, counts=(15, 11)):
    """A grid of points over a parallelogram."""
    s, t = np.meshgrid(*[np.linspace(0, 1, n) for n in counts])
    points = np.add(corner, np.outer(s.ravel(), u) + np.outer(t.ravel(), v))
    surface = Surface("plane", corner, normal)
    return points, np.tile(surface.axis, (len(points), 1)), surface


def ball_face(centre, radius):
    rng = np.random.default_rng(1)
    away = rng.normal(size=(150, 3))
    away /= np.linalg.norm(away, axis=1)[:, None]
    return centre + radius * away, away, Surface("sphere", centre, [0, 0, 1], radius)


HEIGHTS = np.linspace(-28.0, -2.0, 9)
FACES = {
    "top": flat_face([0, 0, 0], [100, 0, 0], [0, 60, 0], [0, 0, 1]),
    "bottom": flat_face([0, 0, -30], [100, 0, 0], [0, 60, 0], [0, 0, -1]),
    "left": flat_face([0, 0, -30], [0, 60, 0], [0, 0, 30], [-1, 0, 0]),
    "right": flat_face([100, 0, -30], [0, 60, 0], [0, 0, 30], [1, 0, 0]),
    "front": flat_face([0, 0, -30], [100, 0, 0], [0, 0, 30], [0, -1, 0]),
    "slant": flat_face([100, 0, 0], [20 * np.cos(SLANT_RAD), 0, 20 * np.sin(SLANT_RAD)],
                       [0, 60, 0], [-np.sin(SLANT_RAD), 0, np.cos(SLANT_RAD)]),
    "bore 1": round_face(20, 30, BORE_MM / 2, HEIGHTS, -1.0),
    "bore 2": round_face(80, 30, BORE_MM / 2, HEIGHTS, -1.0),
    "pin": round_face(20, 30, PIN_MM / 2, np.linspace(2, 20, 9), 1.0),
    "ball": ball_face(np.array([50.0, 30.0, 20.0]), BALL_MM / 2),
}  # fmt: skip
MADE_OF = {
    **{name: (name,) for name in FACES},
    "bores": ("bore 1", "bore 2"),
    "length": ("left", "right"),
    "outside": ("left", "right", "front"),
}
DATUMS = {"A": "top", "B": "left", "C": "front", "D": "bore 2", "E": "bore 1"}
NOMINAL = np.vstack([points for points, _, _ in FACES.values()])
NORMAL = np.vstack([normals for _, normals, _ in FACES.values()])
ENDS = np.cumsum([len(points) for points, _, _ in FACES.values()])
ROWS = dict(zip(FACES, np.split(np.arange(ENDS[-1]), ENDS[:-1]), strict=True))
FEATURES = {
    name: make_feature(name, [FACES[f][2] for f in faces], [ROWS[f] for f in faces], faces)
    for name, faces in MADE_OF.items()
}


def part(**deviations) -> Points:
    """The part with deviations, mm, by face (blanks as _): numbers, or functions of its points."""
    deviation = np.zeros(len(NOMINAL))
    for face, given in deviations.items():
        rows = ROWS[face.replace("_", " ")]
        deviation[rows] = given(NOMINAL[rows]) if callable(given) else given
    return Points(NOMINAL, NORMAL, deviation, np.ones(len(NOMINAL), bool))


def moved(points: Points, shift=(0, 0, 0), turn=(0, 0, 0)) -> Points:
    """The part laid elsewhere by a small motion."""
    motion = np.add(shift, np.cross(turn, NOMINAL))
    deviation = points.deviation_mm + np.einsum("ij,ij->i", motion, NORMAL)
    return Points(NOMINAL, NORMAL, deviation, points.is_known)


def measures(points: Points, feature: str, text: str, association="least squares"):
    """What `evaluate` finds for a callout."""
    drawing = Drawing(FEATURES, DATUMS, (), association)
    return evaluate(drawing, Requirement(feature, read_callout(text)), points)


def values(points: Points, feature: str, text: str, association="least squares"):
    """The values alone, mm."""
    return [measure.value_mm for measure in measures(points, feature, text, association)]
