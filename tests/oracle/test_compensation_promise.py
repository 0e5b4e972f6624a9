"""What `compensate` promises, against exact machines that share no code with it.

Every machine is a chain of rigid bodies multiplied out, with tables of its own that were drawn
within their standard uncertainty. It runs the written program, whose words are read here. What it
leaves on walls and floor is looked at in closed form.
"""

import re

import numpy as np
import pytest

from vmach.compensation import compensate
from vmach.compensation.aim.surface import check_surface, read_surface
from vmach.job import read_job

L, R, ZERO = 100.0, 5.0, np.array([-200.0, -150.0, -200.0])
#: standard uncertainties of a table's value and of a right angle
U_UM, U_URAD, U_SQUARE_URAD = 0.7, 1.2, 2.0
NODES = {"X": np.linspace(-400, 0, 9), "Y": np.linspace(-300, 0, 7), "Z": np.linspace(-300, 0, 7)}
#: lowest and highest value of straight tables, um or urad: a straight curve has no bend
ENDS = {
    "EXX": (21, -4), "EYX": (-9, 3), "EZX": (5, 12), "EAX": (-22, 8), "EBX": (30, -6),
    "ECX": (-17, 25), "EXY": (4, -11), "EYY": (-14, 6), "EZY": (9, 2), "EAY": (12, -20),
    "EBY": (-8, 15), "ECY": (26, -10), "EXZ": (-6, 7), "EYZ": (10, -3), "EZZ": (16, -8),
    "EAZ": (9, -19), "EBZ": (-25, 4), "ECZ": (13, -13),
}  # fmt: skip
PLACE = {"X": (-150.0, -90.0, -260.0), "Y": (20.0, -120.0, -230.0), "Z": (0.0, 15.0, -140.0)}
SQUARE = {"EC0Y": 30.0, "EB0X": -18.0, "EA0Y": 12.0}

PROGRAM = """\
%
G21 G17 G90 G94 G40
T1 M6
S6000 M3
G54 G43 H1
G0 X-60 Y25 Z5
G1 Z-8 F300
(one) G1 X60 F900
G0 Z5
G0 X55 Y-40
G1 Z-6 F300
(two) G1 Y40 F900
G0 Z5
G0 X-60 Y0
G1 Z-3 F300
(three) G1 X40 F900
G0 Z5
M30
%
"""
POINTS = [
    *(("wall +Y", (x, 20.0, z), (0, 1, 0)) for x in np.linspace(-48, 33, 10) for z in (-7.0, -2.0)),
    *(("wall +X", (50.0, y, z), (1, 0, 0)) for y in np.linspace(-28, 13, 8) for z in (-5.0, -4.0)),
    *(("floor", (x, y, -3.0), (0, 0, 1)) for x in np.linspace(-48, 33, 10) for y in (-3.0, 2.0)),
]


def write(folder):
    """The job of the straight tables."""
    machine = """\
schema = 1
name = "straight tables"
chain = "t (C) Z Y b X' w"
[convention]
sign = "relative"
length = "um"
angle = "urad"
[motion]
rapid_mm_min = 12000
tool_change_s = 5
[axes.X]
travel_mm = [-400, 0]
[axes.Y]
travel_mm = [-300, 0]
[axes.Z]
travel_mm = [-300, 0]
[uncertainty]
"""
    machine += f"reading_um = {U_UM}\nreading_urad = {U_URAD}\nsquareness_urad = {U_SQUARE_URAD}\n"
    machine += "[squareness]\n" + "".join(f"{k} = {v}\n" for k, v in SQUARE.items())
    for name in ENDS:
        nodes = NODES[name[2]]
        rows = [
            f"{p!r},{v!r}" for p, v in zip(nodes.tolist(), straight(name).tolist(), strict=True)
        ]
        (folder / f"{name}.csv").write_text("\n".join(["position_mm,error", *rows, ""]))
        machine += f'[errors.{name}]\ntable = "{name}.csv"\n'
        machine += f"measured_at_mm = {list(PLACE[name[2]])}\n" if name[1] in "XYZ" else ""
    (folder / "machine.toml").write_text(machine)
    (folder / "part.nc").write_text(PROGRAM)
    lines = [f"{k},{name},{','.join(map(repr, [*map(float, p), *n, *map(float, p)]))}"
             for k, (name, p, n) in enumerate(POINTS)]  # fmt: skip
    (folder / "points.csv").write_text("\n".join(["id,feature,x,y,z,i,j,k,mx,my,mz", *lines, ""]))
    (folder / "job.toml").write_text("""\
schema = 1
machine = "machine.toml"
program = "part.nc"
measured = "points.csv"
[work_offsets_mm]
G54 = [-200, -150, -200]
[stock]
min_mm = [-55, -35, -20]
max_mm = [58, 28, 0]
[tools.1]
shape = "flat"
diameter_mm = 10
length_mm = 100
""")
    return read_job(folder)


def straight(name):
    first, last = ENDS[name]
    return np.linspace(first, last, len(NODES[name[2]]))


def commanded(text):
    """The polylines of the three cuts as the words say, workpiece coordinates of the tip."""
    place, cuts, own = np.array([0.0, 0.0, 0.0]), {}, None
    for line in text.decode("latin-1").splitlines():
        label = re.match(r"\((one|two|three)\)", line)
        if line.startswith("G0"):
            own = None
        if label:
            own = cuts.setdefault(label[1], [place.copy()])
        for axis, value in re.findall(r"([XYZ])(-?[\d.]+)", line):
            place["XYZ".index(axis)] = float(value)
        if own is not None:
            own.append(place.copy())
    return {name: np.array(rows) for name, rows in cuts.items()}


