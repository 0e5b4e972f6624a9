"""Every characteristic against a closed form, on a part whose deviations are written down."""

from __future__ import annotations

import numpy as np
import pytest

from tests.feature_part import FACES, NOMINAL, NORMAL, ROWS, measures, moved, part, values
from vmach.errors import InputError
from vmach.features.drawing.callout import read_callout
from vmach.features.evaluation import Drawing, Requirement, evaluate
from vmach.features.feature import Points, make_feature
from vmach.features.surface import Surface

#: of values that are exact but for the second order of deviations
MM = 2e-6


def lobes(number, size, centre=(20.0, 30.0)):
    return lambda p: size * np.cos(number * np.arctan2(p[:, 1] - centre[1], p[:, 0] - centre[0]))


def bow(z):
    return ((z + 15) / 13) ** 2


def bore_shift(x, y, face="bore 1"):
    return lambda p: FACES[face][1] @ np.array([x, y, 0.0])


CASES = {
    # an ellipse has two sizes; three lobes have one between two points, whatever they are
    "two-point, ellipse": ("bore 1", "20 H7", {"bore_1": lobes(2, 0.01)}, [19.98, 20.02]),
    "two-point, three lobes": ("bore 1", "20 H7", {"bore_1": lobes(3, 0.01)}, [20.0, 20.0]),
    "two-point, small by 0.03": ("bore 1", "20 H7", {"bore_1": 0.015}, [19.97, 19.97]),
    "two-point of a pin": ("pin", "16 h6", {"pin": lobes(2, 0.01)}, [15.98, 16.02]),
    "two-point of a pattern": ("bores", "20 H7", {"bore_1": 0.01, "bore_2": -0.02}, [19.98, 20.04]),
    "least squares": ("bore 1", "20 H7 (GG)", {"bore_1": lobes(2, 0.01)}, [20.0]),
    "inscribed, three lobes": ("bore 1", "20 H7 (GX)", {"bore_1": lobes(3, 0.01)}, [19.98]),
    "circumscribed, three lobes": ("pin", "16 h6 (GN)", {"pin": lobes(3, 0.01)}, [16.02]),
    "envelope of a bore": ("bore 1", "20 H7 E", {"bore_1": lobes(2, 0.01)}, [19.98, 20.02]),
    "ball": ("ball", "SØ12 ±0.1", {"ball": 0.02}, [12.04]),
    "radius": ("bore 1", "R10 ±0.1", {"bore_1": 0.02}, [9.98, 9.98]),
    "width": ("length", "100 ±0.1", {"left": 0.01, "right": -0.03}, [99.98]),
    "width, local": ("length", "100 ±0.1", {"left": lambda p: 0.001 * p[:, 1]}, [100.0, 100.06]),
    "distance of planes": ("bottom", "distance 30 ±0.1 to top", {"top": 0.02}, [30.02]),
    "distance of a bore from a plane":
        ("left", "distance 20 ±0.1 to bore 1",
         {"left": 0.01, "bore_1": bore_shift(0.02, 0)}, [20.03]),
    "distance of bores": ("bore 1", "distance 60 ±0.1 to bore 2",
                          {"bore_1": bore_shift(-0.02, 0.01)}, [60.02]),
    # the middle of the sides moves by half the difference of theirs
    "distance of a bore from the middle of a width":
        ("bore 1", "distance 30 ±0.1 to length", {"left": 0.01, "right": 0.05}, [30.02]),
    "distance of the middle of a width from a bore":
        ("length", "distance 30 ±0.1 to bore 2",
         {"left": 0.01, "right": 0.05, "bore_2": bore_shift(0.03, 0, "bore 2")}, [30.01]),
    "flatness, bow": ("top", "flatness 0.1", {"top": lambda p: 4e-6 * (p[:, 0] - 50) ** 2}, [0.01]),
    "flatness, twist": ("top", "flatness 0.1",
                        {"top": lambda p: (p[:, 0] - 50) * (p[:, 1] - 30) / 150_000}, [0.02]),
    "flatness does not see a tilt": ("top", "flatness 0.1", {"top": lambda p: 1e-3 * p[:, 0]}, [0]),
    "straightness of lines":
        ("top", "straightness 0.1 along X", {"top": lambda p: 4e-6 * (p[:, 0] - 50) ** 2}, [0.01]),
    "straightness of the worst line, which is not the most tilted":
        ("top", "straightness 0.1 along X",
         {"top": lambda p: np.where(p[:, 1] > 30, 4e-6 * (p[:, 0] - 50) ** 2, 4e-4 * p[:, 0])},
         [0.01]),
    "straightness the other way":
        ("top", "straightness 0.1 along Y", {"top": lambda p: 4e-6 * (p[:, 0] - 50) ** 2}, [0.0]),
    # a bow of the axis: the middle of a zone passes half its height
    "straightness of an axis":
        ("bore 1", "straightness Ø0.1",
         {"bore_1": lambda p: FACES["bore 1"][1][:, 0] * 0.02 * bow(p[:, 2])}, [0.02]),
    "roundness": ("bore 1", "roundness 0.1", {"bore_1": lobes(6, 0.01)}, [0.02]),
    "roundness does not see a shift":
        ("bore 1", "circularity 0.1", {"bore_1": bore_shift(0.001, 0)}, [0]),
    "cylindricity, taper": ("bore 1", "cylindricity 0.1",
                            {"bore_1": lambda p: (p[:, 2] + 15) / 1300}, [0.02]),
    "cylindricity, ellipse": ("bore 1", "cylindricity 0.1", {"bore_1": lobes(2, 0.01)}, [0.02]),
    "perpendicularity":
        ("left", "perpendicularity 0.1 A", {"left": lambda p: 1e-3 * p[:, 2]}, [0.03]),
    "perpendicularity turns about A": ("left", "perpendicularity 0.1 A",
                                       {"left": lambda p: 1e-3 * p[:, 1]}, [0.0]),
    "perpendicularity to two": ("left", "perpendicularity 0.1 A C",
                                {"left": lambda p: 1e-3 * p[:, 1]}, [0.06]),
    "perpendicularity of an axis":
        ("bore 1", "perpendicularity Ø0.1 A",
         {"bore_1": lambda p: FACES["bore 1"][1][:, 1] * 1e-3 * p[:, 2]}, [0.026]),
    "parallelism": ("right", "parallelism 0.1 B", {"right": lambda p: 1e-3 * p[:, 1]}, [0.06]),
    "parallelism to a tilted datum": ("right", "parallelism 0.1 B",
                                      {"left": lambda p: 1e-3 * p[:, 2]}, [0.03]),
    "parallelism of axes":
        ("bore 1", "parallelism Ø0.1 D",
         {"bore_1": lambda p: FACES["bore 1"][1][:, 0] * 1e-3 * p[:, 2]}, [0.026]),
    "angularity": ("slant", "angularity 0.1 A C",
                   {"slant": lambda p: 1e-3 * (p[:, 0] - 100) / np.cos(np.radians(30))}, [0.02]),
    "position": ("bore 1", "position Ø0.1 A B C", {"bore_1": bore_shift(0.03, 0.04)}, [0.1]),
    "position by a datum that is off": ("bore 1", "position Ø0.1 A B C", {"left": 0.02}, [0.04]),
    "position between planes": ("bore 1", "position 0.1 A B C along X",
                                {"bore_1": bore_shift(0.03, 0.04)}, [0.06]),
    "position of a ball": ("ball", "position SØ0.1 A B C",
                           {"ball": lambda p: FACES["ball"][1] @ [0.001, 0.002, 0.002]}, [0.006]),
    "position of a plane": ("right", "position 0.1 B", {"right": 0.02}, [0.04]),
    "pattern without datums": ("bores", "position Ø0.1", {"bore_1": bore_shift(0.03, 0)}, [0.03]),
    "pattern in the frame":
        ("bores", "position Ø0.1 A B C", {"bore_1": bore_shift(0.03, 0)}, [0.06]),
    "coaxiality": ("pin", "coaxiality Ø0.1 E", {"pin": bore_shift(0.03, 0.04, "pin")}, [0.1]),
    "symmetry": ("length", "position 0.1 A D", {"left": 0.01, "right": 0.05}, [0.04]),
    # the middle of the sides moves by half the difference of theirs
    "symmetry of a width": ("length", "symmetry 0.1 D", {"left": 0.01, "right": 0.05}, [0.04]),
    "inscribed pin, three lobes": ("pin", "16 h6 (GX)", {"pin": lobes(3, 0.01)}, [15.98]),
    "circumscribed bore, three lobes":
        ("bore 1", "20 H7 (GN)", {"bore_1": lobes(3, 0.01)}, [20.02]),
    "inscribed ball": ("ball", "SØ12 ±0.1 (GX)", {"ball": -0.02}, [11.96]),
    # two bores 60 mm apart give one datum: a shift of one by 0.06 turns it by 1e-3
    "common datum turns with both":
        ("front", "parallelism 0.1 D-E", {"bore_2": bore_shift(0, 0.06, "bore 2")}, [0.1]),
    "common datum lies between both":
        ("left", "position 0.1 D-E", {"bore_2": bore_shift(0.04, 0, "bore 2")}, [0.04]),
    # left is 1e-3 out of square: it stays so where it comes second, and turns the frame where first
    "secondary datum is squared": ("front", "perpendicularity 0.1 A B",
                                   {"left": lambda p: 1e-3 * p[:, 2]}, [0.0]),
    "primary datum turns the frame": ("top", "perpendicularity 0.1 B",
                                      {"left": lambda p: 1e-3 * p[:, 2]}, [0.1]),
    "cylindricity of a waist": ("pin", "cylindricity 0.1",
                                {"pin": lambda p: 0.01 * ((p[:, 2] - 11) / 9) ** 2}, [0.01]),
    "profile of lines along Y":
        ("top", "profile of line 0.1 B C along Y",
         {"top": lambda p: np.where(p[:, 0] > 50, 0.01, 0.0)}, [0.01]),
    "profile": ("top", "profile 0.1 B C", {"top": lambda p: 1e-3 * p[:, 0] - 0.04}, [0.1]),
    "profile in a frame": ("slant", "profile 0.1 A B C", {"slant": -0.03}, [0.06]),
    "profile without datums": ("slant", "profile 0.1", {"slant": -0.03}, [0.0]),
    "profile of several faces": ("outside", "profile 0.1 A", {"left": 0.02, "right": 0.02}, [0.04]),
    "profile of lines": ("bore 1", "profile of line 0.1 A B C",
                         {"bore_1": lambda p: np.where(p[:, 2] > -6, 0.01, 0.0)}, [0.02]),
    "circular runout":
        ("pin", "circular runout 0.1 E", {"pin": bore_shift(0.03, 0, "pin")}, [0.06]),
    "total runout": ("pin", "total runout 0.1 E", {"pin": lambda p: 1e-3 * p[:, 2]}, [0.018]),
}  # fmt: skip


