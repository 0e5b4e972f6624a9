"""Solids of the two grooves that the toolpaths cut, written as STEP and STL.

Run with FreeCAD 0.20 or newer, from this folder:  freecadcmd make_cad.py
"""

import pathlib
import re

import MeshPart
import Part
from FreeCAD import Vector

HERE = pathlib.Path(__file__).resolve().parent
RADIUS_MM = 10


def bar(start, end, floor_mm):
    """What a flat tool sweeps between two points (x, y): a slot with round ends, 10 mm high."""
    start, end = Vector(*start, floor_mm), Vector(*end, floor_mm)
    across = (end - start).cross(Vector(0, 0, 1)).normalize() * RADIUS_MM
    corners = [start + across, end + across, end - across, start - across]
    middle = Part.Face(Part.makePolygon([*corners, corners[0]])).extrude(Vector(0, 0, 10))
    ends = [Part.makeCylinder(RADIUS_MM, 10, point) for point in (start, end)]
    return middle.multiFuse(ends)


def half_ring(centre, radius_mm, from_deg, floor_mm):
    """Half of a ring groove, from an angle counter-clockwise to 180 degrees further."""
    point = Vector(*centre, floor_mm)
    up = Vector(0, 0, 1)
    outside = Part.makeCylinder(radius_mm + RADIUS_MM, 10, point, up, 180)
    inside = Part.makeCylinder(radius_mm - RADIUS_MM, 10, point, up, 180)
    ring = outside.cut(inside)
    ring.rotate(point, up, from_deg)
    return ring


def groove(low, high, pieces):
    """Block with a groove."""
    size = [b - a for a, b in zip(low, high, strict=True)]
    block = Part.makeBox(*size, Vector(*low))
    return block.cut(pieces[0].multiFuse(pieces[1:])).removeSplitter()


def toolpath1():
    """Rectangle at z = -280."""
    corners = [(-350, -150), (-350, -350), (-650, -350), (-650, -150)]
    ends = [*corners[1:], corners[0]]
    bars = [bar(a, b, -280) for a, b in zip(corners, ends, strict=True)]
    return groove((-690, -390, -310), (-310, -110, -275), bars)


def toolpath2():
    """Three lines at 45 degrees and two half circles at z = -200."""
    lines = [
        ((-500, -450), (-280, -230)),
        ((-380, -130), (-620, -370)),
        ((-720, -270), (-500, -50)),
    ]
    pieces = [bar(a, b, -200) for a, b in lines]
    radius_mm = 50 * 2**0.5
    pieces.append(half_ring((-330, -180), radius_mm, -45, -200))
    pieces.append(half_ring((-670, -320), radius_mm, 135, -200))
    return groove((-770, -480, -230), (-230, -20, -195), pieces)


def export(solid, name):
    """Write STEP (with a fixed date, so that a second run gives the same file) and STL."""
    step = HERE / f"{name}.step"
    solid.exportStep(str(step))
    text = re.sub(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d", "2000-01-01T00:00:00", step.read_text())
    step.write_text(text)
    mesh = MeshPart.meshFromShape(solid, LinearDeflection=0.01, AngularDeflection=0.1)
    mesh.write(str(HERE / f"{name}.stl"))
    print(f"{name}: valid {solid.isValid()}, {solid.Volume:.4f} mm3, {len(solid.Faces)} faces")


export(toolpath1(), "toolpath1")
export(toolpath2(), "toolpath2")
