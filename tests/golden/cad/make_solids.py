"""Make small solids and points on them with FreeCAD: ``freecadcmd make_solids.py``.

Writes NAME.step and solids.json: volume, area and, for each face, points inside its edges with
the kernel's outward normals.
"""

import itertools
import json
import math
import os
import random

import Part
from FreeCAD import Vector

HERE = os.path.dirname(os.path.abspath(__file__))
POINTS_PER_FACE = 4


def loft():
    wires = [
        Part.Wire(Part.makeCircle(20)),
        Part.Wire(Part.Ellipse(Vector(0, 0, 0), 14, 8).toShape()),
        Part.Wire(Part.makeCircle(9, Vector(0, 0, 45))),
    ]
    wires[1].translate(Vector(3, 2, 25))
    return Part.makeLoft(wires, True)


def nut():
    corners = [
        Vector(15 * math.cos(i * math.pi / 3), 15 * math.sin(i * math.pi / 3), 0) for i in range(7)
    ]
    prism = Part.Face(Part.Wire(Part.makePolygon(corners))).extrude(Vector(0, 0, 12))
    return prism.common(Part.makeCone(22, 12, 20)).cut(Part.makeCylinder(6, 20))


def void():
    return Part.makeBox(30, 30, 30).cut(Part.makeSphere(8, Vector(15, 15, 15)))


def octant():
    return Part.makeSphere(12, Vector(1, 2, 3), Vector(0, 0, 1), 0, 90, 90)


def revolved():
    profile = Part.BSplineCurve()
    profile.interpolate([Vector(10, 0, 0), Vector(13, 0, 5), Vector(9, 0, 12), Vector(12, 0, 20)])
    corners = [Vector(12, 0, 20), Vector(0, 0, 20), Vector(0, 0, 0), Vector(10, 0, 0)]
    lines = [Part.makeLine(a, b) for a, b in itertools.pairwise(corners)]
    wire = Part.Wire([profile.toShape(), *lines])
    return Part.Face(wire).revolve(Vector(0, 0, 0), Vector(0, 0, 1), 360)


def nurbs_torus():
    return Part.makeTorus(20, 5).toNurbs()


def points_on(face):
    """x, y, z and the outward normal of random points at least 0.05 mm inside the edges."""
    u0, u1, v0, v1 = face.ParameterRange
    found = []
    while len(found) < POINTS_PER_FACE:
        u, v = random.uniform(u0, u1), random.uniform(v0, v1)
        point, normal = face.valueAt(u, v), face.normalAt(u, v)
        away = min(edge.distToShape(Part.Vertex(point))[0] for edge in face.Edges)
        if face.isPartOfDomain(u, v) and away > 0.05:
            found.append([*point, *normal])
    return found


random.seed(1)
facts = {}
for make in (loft, nut, void, octant, revolved, nurbs_torus):
    solid = make().Solids[0]
    solid.exportStep(os.path.join(HERE, make.__name__ + ".step"))
    facts[make.__name__] = {
        "volume_mm3": solid.Volume,
        "area_mm2": solid.Area,
        "points": [points_on(face) for face in solid.Faces],
    }
with open(os.path.join(HERE, "solids.json"), "w") as file:
    json.dump(facts, file, indent=1)