@pytest.mark.parametrize("name", list(CASES))
def test_closed_form(name):
    feature, text, deviations, expected = CASES[name]
    tolerance = 1e-4 if name.startswith("two-point") or "envelope" in name else MM
    found = values(part(**deviations), feature, text)
    if len(expected) != len(found):  # every section is alike
        expected = expected * len(found)
    assert found == pytest.approx(expected, abs=tolerance)


@pytest.mark.parametrize("association", ["least squares", "contact"])
@pytest.mark.parametrize("name", list(CASES))
def test_values_do_not_depend_on_where_the_part_lies(name, association):
    feature, text, deviations, _ = CASES[name]
    here = part(**deviations)
    there = moved(here, (0.002, -0.003, 0.001), (1e-5, -5e-6, 8e-6))
    found = values(there, feature, text, association)
    # two-point sizes lie between points: a chord of 10 degrees leaves lobes by that much
    between = 7e-4 if "two-point" in name or "envelope" in name else 5e-6
    assert found == pytest.approx(values(here, feature, text, association), abs=between)


@pytest.mark.parametrize("association", ["least squares", "contact"])
@pytest.mark.parametrize("name", list(CASES))
def test_shares_add_up_and_say_how_a_value_changes(name, association):
    """The weights are the linear signature of a value: its change with every deviation."""
    feature, text, _, _ = CASES[name]
    rng = np.random.default_rng(3)
    everywhere = np.ones(len(NOMINAL), bool)
    start = rng.normal(0.0, 3e-3, len(NOMINAL))
    points = Points(NOMINAL, NORMAL, start, everywhere)
    step = rng.normal(0.0, 1e-7, len(NOMINAL))
    after = Points(NOMINAL, NORMAL, start + step, everywhere)
    before, later = (measures(p, feature, text, association) for p in (points, after))
    for one, other in zip(before, later, strict=True):
        weight = one.spread(len(NOMINAL))
        assert other.value_mm - one.value_mm == pytest.approx(weight @ step, abs=1e-8)
        nominal = round(one.value_mm, 0) if one.value_mm > 1.0 else 0.0
        assert one.value_mm - nominal == pytest.approx(weight @ start, abs=2e-5)


