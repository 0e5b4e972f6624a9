"""Solid of the circle-diamond-square test piece, as STEP and STL.

Run with FreeCAD 0.20 or newer, from this folder:  freecadcmd make_cad.py
"""

import re
from pathlib import Path

import MeshPart
import Part
from FreeCAD import Vector

HERE = Path(__file__).resolve().parent
SQUARE_MM, DIAMOND_MM, CIRCLE_MM, BORE_MM = 127.0, 88.0, 86.0, 25.4
CIRCLE_Z_MM, DIAMOND_Z_MM, SQUARE_Z_MM, BOTTOM_MM = -6.35, -12.7, -25.4, -38.1


def square(across_mm, bottom_mm, top_mm, angle_deg=0.0):
    """Square prism about Z."""
    half = across_mm / 2
    prism = Part.makeBox(across_mm, across_mm, top_mm - bottom_mm, Vector(-half, -half, bottom_mm))
    prism.rotate(Vector(0, 0, 0), Vector(0, 0, 1), angle_deg)
    return prism


body = square(130.0, BOTTOM_MM, SQUARE_Z_MM).multiFuse(
    [
        square(SQUARE_MM, SQUARE_Z_MM, DIAMOND_Z_MM),
        square(DIAMOND_MM, DIAMOND_Z_MM, CIRCLE_Z_MM, 45.0),
        Part.makeCylinder(CIRCLE_MM / 2, -CIRCLE_Z_MM, Vector(0, 0, CIRCLE_Z_MM)),
    ]
)
piece = body.cut(Part.makeCylinder(BORE_MM / 2, -BOTTOM_MM, Vector(0, 0, BOTTOM_MM)))
piece = piece.removeSplitter()
step = HERE / "part.step"
piece.exportStep(str(step))
text = re.sub(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d", "2000-01-01T00:00:00", step.read_text())
step.write_text(text)
mesh = MeshPart.meshFromShape(piece, LinearDeflection=0.02, AngularDeflection=0.05)
mesh.write(str(HERE / "part.stl"))
print(f"valid {piece.isValid()}, volume {piece.Volume:.4f} mm3, {len(piece.Faces)} faces")
