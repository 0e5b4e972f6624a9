"""A tool that is thicker than its table, on slopes: against a job whose tool is that thick."""

from __future__ import annotations

import numpy as np
import pytest

from tests.small_job import MACHINE
from vmach.run.pipeline import predict_points

#: a groove along X, tip at Z -4
PROGRAM = "G21 G90 G17\nT1 M6\nG43 H1 G54\nG0 X-40 Y0\nZ10\nG1 Z-4 F500\nX40\nG0 Z20\nM2\n"
JOB = """\
schema = 1
machine = "machine.toml"
program = "part.nc"
[work_offsets_mm]
G54 = [-200, -150, -200]
[stock]
min_mm = [-30, -30, -20]
max_mm = [30, 30, 0]
[tools.1]
length_mm = 100
"""
SLOPES_DEG = (10.0, 30.0, 45.0, 60.0)


def tool(shape: str, *, wider_mm: float = 0.0) -> str:
    """Keys of a tool of 12 mm diameter, wider by so much in radius at every height."""
    r = wider_mm
    flutes = "" if shape == "profile" else "flute_length_mm = 30\n"
    return (
        flutes
        + {
            "flat": f"shape = 'flat'\ndiameter_mm = {12 + 2 * r}\n",
            "ball": f"shape = 'ball'\ndiameter_mm = {12 + 2 * r}\n",
            "bull": f"shape = 'bull'\ncorner_radius_mm = 3\ndiameter_mm = {12 + 2 * r}\n",
            "chamfer": f"shape = 'chamfer'\ndiameter_mm = {12 + 2 * r}\n"
            f"tip_diameter_mm = {2 + 2 * r}\n",
            "profile": f"shape = 'profile'\ndiameter_mm = {12 + 2 * r}\n"
            f"profile_mm = [[{3 + r}, 0], [{6 + r}, 12], [{6 + r}, 30]]\n",
        }[shape]
    )


def groove(shape: str) -> list[tuple[float, float, float]]:
    """Points across the groove: y, z, slope of the surface in degrees."""
    if shape == "flat":
        return [(6.0, -2.0, 90.0), (1.0, -4.0, 0.0)]
    if shape == "chamfer":
        return [(2.5, -2.5, 45.0)]
    if shape == "profile":
        return [(3.5, -2.0, np.degrees(np.arctan2(12, 3)))]
    round_mm, out_mm = (6.0, 0.0) if shape == "ball" else (3.0, 3.0)
    sine, cosine = np.sin(np.radians(SLOPES_DEG)), np.cos(np.radians(SLOPES_DEG))
    return list(zip(out_mm + round_mm * sine, round_mm * (1 - cosine) - 4, SLOPES_DEG, strict=True))


def deviation_um(folder, shape, *, wider_mm=0.0, effect=""):
    rows = ["id,feature,x,y,z,i,j,k"]
    for k, (y, z, slope) in enumerate(groove(shape)):
        lean = np.radians(slope)
        rows.append(f"{k},slope,0,{y},{z},0,{-np.sin(lean):.15f},{np.cos(lean):.15f}")
    (folder / "machine.toml").write_text(MACHINE)
    (folder / "part.nc").write_text(PROGRAM)
    (folder / "points.csv").write_text("\n".join(rows) + "\n")
    (folder / "job.toml").write_text(JOB + tool(shape, wider_mm=wider_mm) + effect)
    _, prediction = predict_points(folder / "job.toml", folder / "points.csv")
    return 1e3 * prediction.deviation_mm


@pytest.mark.parametrize("shape", ["flat", "ball", "bull", "chamfer", "profile"])
def test_a_thicker_tool_is_one_whose_dimensions_are_larger(tmp_path, shape):
    """Radius, wear and chip take from a slope what the tool with other dimensions takes."""
    wider = deviation_um(tmp_path, shape, wider_mm=1e-3)
    thicker = deviation_um(tmp_path, shape, effect="[effects.tool_radius.T1]\nradius_um = 1\n")
    np.testing.assert_allclose(thicker, wider, atol=1e-3)
    chip = "[effects.tool_chip.T1]\nradius_um = 1\nlength_um = 0\ntime_s = 0\n"
    np.testing.assert_allclose(deviation_um(tmp_path, shape, effect=chip), -wider, atol=1e-3)
    # all points were cut at one way of the tool, at which it is worn by some radius
    wear = "[effects.tool_wear.T1]\nwear_um = 100\nexponent = 1\n"
    worn = deviation_um(tmp_path, shape, effect=wear)
    radius_um = float(worn @ wider / (wider @ wider))
    assert radius_um < -0.1
    np.testing.assert_allclose(worn, radius_um * wider, atol=1e-3 * abs(radius_um))


@pytest.mark.parametrize("shape", ["flat", "ball", "bull", "chamfer", "profile"])
def test_a_tool_that_runs_out_covers_its_outline_swung_out(tmp_path, shape):
    """Off centre by r, the outline reaches r times the sine of the slope farther into a slope."""
    effect = "[effects.runout.T1]\nrunout_um = 10\nmarks_share = 0\n"
    expected = [-10.0 * np.sin(np.radians(slope)) for *_, slope in groove(shape)]
    np.testing.assert_allclose(deviation_um(tmp_path, shape, effect=effect), expected, atol=1e-6)
