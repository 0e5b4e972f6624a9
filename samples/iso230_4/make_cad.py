"""Plate with the ring groove of the circular test, as STEP and STL.

Run with FreeCAD 0.20 or newer, from this folder:  freecadcmd make_cad.py
"""

import re
from pathlib import Path

import MeshPart
import Part
from FreeCAD import Vector

HERE = Path(__file__).resolve().parent
RADIUS_MM, TOOL_RADIUS_MM, DEPTH_MM = 100.0, 5.0, 1.0


def ring(inner_mm, outer_mm, bottom_mm, top_mm):
    """Ring about Z."""
    outer = Part.makeCylinder(outer_mm, top_mm - bottom_mm, Vector(0, 0, bottom_mm))
    return outer.cut(Part.makeCylinder(inner_mm, top_mm - bottom_mm, Vector(0, 0, bottom_mm)))


plate = Part.makeBox(240, 240, 20, Vector(-120, -120, -20))
plate = plate.cut(ring(RADIUS_MM - TOOL_RADIUS_MM, RADIUS_MM + TOOL_RADIUS_MM, -DEPTH_MM, 0))
step = HERE / "part.step"
plate.exportStep(str(step))
text = re.sub(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d", "2000-01-01T00:00:00", step.read_text())
step.write_text(text)
mesh = MeshPart.meshFromShape(plate, LinearDeflection=0.02, AngularDeflection=0.05)
mesh.write(str(HERE / "part.stl"))
print(f"valid {plate.isValid()}, volume {plate.Volume:.4f} mm3, {len(plate.Faces)} faces")
