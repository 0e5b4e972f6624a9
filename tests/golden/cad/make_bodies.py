"""Make surfaces.step and touching.step with OCP (PyPI ``cadquery-ocp``).

``python make_bodies.py``; prints the number of faces, the volume and the area of each solid.
"""

from pathlib import Path

from OCP.BRep import BRep_Builder
from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
from OCP.BRepGProp import BRepGProp
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder, BRepPrimAPI_MakeSphere
from OCP.gp import gp_Ax2, gp_Dir, gp_Pln, gp_Pnt
from OCP.GProp import GProp_GProps
from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer
from OCP.TopAbs import TopAbs_FACE, TopAbs_SHELL, TopAbs_SOLID
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS_Compound

HERE = Path(__file__).parent


def box(corner, size):
    return BRepPrimAPI_MakeBox(gp_Pnt(*corner), *size).Shape()


def cut(shape, tool):
    return BRepAlgoAPI_Cut(shape, tool).Shape()


def only(shape, kind):
    return TopExp_Explorer(shape, kind).Current()


def write(name, *shapes):
    compound = TopoDS_Compound()
    builder = BRep_Builder()
    builder.MakeCompound(compound)
    for shape in shapes:
        builder.Add(compound, shape)
    writer = STEPControl_Writer()
    writer.Transfer(compound, STEPControl_AsIs)
    writer.Write(str(HERE / name))


def facts(name, solid):
    volume, area = GProp_GProps(), GProp_GProps()
    BRepGProp.VolumeProperties_s(solid, volume)
    BRepGProp.SurfaceProperties_s(solid, area)
    explorer, faces = TopExp_Explorer(solid, TopAbs_FACE), 0
    while explorer.More():
        faces += 1
        explorer.Next()
    print(name, faces, volume.Mass(), area.Mass())


# a block with a bore; an open face and a closed shell lie beside it as construction geometry
bore = BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(10, 10, -1), gp_Dir(0, 0, 1)), 4, 12).Shape()
block = only(cut(box((0, 0, 0), (30, 20, 10)), bore), TopAbs_SOLID)
plane = BRepBuilderAPI_MakeFace(gp_Pln(gp_Pnt(0, 0, 15), gp_Dir(0, 0, 1)), -5, 35, -5, 25).Shape()
ball = only(BRepPrimAPI_MakeSphere(gp_Pnt(50, 0, 0), 5).Shape(), TopAbs_SHELL)
write("surfaces.step", block, plane, ball)
facts("surfaces", block)

# what two pockets leave of a block touches itself along a line 5 mm long
stepped = cut(box((0, 0, 0), (20, 20, 10)), box((0, 0, 5), (10, 10, 6)))
stepped = only(cut(stepped, box((10, 10, 5), (10, 10, 6))), TopAbs_SOLID)
write("touching.step", stepped)
facts("touching", stepped)
