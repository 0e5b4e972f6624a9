"""Make features.step with FreeCAD: ``freecadcmd make_features.py``; prints volume and area."""

import os

import Part
from FreeCAD import Vector

block = Part.makeBox(60, 40, 20, Vector(-30, -20, -20))
upright = [e for e in block.Edges if abs(e.Vertexes[0].Point.z - e.Vertexes[1].Point.z) > 10]
block = block.makeFillet(4, upright)
top = [e for e in block.Edges if all(abs(v.Point.z) < 1e-6 for v in e.Vertexes)]
block = block.makeFillet(2, top)
for tool in (
    Part.makeSphere(6, Vector(-15, 0, 2)),
    Part.makeCone(5, 2, 8, Vector(12, 0, -8)),
    Part.makeCylinder(3, 30, Vector(12, 0, -25)),
    Part.makeTorus(5, 1.5, Vector(0, 12, 0)),
    Part.makeCylinder(2.5, 100, Vector(-50, 8, -12), Vector(1, 0.1, 0)),
):
    block = block.cut(tool)
solid = block.Solids[0]
print(solid.Volume, solid.Area)
solid.exportStep(os.path.join(os.path.dirname(os.path.abspath(__file__)), "features.step"))
