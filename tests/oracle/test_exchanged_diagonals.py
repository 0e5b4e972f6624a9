"""Two diagonals under each other's names, asked about; readings by the closed form of a squareness.

dx = -EC0Y y, dz = -EB0X x, dz = +EA0Y y: along a line of direction n the tool is further by
(-EC0Y n_x n_y - EB0X n_x n_z + EA0Y n_y n_z) of the distance, and by a scale in common.
"""

from __future__ import annotations

import re
from itertools import permutations

import numpy as np
import pytest

from tests.small_job import measurement, write_job
from vmach.base.note import Kind, Level
from vmach.instruments import read_instruments
from vmach.job import read_job

LOW, HIGH = np.array([-350.0, -250.0, -250.0]), np.array([-50.0, -50.0, -50.0])
#: signs of the axes from the first end to the last; 0 where an axis stays in the middle
XY = {"xy_up": (1, 1, 0), "xy_down": (1, -1, 0)}
ZX = {"zx_up": (1, 0, 1), "zx_down": (1, 0, -1)}
YZ = {"yz_up": (0, 1, 1), "yz_down": (0, 1, -1)}
BODY = {"ppp": (1, 1, 1), "ppn": (1, 1, -1), "pnp": (1, -1, 1), "pnn": (1, -1, -1)}


def ends(signs):
    middle, half = 0.5 * (LOW + HIGH), 0.5 * (HIGH - LOW)
    return middle - half * signs, middle + half * signs


def rows(signs, squareness_urad, *, scale_ppm, random):
    """Readings out and back, um, 0.2 um of scatter."""
    start, end = ends(np.array(signs))
    length = np.linalg.norm(end - start)
    n = (end - start) / length
    ec, eb, ea = squareness_urad
    rate = -ec * n[0] * n[1] - eb * n[0] * n[2] + ea * n[1] * n[2] + scale_ppm
    distance = np.linspace(0.0, length, 11).round(3)
    found = ["run,distance_mm,approach,deviation_um"]
    for way, places in ((1, distance), (-1, distance[::-1])):
        for d in places:
            found.append(f"1,{d},{way},{rate * 1e-3 * d + random.normal(0, 0.2):.3f}")
    return "\n".join(found) + "\n"


def read(folder, names, *, stated, true, labels=None, scale_ppm=0.0):
    """Tests of the diagonals `names`; file k holds the readings of diagonal labels[k]."""
    folder.mkdir(exist_ok=True)
    random = np.random.default_rng(7)
    keys = list(names)
    more = ""
    for key in keys:
        start, end = ends(np.array(names[key]))
        section = measurement("diagonal", from_mm=start.tolist(), to_mm=end.tolist())
        more += section.replace('"diagonal.csv"', f'"{key}.csv"')
    said = "\n[squareness]\n" + "".join(
        f"{n} = {v}\n" for n, v in zip(("EC0Y", "EB0X", "EA0Y"), stated, strict=True)
    )
    path = write_job(folder, squareness=said, more=more)
    for key, own in zip(keys, labels or keys, strict=True):
        text = rows(names[own], true, scale_ppm=scale_ppm, random=random)
        (folder / f"{key}.csv").write_text(text)
    before = {key: (folder / f"{key}.csv").read_bytes() for key in keys}
    tests = read_instruments(read_job(path))
    assert before == {key: (folder / f"{key}.csv").read_bytes() for key in keys}
    return [note for test in tests for note in test.notes if note.kind == Kind.EXCHANGED]


@pytest.mark.parametrize(
    ("names", "stated", "name"),
    [
        (XY, (40.0, 3.0, -2.0), "EC0Y"),
        (ZX, (5.0, 40.0, 2.0), "EB0X"),
        (YZ, (5.0, 2.0, 40.0), "EA0Y"),
    ],
)
@pytest.mark.parametrize("scale_ppm", [0.0, 25.0])
def test_face_diagonals_that_are_exchanged(names, stated, name, scale_ppm, tmp_path):
    """The squareness has the other sign; a warm scale that both see alike changes nothing."""
    keys = list(names)
    (note,) = read(
        tmp_path, names, stated=stated, true=stated, labels=keys[::-1], scale_ppm=scale_ppm
    )
    assert note.level == Level.QUESTION and note.file == f"{keys[0]}.csv"
    assert note.place == f"{keys[1]}.csv" and "from_mm and to_mm of both" in note.hint
    by = rf"{name} is (\S+) urad by both diagonals, and (\S+) urad by the machine file"
    measured, model = map(float, re.search(by, note.sentence).groups())
    assert measured == pytest.approx(-40.0, abs=1.5)
    assert model == pytest.approx(40.0, abs=0.1)


@pytest.mark.parametrize("true", [(40.0, 3.0, -2.0), (55.0, 10.0, 0.0), (0.0, 0.0, 0.0)])
def test_diagonals_under_their_own_names_are_not_asked_about(true, tmp_path):
    """The machine file says 40 urad: readings of 40, 55 and 0 urad are not those of -40."""
    assert read(tmp_path, XY, stated=(40.0, 3.0, -2.0), true=true) == []


def test_without_a_squareness_nothing_can_be_told(tmp_path):
    labels = list(XY)[::-1]
    assert read(tmp_path, XY, stated=(0.0, 0.0, 0.0), true=(40.0, 0.0, 0.0), labels=labels) == []


@pytest.mark.parametrize("pair", [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)])
def test_body_diagonals_that_are_exchanged(pair, tmp_path):
    """Any two of the four, and only these two."""
    labels = list(BODY)
    one, other = pair
    labels[one], labels[other] = labels[other], labels[one]
    stated = (60.0, -35.0, 20.0)
    (note,) = read(tmp_path, BODY, stated=stated, true=stated, labels=labels)
    keys = list(BODY)
    assert (note.file, note.place) == (f"{keys[one]}.csv", f"{keys[other]}.csv")
    assert "um/m with the machine file" in note.sentence


def test_two_exchanges_at_once(tmp_path):
    keys, stated = list(BODY), (60.0, -35.0, 20.0)
    for labels in permutations(keys):
        moved = [k for k in range(4) if labels[k] != keys[k]]
        if len(moved) == 4 and all(labels[keys.index(labels[k])] == keys[k] for k in range(4)):
            notes = read(
                tmp_path / "".join(labels), BODY, stated=stated, true=stated, labels=labels
            )
            assert {(n.file[:3], n.place[:3]) for n in notes} == {
                tuple(sorted((keys[k], labels[k]), key=keys.index)) for k in range(4)
            }
