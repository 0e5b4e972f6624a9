"""Solid of the slot, written as STEP (walls as B-spline extrusions) and STL.

Run with FreeCAD 0.20 or newer, from this folder:  freecadcmd make_cad.py

A parallel of a spline is no spline: the walls interpolate exact points of it every 1.2 mm, with the
exact tangents at their ends, and stay within 2e-6 mm of it.
"""

import csv
import pathlib
import re

import MeshPart
import Part
from FreeCAD import Vector

HERE = pathlib.Path(__file__).resolve().parent
HALF_WIDTH_MM, DEPTH_MM = 15, 15
SPANS = 320


def centre_line():
    """Clamped uniform cubic B-spline over [0, 1] with the poles of the file."""
    with (HERE / "centreline.csv").open() as file:
        poles = [Vector(float(r["x_mm"]), float(r["y_mm"]), 0) for r in csv.DictReader(file)]
    spans = len(poles) - 3
    knots = [k / spans for k in range(spans + 1)]
    curve = Part.BSplineCurve()
    curve.buildFromPolesMultsKnots(poles, [4, *[1] * (spans - 1), 4], knots, False, 3)
    return curve


def left_normal(curve, u):
    """Unit normal to the left of the curve."""
    tangent = curve.getD1(u)[1].normalize()
    return Vector(-tangent.y, tangent.x, 0)


def wall(curve, offset_mm):
    """Parallel of the curve, interpolated."""
    us = [k / SPANS for k in range(SPANS + 1)]
    points = [curve.value(u) + left_normal(curve, u) * offset_mm for u in us]
    tangents = []
    for u in (0.0, 1.0):
        _, first, second = curve.getD2(u)
        curvature = first.cross(second).z / first.Length**3
        tangents.append(first * (1 - curvature * offset_mm))
    line = Part.BSplineCurve()
    line.interpolate(
        Points=points,
        Parameters=us,
        InitialTangent=tangents[0],
        FinalTangent=tangents[1],
        Scale=False,
    )
    return line


def worst_gap(curve, line, offset_mm):
    """Largest distance between the wall and the exact parallel, half-way between its points."""
    gap = 0.0
    for k in range(SPANS):
        u = (k + 0.5) / SPANS
        exact = curve.value(u) + left_normal(curve, u) * offset_mm
        gap = max(gap, exact.distanceToPoint(line.value(line.parameter(exact))))
    return gap


def slotted_block():
    """Block 380 x 160 x 60 with the slot; zero on its top face."""
    curve = centre_line()
    left, right = wall(curve, HALF_WIDTH_MM), wall(curve, -HALF_WIDTH_MM)
    gaps = [worst_gap(curve, left, HALF_WIDTH_MM), worst_gap(curve, right, -HALF_WIDTH_MM)]
    print(f"walls within {max(gaps):.1e} mm of the exact parallels")
    caps = []
    for u, outward in ((0.0, -1), (1.0, 1)):
        middle = curve.value(u)
        tip = middle + curve.getD1(u)[1].normalize() * (outward * HALF_WIDTH_MM)
        caps.append(Part.Arc(left.value(u), tip, right.value(u)).toShape())
    wire = Part.Wire(Part.__sortEdges__([left.toShape(), caps[0], right.toShape(), caps[1]]))
    slot = Part.Face(wire).extrude(Vector(0, 0, -DEPTH_MM))
    return Part.makeBox(380, 160, 60, Vector(-190, -80, -60)).cut(slot)


def export(solid, name):
    """Write STEP (with a fixed date, so that a second run gives the same file) and STL."""
    step = HERE / f"{name}.step"
    solid.exportStep(str(step))
    text = re.sub(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d", "2000-01-01T00:00:00", step.read_text())
    step.write_text(text)
    mesh = MeshPart.meshFromShape(solid, LinearDeflection=0.01, AngularDeflection=0.5)
    mesh.write(str(HERE / f"{name}.stl"))
    print(f"valid {solid.isValid()}, {solid.Volume:.4f} mm3, {len(solid.Faces)} faces")


export(slotted_block(), "slot")
