"""The solid and, from it, the program: FreeCAD 0.20 (Path workbench, now called CAM) does both.

Run from this folder:  freecadcmd make_program.py

Job, tool controllers, pocket and profile operations, post-processor linuxcnc. The program is what
FreeCAD wrote, not touched by hand.
"""

import pathlib
import re

import FreeCAD
import MeshPart
import Part
import Path
import PathScripts.PathJob as PathJob
import PathScripts.PathPocketShape as PathPocket
import PathScripts.PathProfile as PathProfile
import PathScripts.PathStock as PathStock
import PathScripts.PathToolBit as PathToolBit
import PathScripts.PathToolController as PathToolController
import PathScripts.PathUtils as PathUtils
from FreeCAD import Vector
from PathScripts.post import linuxcnc_post

HERE = pathlib.Path(__file__).resolve().parent


class FirstController:
    """Answers for the user whom FreeCAD asks for a tool when an operation is created."""

    def selectedToolController(self):
        return None

    def chooseToolController(self, controllers):
        return controllers[0]

    def chooseJob(self, jobs):
        return jobs[0]


PathUtils.UserInput = FirstController()
# arcs are fitted within this, mm; FreeCAD's own 0.01 mm would show as 6 um on the walls
Path.Area.setDefaultParams(Accuracy=0.0001)


def rounded_block(size_mm, radius_mm, corner_mm):
    """Box with rounded vertical edges."""
    block = Part.makeBox(*size_mm, Vector(*corner_mm))
    upright = [e for e in block.Edges if abs(e.Vertexes[0].Z - e.Vertexes[1].Z) > 1e-6]
    return block.makeFillet(radius_mm, upright)


def bracket():
    """Block 110 x 70 on a flange, with a rounded pocket, a round one and a step between."""
    body = Part.makeBox(118, 78, 10, Vector(-59, -39, -25))
    body = body.fuse(rounded_block((110, 70, 15), 10, (-55, -35, -15)))
    body = body.cut(rounded_block((50, 44, 12), 7, (-47, -22, -8)))
    body = body.cut(Part.makeCylinder(16, 20, Vector(28, 0, -12)))
    return body.removeSplitter()


def face_at(solid, z_mm, near):
    """Name of the horizontal face at height z whose box contains the point (x, y)."""
    for number, face in enumerate(solid.Faces, 1):
        box = face.BoundBox
        flat = box.ZLength < 1e-6 and abs(box.ZMax - z_mm) < 1e-6
        if flat and box.XMin < near[0] < box.XMax and box.YMin < near[1] < box.YMax:
            return f"Face{number}"
    raise LookupError(f"no face at z = {z_mm}")


def end_mill(job, *, number, diameter_mm, flutes_mm, feed_mm_min, speed_rpm):
    """Tool controller with an end mill."""
    tool = PathToolBit.Factory.Create(f"End mill {diameter_mm:g}")
    tool.Diameter = f"{diameter_mm} mm"
    tool.CuttingEdgeHeight = f"{flutes_mm} mm"
    controller = PathToolController.Create(f"T{number} D{diameter_mm:g}", tool, number)
    controller.HorizFeed = f"{feed_mm_min / 60} mm/s"
    controller.VertFeed = f"{feed_mm_min / 180} mm/s"
    controller.SpindleSpeed = speed_rpm
    job.Proxy.addToolController(controller)
    return controller


def set_depths(operation, *, start_mm, final_mm, step_mm):
    """Depths as fixed numbers instead of FreeCAD's expressions."""
    for name, value in (
        ("StartDepth", start_mm),
        ("FinalDepth", final_mm),
        ("StepDown", step_mm),
        ("SafeHeight", 3),
        ("ClearanceHeight", 20),
    ):
        operation.setExpression(name, None)
        setattr(operation, name, value)


def pocket(job, name, face, controller, **depths):
    """Pocket to a horizontal face, offset pattern."""
    operation = PathPocket.Create(name, parentJob=job)
    operation.Base = [(job.Model.Group[0], [face])]
    operation.ToolController = controller
    operation.OffsetPattern = "Offset"
    operation.StepOver = 45
    operation.StartAt = "Center"
    operation.CutMode = "Climb"
    set_depths(operation, **depths)


def profile(job, name, face, controller, *, allowance_mm, **depths):
    """Outside profile around a horizontal face."""
    operation = PathProfile.Create(name, parentJob=job)
    operation.Base = [(job.Model.Group[0], [face])]
    operation.ToolController = controller
    operation.Side = "Outside"
    operation.Direction = "CW"
    operation.UseComp = True
    operation.OffsetExtra = allowance_mm
    set_depths(operation, **depths)


def make_job(document, solid):
    """The machining job: stock, two tools, rough and finish profile, two pockets."""
    feature = document.addObject("Part::Feature", "Bracket")
    feature.Shape = solid
    document.recompute()
    job = PathJob.Create("Job", [feature])
    job.GeometryTolerance = 0.001
    job.Stock = PathStock.CreateFromBase(job, neg=Vector(0, 0, 0), pos=Vector(0, 0, 0))
    for controller in list(job.Tools.Group):
        document.removeObject(controller.Name)
    big = end_mill(job, number=1, diameter_mm=12, flutes_mm=30, feed_mm_min=800, speed_rpm=4200)
    small = end_mill(job, number=2, diameter_mm=10, flutes_mm=25, feed_mm_min=700, speed_rpm=5200)
    document.recompute()
    top = face_at(solid, 0, (50, 30))
    outer = {"start_mm": 0, "final_mm": -15}
    profile(job, "Rough profile", top, big, allowance_mm=0.3, step_mm=5, **outer)
    profile(job, "Finish profile", top, big, allowance_mm=0, step_mm=15, **outer)
    pocket(
        job,
        "Rounded pocket",
        face_at(solid, -8, (-22, 0)),
        small,
        start_mm=0,
        final_mm=-8,
        step_mm=4,
    )
    pocket(
        job,
        "Round pocket",
        face_at(solid, -12, (28, 0)),
        small,
        start_mm=0,
        final_mm=-12,
        step_mm=4,
    )
    document.recompute()
    return job


def postprocess(job, path):
    """Write the program with the post-processor linuxcnc."""
    objects = []
    current = None
    for operation in job.Operations.Group:
        if operation.ToolController is not current:
            current = operation.ToolController
            objects.append(current)
        objects.append(operation)
    linuxcnc_post.export(objects, str(path), "--no-show-editor --precision=4 --no-header")


def export(solid):
    """STEP (with a fixed date) and STL of the solid."""
    step = HERE / "part.step"
    solid.exportStep(str(step))
    text = re.sub(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d", "2000-01-01T00:00:00", step.read_text())
    step.write_text(text)
    mesh = MeshPart.meshFromShape(solid, LinearDeflection=0.005, AngularDeflection=0.1)
    mesh.write(str(HERE / "part.stl"))


document = FreeCAD.newDocument("bracket")
part = bracket()
print(f"valid {part.isValid()}, volume {part.Volume:.4f} mm3, {len(part.Faces)} faces")
export(part)
postprocess(make_job(document, part), HERE / "part.nc")