def turned(angles, vector):
    """Vectors turned by three small angles, exactly (Rodrigues' formula), (..., 3)."""
    size = np.linalg.norm(angles, axis=-1, keepdims=True)
    unit = angles / np.where(size > 0, size, 1.0)
    along = (unit * vector).sum(axis=-1, keepdims=True)
    return (np.cos(size) * vector + np.sin(size) * np.cross(unit, vector)
            + (1 - np.cos(size)) * along * unit)  # fmt: skip


def body(tables, axis, q):
    """Angles, and shift of the body's origin, of N machines at Q places: (N, Q, 3)."""
    at = {n: np.array([np.interp(q, NODES[axis], row) for row in tables[n + axis]]) * scale
          for n, scale in [("EX", 1e-3), ("EY", 1e-3), ("EZ", 1e-3),
                           ("EA", 1e-6), ("EB", 1e-6), ("EC", 1e-6)]}  # fmt: skip
    angles = np.stack([at["EA"], at["EB"], at["EC"]], axis=-1)
    read = np.stack([at["EX"], at["EY"], at["EZ"]], axis=-1)
    # the reflector saw its own lever: what it read is not the error of the origin
    lever = np.broadcast_to(np.array(PLACE[axis]), angles.shape)
    return angles, read - (turned(angles, lever) - lever)


def point_of_tool(tables, square, tip, contact):
    """Where machines bring points of the tool when its tip is sent to `tip`, (N, Q, 3) mm."""
    nose = tip + ZERO + np.array([0.0, 0.0, L])
    angles, shift = zip(*(body(tables, a, nose[:, k]) for k, a in enumerate("XYZ")), strict=True)
    x, y, z = nose.T[:, None, :, None] * np.eye(3)[:, None, None]
    lean_a, lean_b, lean_c = (1e-6 * square[name][:, None] for name in ("EA0Y", "EB0X", "EC0Y"))
    point = turned(angles[2], contact - np.array([0.0, 0.0, L])) + shift[2] + z
    along_y = y + nose[:, 1, None] * (lean_a * [0, 0, 1] - lean_c * [1, 0, 0])[:, None]
    point = turned(angles[1], point) + shift[1] + along_y
    along_x = x - nose[:, 0, None] * (lean_b * [0, 0, 1])[:, None]
    return turned(angles[0], point + along_x) + shift[0] - ZERO


def left_on_part(text, tables, square):
    """Deviations that machines leave at the points, (N, P) mm, outward positive."""
    cuts, found = commanded(text), []
    for name, point, normal in POINTS:
        point, normal = np.array(point), np.array(normal, float)
        cut, along = {"wall +Y": ("one", 0), "wall +X": ("two", 1), "floor": ("three", 0)}[name]
        line, contact = cuts[cut], -R * normal
        contact[2] = point[2] - line[0, 2]
        if name == "floor":  # where the rim of a tilted tool passes first and last
            rim = np.sqrt(R**2 - point[1] ** 2)
            contact = np.array([[-rim, point[1], 0.0], [rim, point[1], 0.0]])
        contact = np.atleast_2d(contact)
        at = point[along] - contact[:, along]
        tip = np.stack([np.interp(at, line[:, along], line[:, k]) for k in range(3)], axis=1)
        off = (point_of_tool(tables, square, tip, contact) - point) @ normal
        found.append(off.min(axis=1))
    return np.array(found).T


def machines(count, seed):
    """Tables and right angles of machines that may be the one that was measured."""
    rng = np.random.default_rng(seed)
    tables = {}
    for name in ENDS:
        u = U_UM if name[1] in "XYZ" else U_URAD
        tables[name] = straight(name) + u * rng.normal(size=(count, len(NODES[name[2]])))
    return tables, {name: value + U_SQUARE_URAD * rng.normal(size=count)
                    for name, value in SQUARE.items()}  # fmt: skip


@pytest.fixture(scope="module")
def promised(tmp_path_factory):
    """The compensated program, and what is promised of it."""
    job = write(tmp_path_factory.mktemp("promise"))
    text = compensate(job).text
    return text, check_surface(job, text, read_surface(job))


def test_an_exact_machine_of_the_tables_keeps_what_is_promised_in_the_model(promised):
    text, checked = promised
    exact = {name: straight(name)[None] for name in ENDS}, {k: np.array([v])
                                                           for k, v in SQUARE.items()}  # fmt: skip
    assert len(checked.row) == len(POINTS)
    before = left_on_part(PROGRAM.encode(), *exact)[0]
    assert np.abs(before).max() > 10e-3
    np.testing.assert_allclose(checked.before_mm, before, atol=2e-6)
    np.testing.assert_allclose(checked.after_mm, left_on_part(text, *exact)[0], atol=2e-6)


def test_machines_within_the_uncertainty_of_the_tables_keep_what_is_promised_of_them(promised):
    text, checked = promised
    left = left_on_part(text, *machines(500, seed=4))
    rms = np.sqrt((left**2).mean(axis=1))
    promised_rms = checked.expected_rms_mm
    # the model alone would promise far too much
    in_model = np.sqrt((checked.after_mm**2).mean())
    assert (rms > 1.5 * in_model).mean() > 0.98
    assert np.sqrt((rms**2).mean()) == pytest.approx(promised_rms, rel=0.05)
    np.testing.assert_allclose(left.std(axis=0), checked.u_mm, rtol=0.15)
    covered = np.abs(left - checked.after_mm) < 1.96 * checked.u_mm
    assert covered.mean() == pytest.approx(0.95, abs=0.015)
