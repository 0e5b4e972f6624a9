"""Solid of the contouring test piece, written as STEP and STL.

Run with FreeCAD 0.20 or newer, from this folder:  freecadcmd make_cad.py

The two rotated squares are taken from the corners that the finishing path of part.nc is
programmed to, four decimals, less the tool's radius: the solid is then exactly what the program
makes (the diamond is 103.99998 mm across flats, not 104), and a perfect machine shows zero.
"""

import math
import re
from pathlib import Path

import MeshPart
import Part
from FreeCAD import Rotation, Vector

FINISHING_RADIUS_MM = 8.0
DIAMOND_PATH_CORNER_MM = (0.0, 84.8528)
TILTED_PATH_CORNER_MM = (78.5424, 87.2301)
HERE = Path(__file__).resolve().parent


def square(half_mm, bottom_mm, top_mm, angle_deg=0.0):
    """Square prism about Z, turned by an angle."""
    prism = Part.makeBox(
        2 * half_mm, 2 * half_mm, top_mm - bottom_mm, Vector(-half_mm, -half_mm, bottom_mm)
    )
    prism.Placement.Rotation = Rotation(Vector(0, 0, 1), 0)
    prism.rotate(Vector(0, 0, 0), Vector(0, 0, 1), angle_deg)
    return prism


def square_inside_path(corner_mm, bottom_mm, top_mm):
    """Prism that a square tool path leaves: one corner of the path gives size and angle."""
    x, y = corner_mm
    half = math.hypot(x, y) / math.sqrt(2) - FINISHING_RADIUS_MM
    return square(half, bottom_mm, top_mm, math.degrees(math.atan2(y, x)) - 45)


def cylinder(radius_mm, bottom_mm, top_mm, centre_mm=(0, 0)):
    """Cylinder along Z."""
    return Part.makeCylinder(radius_mm, top_mm - bottom_mm, Vector(*centre_mm, bottom_mm))


def test_piece():
    """Base, square, square at 3 degrees, diamond, circle; centre bore and four bores."""
    body = square(85, -50, -30).multiFuse(
        [
            square(80, -30, -20),
            square_inside_path(TILTED_PATH_CORNER_MM, -20, -12),
            square_inside_path(DIAMOND_PATH_CORNER_MM, -12, -6),
            cylinder(50, -6, 0),
        ]
    )
    bores = [cylinder(15, -50, 0)]
    bores += [cylinder(13, -30, -12, (x, y)) for x in (-52, 52) for y in (-52, 52)]
    return body.cut(bores).removeSplitter()


def export(solid, name):
    """Write STEP (with a fixed date, so that a second run gives the same file) and STL."""
    step = HERE / f"{name}.step"
    solid.exportStep(str(step))
    text = re.sub(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d", "2000-01-01T00:00:00", step.read_text())
    step.write_text(text)
    mesh = MeshPart.meshFromShape(solid, LinearDeflection=0.005, AngularDeflection=0.05)
    mesh.write(str(HERE / f"{name}.stl"))


piece = test_piece()
export(piece, "part")
print(f"valid {piece.isValid()}, volume {piece.Volume:.4f} mm3, {len(piece.Faces)} faces")
