"""An R-test against rigid bodies written out here: turned lines that are displaced and tilted."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.small_job import measurement, write_job
from vmach.diagnosis.diagnose import diagnose
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.errors import InputError
from vmach.instruments import read_instruments
from vmach.job import read_job

TOOL_MM = 100.0
CENTRE_MM = {"A": (-200.0, -150.0, -260.0), "B": (0.0, 0.0, 40.0), "C": (-200.0, -150.0, -250.0)}
#: where the sphere really stands beside its stated place, which nobody knows
SPHERE_OFF_MM = np.array([0.02, -0.01, 0.005])
TABLE, TRUNNION, HEAD = "Z Y b X' C' w", "Z Y b X' A' C' w", "B Z Y b X' w"


def placed(rotation=None, shift=(0.0, 0.0, 0.0)):
    """A homogeneous matrix."""
    matrix = np.eye(4)
    matrix[:3, 3] = shift
    if rotation is not None:
        matrix[:3, :3] = rotation.as_matrix()
    return matrix


def turn(letter, angle_deg, errors):
    """A turn about the real line of an axis; errors as ``{"X0C": 18.0}``, um and urad."""
    shift, tilt = np.zeros(3), np.zeros(3)
    for name, value in errors.items():
        if name[2] == letter:
            part = shift if name[0] in "XYZ" else tilt
            part["XYZABC".index(name[0]) % 3] = value * (1e-3 if name[0] in "XYZ" else 1e-6)
    line = placed(shift=CENTRE_MM[letter]) @ placed(Rotation.from_rotvec(tilt), shift)
    about = np.eye(3)["ABC".index(letter)] * np.radians(angle_deg)
    return line @ placed(Rotation.from_rotvec(about)) @ np.linalg.inv(line)


def tip_minus_sphere_um(chain, angles_deg, sphere_mm, errors):
    """What three sensors on the spindle read, along the axes of the machine.

    The control drives the nominal tip to where the nominal sphere is. An axis that carries the
    table turns it the other way (ISO 841); one on the head turns the tool.
    """
    on_table = [w[0] for w in chain.split() if w[0] in "ABC" and w.endswith("'")]
    tables, heads = {}, {}
    for name, said in (("nominal", {}), ("real", errors)):
        tables[name], heads[name] = np.eye(4), np.eye(4)
        for letter in (w for w in "ABC" if w in angles_deg):
            if letter in on_table:
                tables[name] = tables[name] @ turn(letter, -angles_deg[letter], said)
            else:
                heads[name] = heads[name] @ turn(letter, angles_deg[letter], said)
    sphere, tool = np.append(sphere_mm, 1.0), np.array([0.0, 0.0, -TOOL_MM, 1.0])
    moved = (heads["real"] - heads["nominal"]) @ tool
    seen = tables["real"] @ (sphere + np.append(SPHERE_OFF_MM, 0.0))
    return 1e3 * (tables["nominal"] @ sphere + moved - seen)[:3]


def write_r_test(folder, chain, angles, *, sphere_mm, errors, noise_um=0.0, more=""):
    """The job; `angles` are dicts of letter to degrees."""
    section = measurement("r_test", sphere_mm=list(sphere_mm), tool_length_mm=TOOL_MM, u_um=0.3)
    job = write_job(folder, more=section)
    job.write_text(job.read_text().replace('measured = "points.csv"\n', ""))
    letters = list(angles[0])
    text = (folder / "machine.toml").read_text().replace("Z Y b X' w", chain)
    for letter in letters:
        text += f"[axes.{letter}]\ntravel_deg = [-360, 360]\n"
        text += f"centre_mm = {list(CENTRE_MM[letter])}\n"
    (folder / "machine.toml").write_text(text + more)
    random, rows = np.random.default_rng(1), []
    for k, turned in enumerate(angles):
        read = tip_minus_sphere_um(chain, turned, sphere_mm, errors)
        read += noise_um * random.normal(size=3)
        cells = [20 * k, *turned.values(), *read]
        rows.append(",".join(f"{cell:.6f}" for cell in cells))
    heading = ",".join(["t_s", *(f"{a}_deg" for a in letters), "dx_um", "dy_um", "dz_um"])
    (folder / "r_test.csv").write_text("\n".join([heading, *rows]) + "\n")
    return job


CASES = {
    TABLE: ([{"C": c} for c in [*range(0, 361, 30), *range(330, -1, -30)]], (-120, -150, -230)),
    TRUNNION: (
        [{"A": a, "C": c} for a in (0, -30, -60, 30) for c in range(0, 360, 45)],
        (-160, -150, -200),
    ),
    HEAD: ([{"B": b} for b in [*range(-90, 91, 15)] * 2], (-200, -150, -180)),
}
HIDDEN = [
    (TABLE, {"X0C": 18.0, "Y0C": -11.0}),
    (TABLE, {"A0C": 40.0}),
    (TRUNNION, {"Y0A": 20.0, "Z0A": -12.0}),
    (TRUNNION, {"X0C": 18.0, "Y0C": -11.0}),
    (TRUNNION, {"B0A": 30.0, "C0A": -50.0}),
    (HEAD, {"X0B": 21.0, "Z0B": -14.0}),
]


@pytest.mark.parametrize(("chain", "errors"), HIDDEN)
def test_location_errors_of_the_machine_file_foresee_the_test(tmp_path, chain, errors):
    """All but the place of the sphere, which is free, and products of two small errors."""
    angles, sphere = CASES[chain]
    stated = "".join(f"E{name} = {value}\n" for name, value in errors.items())
    job = write_r_test(
        tmp_path, chain, angles, sphere_mm=sphere, errors=errors, more=f"[location]\n{stated}"
    )
    (test,) = read_instruments(read_job(job))
    apart = test.measured_mm - test.predicted_mm
    place = np.linalg.lstsq(test.nuisance, apart, rcond=None)[0]
    assert np.abs(apart - test.nuisance @ place).max() < 1e-5
    assert place == pytest.approx(-SPHERE_OFF_MM, abs=1e-5)
    assert np.ptp(test.predicted_mm) > 1e-3


@pytest.mark.parametrize(("chain", "errors"), HIDDEN)
def test_hidden_location_errors_are_found_with_size_and_sign(tmp_path, chain, errors):
    angles, sphere = CASES[chain]
    job = write_r_test(tmp_path, chain, angles, sphere_mm=sphere, errors=errors, noise_um=0.3)
    found = {f.label: f for f in diagnose(survey_job(read_job(job))).findings}
    kinds = {True: ("rotary_location", 1.0), False: ("rotary_tilt", 6.0)}
    wanted = {f"{kinds[n[0] in 'XYZ'][0]} {n}": n for n in errors}
    assert set(found) == set(wanted)
    for label, name in wanted.items():
        (size,) = found[label].parameters.values()
        assert size == pytest.approx(errors[name], abs=kinds[name[0] in "XYZ"][1])


def test_a_machine_without_location_errors_is_told_so(tmp_path):
    angles, sphere = CASES[TRUNNION]
    job = write_r_test(tmp_path, TRUNNION, angles, sphere_mm=sphere, errors={}, noise_um=0.3)
    assert diagnose(survey_job(read_job(job))).verdict == "nothing"


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("C_deg", "B_deg", "r_test.csv:1: angles of B_deg; accepted: .* the machine: C_deg"),
        ("C_deg", "C", "r_test.csv:1: angles of no axis; accepted: .* C_deg"),
        (",330.000000,", ",430,", r"r_test.csv:13: C_deg is 430; .* the travel, -360 .. 360 deg"),
    ],
)
def test_angles_that_cannot_be_are_refused(tmp_path, old, new, said):
    angles, sphere = CASES[TABLE]
    job = write_r_test(tmp_path, TABLE, angles, sphere_mm=sphere, errors={})
    path = tmp_path / "r_test.csv"
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new, 1))
    with pytest.raises(InputError, match=said):
        read_instruments(read_job(job))