REFUSED = [
    ("top", "perpendicularity 0.1 B C D E", "has 4 datums; accepted: 1 to 3"),
    ("top", "flatness 0.1 A", "has 1 datums; accepted: 0 with flatness"),
    ("top", "parallelism 0.1 B", "has an angle of 90 deg .* accepted: 0 deg with parallelism"),
    ("left", "perpendicularity 0.1 F", "datum F is not defined; accepted: A, B, C, D, E"),
    ("top", "profile 0.1 A B", "'top', which is datum A itself"),
    ("bottom", "profile 0.1 A A", "datum A locks nothing"),
    ("bore 1", "position 0.1 A B C", "accepted: Ø before the value"),
    ("bore 1", "position 0.1 A B C along Z", "Z is the axis of 'bore 1'"),
    ("bore 1", "position Ø0.1", "of one feature without a datum"),
    ("bore 1", "flatness 0.1", "which is a cylinder; accepted: flatness of: plane"),
    ("bore 1", "25 H7", "which is 20 mm in the CAD; accepted: the nominal size"),
    ("top", "25 H7", "'top' is a plane, which has no size"),
    ("pin", "coaxiality Ø0.1 D", "is 60 mm beside that of the datum"),
    ("left", "distance 30 ±0.1 to top", "are not parallel"),
    ("top", "distance 20 ±0.1 to bottom", "accepted: the nominal distance of the CAD$"),
    ("bore 1", "35 Q7", "tolerance class 'Q7'; accepted: a letter from A to H"),
    ("bore 1", "20 +0.1 +0.1", "both limits are 0.1 mm"),
    # of a single limit the last digits of the nominal size were taken for the other one
    ("bore 1", "20.05 +0.02", "tolerance '20.05 [+]0.02'; accepted: '35 H7'"),
    ("bore 1", "20 +0,05", "accepted: '35 H7'.*hint: decimals follow a point"),
    ("bore 1", "20 ±0,02", "hint: decimals follow a point"),
    ("bore 1", "roundness 0,01", "a value above 0 .hint: decimals follow a point"),
    ("bore 1", "roundish 0.1", "tolerance 'roundish 0.1'; accepted: '35 H7'"),
    ("bore 1", "position Ø0.1 a", "'a' is no datum; accepted: capital letters"),
    ("bore 1", "position Ø0.1M A", "'M' is no datum.*maximum material"),
    (
        "bore 1",
        "position Ø0.1 B-B",
        "datum 'B-B' has the letter B twice; accepted: one letter, as B",
    ),
    ("top", "distance 0 ±0.1 to top", "of 'top' is a distance to itself; accepted: .* another"),
    ("bore 1", "position Ø0 A B C", "a value above 0"),
    ("bore 1", "cylindricity 10 um", "'um' is no datum.*hint: values are in mm"),
    ("bore 1", "cylindricity 1e-3", "hint: without a power of ten"),
    ("bore 1", '0.787" ±0.001', "hint: values are in mm"),
    ("bore 1", "20 ±0", "both limits are 0 mm"),
    # a round zone of what has no axis was taken for one between planes
    ("bottom", "parallelism Ø0.01 A", "a plane has no zone with Ø; accepted: the value without"),
    ("top", "flatness Ø0.01", "a flatness has no zone with Ø"),
    ("bore 1", "position SØ0.1 A B C", "a cylinder has no zone with SØ"),
    ("ball", "straightness Ø0.1", "accepted: Ø for the median line"),
    ("top", "straightness 0.1 along Z", "the plane is normal to Z"),
    ("bore 1", "circular runout 0.1 D", "'bore 1' does not turn about the axis of the datum"),
    ("left", "total runout 0.1 D", "'left' does not turn about the axis of the datum"),
    ("pin", "circular runout 0.1 A", "no datum has an axis; accepted: a cylinder or a cone"),
]


