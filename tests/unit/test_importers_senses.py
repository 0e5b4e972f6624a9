"""Circles of a ballbar in both senses, in the ways in which files have them."""

import numpy as np
import pytest

from vmach.errors import InputError
from vmach.importers.importing import import_files
from vmach.importers.questions import Questions

#: a circle every 15 degrees: a reading says its angle, and its sense by a step of 3 um
ANGLES = np.arange(0, 360, 15)
ANSWERS = {"centre": "-200 -150 -200", "radius": "100", "feed": "1000", "tool_length": "100"}


def deviation(angle, way):
    return f"{3.0 * np.cos(np.radians(angle)) + 1.5 * way:.4f}"


def table(head, *rows):
    return "\n".join([head, *(";".join(map(str, row)) for row in rows)]) + "\n"


def up(way, sense):
    return [(a, deviation(a, way), sense) for a in ANGLES]


def down(way, sense):
    return [(360 - a, deviation(360 - a, way), sense) for a in ANGLES]


SENSED = "Angle (deg);Deviation (um);Sense"
FILES = {
    "side by side": table(
        "Angle (deg);CCW (um);CW (um)", *((a, deviation(a, 1), deviation(a, -1)) for a in ANGLES)
    ),
    "words": table(
        "Winkel;Deviation counter-clockwise (um);Deviation clockwise (um)",
        *((a, deviation(a, 1), deviation(a, -1)) for a in ANGLES),
    ),
    "own angles": table(
        "Angle CCW (deg);Radius CCW (um);Angle CW (deg);Radius CW (um)",
        *((a, deviation(a, 1), 360 - a, deviation(360 - a, -1)) for a in ANGLES),
    ),
    "below, as read": table(SENSED, *up(1, "CCW"), *down(-1, "CW")),
    "below, by angle": table(SENSED, *up(1, "CCW"), *up(-1, "CW")),
}


def readings(folder, text):
    (folder / "c.csv").write_text(text)
    (one,) = import_files([folder / "c.csv"], Questions(ANSWERS))
    found = [line.split(",") for line in one.files["c_ballbar.csv"].splitlines()[1:]]
    return found, one.told


@pytest.mark.parametrize("name", FILES)
def test_both_senses_are_read_as_they_were_driven(name, tmp_path):
    """ISO 230-4: counter-clockwise angles grow, clockwise they fall; time always grows."""
    found, told = readings(tmp_path, FILES[name])
    assert len(found) == 2 * len(ANGLES)
    time = np.array([float(row[3]) for row in found])
    assert (np.diff(time) > 0).all()
    for sense, way in (("CCW", 1), ("CW", -1)):
        own = [row for row in found if row[0].startswith(sense)]
        angle = np.array([float(row[2]) for row in own])
        assert (np.sign((np.diff(angle) + 180) % 360 - 180) == way).all()
        assert [float(row[4]) for row in own] == pytest.approx(
            [float(deviation(a, way)) for a in angle], abs=2e-4
        )
    is_turned = any("turned round" in line for line in told)
    assert is_turned == (name in ("side by side", "words", "below, by angle"))


def test_circles_side_by_side_are_numbered_and_may_be_shorter(tmp_path):
    rows = [(a, deviation(a, 1), deviation(a, -1), deviation(a, 1) if a < 180 else "")
            for a in ANGLES]  # fmt: skip
    found, _ = readings(
        tmp_path, table("Angle (deg);CCW 1 (um);Run 1 CW (um);CCW 2 (um)", *rows)
    )  # fmt: skip
    names = [row[0] for row in found]
    assert list(dict.fromkeys(names)) == ["CCW1", "CW1", "CCW2"]
    assert names.count("CCW2") == 12


def test_a_sense_that_comes_again_is_another_run(tmp_path):
    both = [*up(1, "CCW"), *down(-1, "CW")]
    found, _ = readings(tmp_path, table(SENSED, *both, *both))
    assert list(dict.fromkeys(row[0] for row in found)) == ["CCW", "CW", "CCW 2", "CW 2"]


def test_a_sense_that_times_contradict_is_refused(tmp_path):
    rows = [(*row, k) for k, row in enumerate([*up(1, "CCW"), *up(-1, "CW")])]
    with pytest.raises(InputError, match=r"c[.]csv:26: the angles of run 'CW' go the other way"):
        readings(tmp_path, table(SENSED + ";Time (s)", *rows))


def test_runs_without_a_sense_are_told_how_to_name_them(tmp_path):
    (tmp_path / "c.csv").write_text("Angle (deg);Run 1 (um);Run 2 (um)\n0;1;2\n15;1;2\n")
    with pytest.raises(InputError, match=r"'CW \(um\)' for circles side by side"):
        import_files([tmp_path / "c.csv"], Questions(ANSWERS), kind="ballbar")
