"""Programs that FreeCAD's posts wrote give the paths from which they were written.

`tests/golden/freecad_posts` holds the paths (as FreeCAD's own commands) and the posted programs.
The path is worked out here from the commands alone; nothing of the reader is used for it.
"""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from gcode import Source, ToolEntry, read_program
from gcode.moves.moves import MoveKind

FOLDER = Path(__file__).parents[1] / "golden" / "freecad_posts"
PATHS = json.loads((FOLDER / "paths.json").read_text())
#: post -> the control that it writes for, digits that it writes
POSTS = {
    "fanuc": ("fanuc", 3),
    "heidenhain": ("heidenhain", 3),
    "linuxcnc": ("linuxcnc", 3),
    "grbl": ("linuxcnc", 3),
    "mach3_mach4": ("mach", 3),
    "centroid": ("centroid", 4),
}
TOOL = ToolEntry(length_mm=100.0, diameter_mm=10.0)
#: fractions of a move at which places are compared
AT = np.linspace(0.0, 1.0, 9)[:, None]


def straight(start, end):
    return start + AT * (end - start)


def arc(start, end, centre, clockwise):
    """Places on a helix about Z; equal ends are a full circle."""
    first, last = (math.atan2(*(p - centre)[1::-1]) for p in (start, end))
    turn = (first - last if clockwise else last - first) % (2.0 * math.pi) or 2.0 * math.pi
    angle = first + (-turn if clockwise else turn) * AT[:, 0]
    radius = np.linalg.norm((start - centre)[:2]) + AT[:, 0] * (
        np.linalg.norm((end - centre)[:2]) - np.linalg.norm((start - centre)[:2])
    )
    return np.stack([centre[0] + radius * np.cos(angle), centre[1] + radius * np.sin(angle),
                     straight(start, end)[:, 2]], axis=1)  # fmt: skip


def path_of(commands):
    """Moves of a path, (M, 9, 3), from its first complete place on; holes of cycles."""
    here, moves, holes = np.full(3, np.nan), [], []
    for name, words in commands:
        end = np.array([words.get(axis, was) for axis, was in zip("XYZ", here, strict=True)])
        if name in ("G81", "G82", "G83"):
            holes.append(end.copy())
            end[2] = here[2]
        elif name in ("G2", "G3"):
            centre = here + np.array([words.get("I", 0.0), words.get("J", 0.0), 0.0])
            moves.append(arc(here, end, centre, name == "G2"))
        elif not np.isnan(here).any():
            moves.append(straight(here, end))
        here = end
    return np.array([m for m in moves if np.ptp(m, axis=0).max() > 0]), np.array(holes)


def places_of(moves):
    """The same of what was read, (M, 9, 3)."""
    found = []
    for i in np.flatnonzero(moves.kind != MoveKind.DWELL):
        start, end, angle = moves.start_mm[i], moves.end_mm[i], moves.sweep_rad[i]
        if moves.kind[i] != MoveKind.ARC:
            found.append(straight(start, end))
            continue
        assert moves.axis[i] == pytest.approx([0, 0, 1])
        out = (start - moves.centre_mm[i])[:2]
        turned = np.arctan2(out[1], out[0]) + AT[:, 0] * angle
        radius = np.hypot(*out) + AT[:, 0] * (
            np.hypot(*(end - moves.centre_mm[i])[:2]) - np.hypot(*out)
        )
        places = straight(start, end)
        places[:, 0] = moves.centre_mm[i][0] + radius * np.cos(turned)
        places[:, 1] = moves.centre_mm[i][1] + radius * np.sin(turned)
        found.append(places)
    return np.array([m for m in found if np.ptp(m, axis=0).max() > 0])


def read(post, name):
    control, _ = POSTS[post]
    text = json.loads((FOLDER / f"{post}.json").read_text())[name]
    program = read_program(Source(text.encode(), f"{name}.nc"), tools={1: TOOL}, dialect=control)
    assert np.ptp(program.moves.tool_offset_mm[5:], axis=0).max() == 0.0
    return places_of(program.moves) - program.moves.tool_offset_mm[-3]


@pytest.mark.parametrize("post", POSTS)
@pytest.mark.parametrize("name", [name for name in PATHS if not name.startswith("drilling")])
def test_same_path(post, name):
    wanted, _ = path_of(PATHS[name])
    found = read(post, name)
    found = found[:-1] if post == "centroid" else found  # M25 behind the path
    found = found[-len(wanted) :]
    # half a digit at the ends; an arc's centre has it too, and its radius follows
    allowed = 3.0 * 10.0 ** -POSTS[post][1]
    assert found.shape == wanted.shape
    assert np.abs(found - wanted).max() < allowed


@pytest.mark.parametrize("post", POSTS)
@pytest.mark.parametrize("name", [name for name in PATHS if name.startswith("drilling")])
def test_same_holes(post, name):
    _, holes = path_of(PATHS[name])
    digit = 10.0 ** -POSTS[post][1]
    places = read(post, name)
    bottoms = places[:, -1][np.abs(places[:, -1, 2] - holes[0, 2]) < digit]
    assert bottoms == pytest.approx(holes, abs=digit)
    aside = np.abs(np.diff(places[:, [0, -1], :2], axis=1)).max(axis=(1, 2)) > digit
    assert places[aside][:, :, 2].min() > 1.9  # never beside a hole below the clearance