@pytest.mark.parametrize(("feature", "text", "message"), REFUSED)
def test_what_contradicts_itself_is_refused(feature, text, message):
    with pytest.raises(InputError, match=message):
        values(part(), feature, text)


def test_a_feature_that_no_tool_made_is_refused():
    points = part()
    cut = np.ones(len(NOMINAL), bool)
    cut[ROWS["bore 1"]] = False
    bare = Points(points.nominal_mm, points.normal, points.deviation_mm, cut)
    with pytest.raises(InputError, match="no point of feature 'bore 1' was cut or measured"):
        values(bare, "bore 1", "roundness 0.1")


@pytest.mark.parametrize("lean", [0.0, 1e-4, 3e-4])
def test_a_leaning_bore_keeps_its_sections(lean):
    """100 mm at the bottom, 100.04 at the top, 24 points a section: leaning changes no diameter.

    Closed form: a section across the leaning axis is wider by half the square of the lean.
    """
    turns, heights = np.arange(24) * np.pi / 12, np.arange(0, 41, 10)
    turn, height = (v.ravel() for v in np.meshgrid(turns, heights))
    away = np.column_stack([np.cos(turn), np.sin(turn), 0.0 * turn])
    nominal = 50.0 * away + np.outer(height, [0, 0, 1])
    wider = 5e-4 * height + lean * height * np.cos(turn)
    points = Points(nominal, -away, -wider, np.ones(len(turn), bool))
    surface = Surface("cylinder", np.zeros(3), np.array([0, 0, 1.0]), radius_mm=50.0, sign=-1.0)
    bore = make_feature("bore", [surface], [np.arange(len(turn))])
    drawing = Drawing({"bore": bore}, {}, ())
    found = evaluate(drawing, Requirement("bore", read_callout("100 ±0.1")), points)
    assert [one.label for one in found] == ["smallest", "largest"]
    assert [one.value_mm for one in found] == pytest.approx([100.0, 100.04], abs=1e-5)


