"""Write paths and what FreeCAD's posts make of them: ``freecadcmd make_golden.py``.

Every path is a list of commands as FreeCAD's Path workbench holds them (absolute, mm, mm/s, arc
centres from the start). `paths.json` holds them; a file a post holds the programs. FreeCAD 0.20.
"""

import importlib
import json
import math
import os
import random
import sys
import tempfile

import FreeCAD

sys.path.insert(0, FreeCAD.getResourceDir() + "Mod/Path")
sys.path.insert(0, "/usr/share/freecad/Mod/Path")
import Path
from PathScripts import PathToolController, PostUtils

HERE = os.path.dirname(os.path.abspath(__file__))
POSTS = ("fanuc", "heidenhain", "linuxcnc", "grbl", "mach3_mach4", "centroid")
SEED = 20230517
PostUtils.editor = lambda text: text
for kind in ("PathHelix", "PathMillFace", "PathProfileEdges"):  # a post asks for their classes
    importlib.import_module(f"PathScripts.{kind}")


class Operation:
    """What a post asks of an object of a job."""

    def __init__(self, name, commands, proxy=None):
        self.Name = self.Label = name
        self.Proxy = proxy or object()
        self.Path = Path.Path([Path.Command(n, w) for n, w in commands])
        self.Active = True


class Mill:
    ToolType = "EndMill"


def tool_change(number, speed):
    proxy = PathToolController.ToolController.__new__(PathToolController.ToolController)
    change = Operation(f"T{number}", [("M6", {"T": number}), ("M3", {"S": speed})], proxy)
    change.ToolNumber, change.SpindleSpeed, change.SpindleDir = number, speed, "Forward"
    change.Tool = Mill()
    return change


def place(random, low=-60.0, high=60.0):
    return round(random.uniform(low, high), 3)


def start(random):
    x, y = place(random), place(random)
    return [("G0", {"Z": 20.0}), ("G0", {"X": x, "Y": y}), ("G0", {"Z": 5.0})], x, y


def facing(random):
    commands, x, y = start(random)
    feed = float(random.randint(5, 40))
    commands.append(("G1", {"X": x, "Y": y, "Z": -1.0, "F": feed / 2}))
    for row in range(6):
        x = round(x + (40 if row % 2 == 0 else -40), 3)
        commands.append(("G1", {"X": x, "Y": y, "Z": -1.0, "F": feed}))
        y = round(y + 4.125, 3)
        commands.append(("G1", {"X": x, "Y": y, "Z": -1.0, "F": feed}))
    return [*commands, ("G0", {"Z": 20.0})]


def arc(random, name, plane, here, *, turn=None, climb=0.0):
    """One arc from `here`; plane of axes (a, b), the third climbs."""
    a, b, third = plane
    radius = round(random.uniform(4, 30), 3)
    first = random.uniform(0, 2 * math.pi)
    turn = turn or random.uniform(0.3, 5.5)
    centre = (
        round(here[a] - radius * math.cos(first), 3),
        round(here[b] - radius * math.sin(first), 3),
    )
    radius = math.hypot(here[a] - centre[0], here[b] - centre[1])
    first = math.atan2(here[b] - centre[1], here[a] - centre[0])
    last = first + (turn if name == "G3" else -turn)
    end = dict(here)
    end[a] = centre[0] + radius * math.cos(last)
    end[b] = centre[1] + radius * math.sin(last)
    end[third] = here[third] + climb
    letter = {"X": "I", "Y": "J", "Z": "K"}
    words = {**end, letter[a]: centre[0] - here[a], letter[b]: centre[1] - here[b], "F": 12.0}
    return (name, words), end


def contour(random):
    commands, x, y = start(random)
    here = {"X": x, "Y": y, "Z": -2.0}
    commands.append(("G1", {**here, "F": 3.0}))
    for _ in range(6):
        if random.random() < 0.5:
            here = {**here, "X": place(random), "Y": place(random)}
            commands.append(("G1", {**here, "F": 15.0}))
        else:
            command, here = arc(random, random.choice(("G2", "G3")), "XYZ", here)
            commands.append(command)
    return [*commands, ("G0", {"Z": 20.0})]


def helix(random):
    commands, x, y = start(random)
    here = {"X": x, "Y": y, "Z": 1.0}
    commands.append(("G1", {**here, "F": 3.0}))
    for _ in range(4):
        command, here = arc(random, "G3", "XYZ", here, turn=math.pi, climb=-0.75)
        commands.append(command)
    return [*commands, ("G0", {"Z": 20.0})]


def circles(random):
    commands, x, y = start(random)
    here = {"X": x, "Y": y, "Z": -1.5}
    commands.append(("G1", {**here, "F": 3.0}))
    for name in ("G2", "G3"):
        for _ in range(2):
            command, here = arc(random, name, "XYZ", here, turn=math.pi)
            commands.append(command)
    return [*commands, ("G0", {"Z": 20.0})]


def ramps(random):
    commands, *_ = start(random)
    for _ in range(8):
        commands.append(("G1", {"X": place(random), "Y": place(random), "Z": place(random, -9, 0),
                                "F": float(random.randint(2, 40))}))  # fmt: skip
    return [*commands, ("G0", {"Z": 20.0}), ("G0", {"X": 0.0, "Y": 0.0})]


def drilling(random):
    commands, *_ = start(random)
    depth, clear = round(random.uniform(-12, -4), 3), 2.0
    kind = random.choice(("G81", "G82", "G83"))
    words = {"Z": depth, "R": clear, "F": 4.0}
    words |= {"P": 0.5} if kind == "G82" else {"Q": 1.75} if kind == "G83" else {}
    commands.append(("G98", {}))
    for _ in range(5):
        commands.append((kind, {"X": place(random), "Y": place(random), **words}))
    return [*commands, ("G80", {}), ("G0", {"Z": 20.0})]


KINDS = (facing, contour, helix, circles, ramps, drilling)


def main():
    generator = random.Random(SEED)
    paths = [(f"{kind.__name__}_{index}", kind(generator)) for index in range(6) for kind in KINDS]
    write("paths", dict(paths))
    for post in POSTS:
        write(post, {name: posted(post, name, commands) for name, commands in paths})


def posted(post, name, commands):
    module = importlib.reload(importlib.import_module(f"PathScripts.post.{post}_post"))
    objects = [tool_change(1, 3000), Operation(name, commands)]
    with tempfile.TemporaryDirectory() as folder:
        target = f"{folder}/O1000"  # Fanuc's post makes the program's name of it
        module.export(objects, target, "--no-show-editor")
        with open(target) as file:  # without the time and the folder
            return "".join(
                line
                for line in file
                if "output time" not in line.lower() and folder.upper() not in line.upper()
            )


def write(name, content):
    with open(f"{HERE}/{name}.json", "w") as file:
        json.dump(content, file, indent=0)
        file.write("\n")


main()
os._exit(0)
