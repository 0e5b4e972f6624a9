"""FreeCAD's simulator over a program of `bench_commands`, in FreeCAD's own interpreter.

    freecadcmd tests/benchmarks/peer_freecad.py PROGRAM

Its stock is a map of heights 0.1 mm apart, without undercuts; its tool, a flat one of 8 mm, is
never displaced. So it says what a coarse picture costs.
"""

import sys

import FreeCAD
import Part
import Path
import PathSimulator

#: side of the squares of the map, mm
CELL_MM = 0.1

program = next(word for word in sys.argv if word.endswith(".nc"))
simulator = PathSimulator.PathSim()
simulator.BeginSimulation(Part.makeBox(100, 100, 12, FreeCAD.Vector(-50, -50, -12)), CELL_MM)
simulator.SetToolShape(Part.makeCylinder(4, 50), CELL_MM)
path, place = Path.Path(), FreeCAD.Placement()
place.Base.z = 20.0
with open(program) as file:
    path.setFromGCode(file.read())
for command in path.Commands:
    if command.Name in ("G0", "G1", "G2", "G3"):
        place = simulator.ApplyCommand(place, command)