@pytest.mark.parametrize("shift_mm", [0.0, 0.005, 0.05])
@pytest.mark.parametrize("is_whole", [True, False], ids=["whole shaft", "one side of it"])
def test_axial_runout_is_taken_on_circles_about_the_datum_axis(shift_mm, is_whole):
    """A face that leans by 1 mrad to its shaft runs out by 2 r 1e-3 on its outer circle, r = 8."""
    turn = np.arange(24) * np.pi / 12
    ring = np.column_stack([np.cos(turn), np.sin(turn), 0.0 * turn])
    shaft = np.vstack([10.0 * ring + [0, 0, h] for h in (0.0, 5.0, 10.0, 15.0)])
    face = np.vstack([r * ring + [0, 0, 20.0] for r in (5.0, 8.0)])
    normal = np.vstack([np.tile(ring, (4, 1)), np.tile([0.0, 0.0, 1.0], (48, 1))])
    deviation = np.r_[shift_mm * np.tile(np.cos(turn), 4), 1e-3 * face[:, 0]]
    known = np.r_[(shaft[:, 0] > -1.0) | is_whole, np.ones(48, bool)]
    points = Points(np.vstack([shaft, face]), normal, deviation, known)
    up = np.array([0.0, 0.0, 1.0])
    surfaces = {
        "shaft": Surface("cylinder", np.zeros(3), up, radius_mm=10.0),
        "face": Surface("plane", 20.0 * up, up),
    }
    rows = {"shaft": np.arange(96), "face": np.arange(96, 144)}
    features = {name: make_feature(name, [surfaces[name]], [rows[name]]) for name in rows}
    drawing = Drawing(features, {"D": "shaft"}, ())
    asked = Requirement("face", read_callout("circular runout 0.1 D"))
    (found,) = evaluate(drawing, asked, points)
    assert found.value_mm == pytest.approx(0.016, abs=1e-6)


def test_a_least_squares_size_in_place_of_two_point_sizes_says_so():
    """Points on half of the wall have no opposite ones; a ball has one size."""
    cut = np.ones(len(NOMINAL), bool)
    cut[ROWS["bore 1"]] = NOMINAL[ROWS["bore 1"], 0] > 20.0
    points = part(bore_1=0.01)
    half = Points(points.nominal_mm, points.normal, points.deviation_mm, cut)
    for feature, text, mm in (("bore 1", "20 H7", 19.98), ("ball", "SØ12 ±0.1", 12.0)):
        (found,) = measures(half, feature, text)
        assert (found.label, found.value_mm) == ("least squares", pytest.approx(mm, abs=1e-6))
    (asked,) = measures(half, "bore 1", "20 H7 (GG)")
    assert asked.label == ""


def test_the_axis_of_half_a_bore_leans_between_its_ends():
    """Sections of half a wall have no centres: the ends of its axis, 26 mm apart, stand for it."""
    cut = np.ones(len(NOMINAL), bool)
    cut[ROWS["bore 1"]] = NOMINAL[ROWS["bore 1"], 0] > 20.0
    points = part(bore_1=lambda p: FACES["bore 1"][1][:, 1] * 1e-3 * p[:, 2])
    half = Points(points.nominal_mm, points.normal, points.deviation_mm, cut)
    assert values(half, "bore 1", "perpendicularity Ø0.1 A") == pytest.approx([0.026], abs=MM)


def test_a_contact_datum_of_half_a_bore_is_named():
    """E is bore 1; what has no points on the other side has no largest cylinder."""
    cut = np.ones(len(NOMINAL), bool)
    cut[ROWS["bore 1"]] = NOMINAL[ROWS["bore 1"], 0] > 20.0
    points = part(bore_1=0.01)
    half = Points(points.nominal_mm, points.normal, points.deviation_mm, cut)
    with pytest.raises(InputError, match="datum E: inscribed cylinder of points that do not go"):
        values(half, "bore 2", "parallelism Ø0.1 E", "contact")
