"""Importers: what each file says is what the project's own files say, in closed form."""

from __future__ import annotations

import re
import sys
from importlib import invalidate_caches
from pathlib import Path

import numpy as np
import pytest
import trimesh
from typer.testing import CliRunner

from tests.import_samples import (
    BALLBAR_REPORT,
    LASER,
    PROBE_LOG,
    SAMPLES,
    write_plate_job,
)
from tests.small_job import MACHINE, write_job
from vmach.cli import app
from vmach.controller_tables import FORMATS
from vmach.errors import InputError
from vmach.importers import Questions, catalogue, import_files
from vmach.importers.importing import Target, kind_of, write_imported
from vmach.importers.self_check import check_readings
from vmach.importers.source_file import SourceFile
from vmach.importers.squareness import skew_of_square, skew_u
from vmach.instruments import read_instruments
from vmach.job import read_job
from vmach.machine import Variant, displacement, read_machine
from vmach.machine.tables.error_table import MM_PER, read_error_table
from vmach.nominal import read_nominal
from vmach.nominal.nearest import feet_on
from vmach.nominal.points import read_points_csv


def imported(folder, name, content, *, encoding="utf-8", columns=None, machine=None, **given):
    (folder / name).write_text(content, encoding=encoding)
    questions = Questions(given, columns=columns or {}, machine_file=machine)
    (one,) = import_files([folder / name], questions)
    return one


def rows(text):
    return [line.split(",") for line in text.splitlines()]


@pytest.mark.parametrize("sample", SAMPLES, ids=lambda s: f"{s.kind}-{s.file}")
def test_every_sample_is_known_and_read(sample, tmp_path):
    path = sample.write(tmp_path)
    assert kind_of(SourceFile(path), None).name == sample.kind
    job = write_plate_job(tmp_path)
    (one,) = import_files([path], Questions(sample.answers, job_file=job))
    assert one.files or one.sections


def test_every_kind_has_a_sample():
    assert {sample.kind for sample in SAMPLES} == set(catalogue())


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp1252", "utf-16"])
def test_a_laser_in_any_encoding_with_decimal_commas(encoding, tmp_path):
    one = imported(tmp_path, "x.csv", LASER, encoding=encoding, error="EXX")
    assert rows(one.files["errors/EXX.csv"]) == [
        ["position_mm", "forward_1_um", "backward_1_um"],
        ["-300", "0", "-1.1"],
        ["-200", "1.5", "0.4"],
        ["-100", "3.2", "2.2"],
    ]


def test_inches_and_runs_side_by_side(tmp_path):
    text = 'Target [inch],Run 1 + [inch],Run 1 - [inch]\n0,0,0.0001\n10,"0.0002",0.0003\n'
    one = imported(tmp_path, "y.csv", text, error="EYY")
    assert rows(one.files["errors/EYY.csv"])[1:] == [["0", "0", "2.54"], ["254", "5.08", "7.62"]]


def test_target_and_actual_in_the_order_of_the_motion(tmp_path):
    """No column of directions: up, then from the other side down again."""
    text = "soll (mm)\tist (mm)\n0\t0.001\n100\t100.002\n100\t100.004\n0\t0.003\n"
    one = imported(tmp_path, "z.txt", text, error="EZZ")
    assert rows(one.files["errors/EZZ.csv"])[1:] == [["0", "1", "3"], ["100", "2", "4"]]


@pytest.mark.parametrize(
    ("error", "unit", "said"),
    [
        ("EXX", "arcsec", "EXX is a displacement, and the column of deviation is in arcsec"),
        ("EYX", "um/m", "EYX is a displacement, and the column of deviation is in um/m"),
        ("EBX", "um", "EBX is a rotation, and the column of deviation is in um"),
    ],
)
def test_a_length_is_no_angle(error, unit, said, tmp_path):
    """1 arcsec was taken for 4.85 um, and 1 um for 1 urad."""
    text = f"Position (mm);Deviation ({unit})\n0;0,1\n100;0,5\n"
    with pytest.raises(InputError, match=said):
        imported(tmp_path, "x.csv", text, error=error)
    with pytest.raises(InputError, match=said):
        imported(tmp_path, "y.csv", text.replace(f" ({unit})", ""), error=error, unit=unit)


def test_positions_that_were_reached_are_no_straightness(tmp_path):
    text = "Target (mm),Actual (mm)\n0,0.001\n100,100.002\n"
    with pytest.raises(InputError, match="positions that were reached say nothing of EYX"):
        imported(tmp_path, "x.csv", text, error="EYX")


def test_separators_of_thousands_are_no_decimal_commas(tmp_path):
    """A spreadsheet in English writes 1000 mm so: it was taken for 1 mm."""
    text = 'Position (mm),Deviation (um)\n0,0.0\n500,2.5\n"1,000",4.0\n'
    with pytest.raises(InputError, match=r"x.csv:4: '1,000' has a comma, '0.0' a point"):
        imported(tmp_path, "x.csv", text, error="EXX")


@pytest.mark.parametrize(
    ("heading", "said"),
    [
        ("Position (mm);Deviation (um);Deviation (um)", "columns 2 and 3"),
        ("Position (mm);Forward (um);Forward (um)", "may both be forward"),
        ("Pos;Target (mm);Deviation (um)", "'Pos' and 'Target .mm.', may both be position"),
    ],
)
def test_no_column_is_left_out_in_silence(heading, said, tmp_path):
    text = f"{heading}\n0;1;2\n100;3;4\n"
    with pytest.raises(InputError, match=said):
        imported(tmp_path, "x.csv", text, error="EXX")
    columns = {"position": "Target (mm)"}
    if "Pos;" in heading:
        one = imported(tmp_path, "x.csv", text, columns=columns, error="EXX")
        assert [row[0] for row in rows(one.files["errors/EXX.csv"])[1:]] == ["1", "3"]


def test_a_report_in_inches_whose_headings_name_no_unit(tmp_path):
    text = "x,y,z,mx,my,mz,i,j,k\n1,2,0,1.0001,2,0.0002,0,0,1\n"
    one = imported(tmp_path, "p.csv", text, unit="inch")
    assert rows(one.files["p_points.csv"])[1][2:] == [
        "25.4", "50.8", "0", "0", "0", "1", "25.40254", "50.8", "0.00508",
    ]  # fmt: skip


def test_deviations_in_a_column_of_positions_are_refused(tmp_path):
    """``Messwert`` is either; a message names the file that the user knows, and its line."""
    text = "Soll (mm);Messwert (µm)\n0;0,1\n100;1,5\n"
    with pytest.raises(InputError, match=r"x.csv:3: 0.0015 mm was reached where 100 mm was the"):
        imported(tmp_path, "x.csv", text, error="EXX")
    one = imported(tmp_path, "x.csv", text, columns={"deviation": "Messwert (µm)"}, error="EXX")
    assert rows(one.files["errors/EXX.csv"])[2] == ["100", "1.5", "1.5"]
    with pytest.raises(InputError, match=r"y.csv:1: row '100, 1500, 1500' holds an error of 1.5"):
        imported(tmp_path, "y.csv", "Soll (mm);Fehler (mm)\n0;0,1\n100;1,5\n", error="EXX")


def test_names_of_columns_as_told(tmp_path):
    text = "A;B\n0;1,5\n50;2,5\n"
    given = {"error": "EXX", "unit": "um"}
    with pytest.raises(InputError, match="no importer knows this file"):
        imported(tmp_path, "a.csv", text, **given)
    columns = {"position": "A", "deviation": "B"}
    (tmp_path / "a.csv").write_text(text)
    (one,) = import_files([tmp_path / "a.csv"], Questions(given, columns=columns), kind="laser")
    assert rows(one.files["errors/EXX.csv"])[2] == ["50", "2.5", "2.5"]


@pytest.mark.parametrize("counts, at_mm, along", [("up", -250.0, 1.0), ("down", 150.0, -1.0)])
def test_what_a_laser_read_is_what_the_machine_does(counts, at_mm, along, tmp_path):
    """A reading of +3.2 um at position -100 of the file, reached along the file's +."""
    job = write_job(tmp_path)
    machine = job.with_name("machine.toml")
    machine.write_text(MACHINE.replace("[-400, 0]", "[-400, 400]") +
                       '[tables]\ndirections = "separate"\n')  # fmt: skip
    zero = "-150" if counts == "up" else "50"
    one = imported(tmp_path, "x.csv", LASER, error="EXX", counts=counts, zero=zero)
    write_imported([one], Target(tmp_path, (machine,)))
    nose = np.array([[at_mm, -100.0, -100.0]])
    side = np.array([[along, 0.0, 0.0]])
    moved = displacement(read_machine(machine), nose, np.zeros(3), Variant.ABBE, direction=side)
    assert moved.shift_mm[0] == pytest.approx([along * 3.2e-3, 0.0, 0.0], abs=1e-12)


def test_a_machine_that_counts_bodies_gets_the_sign_of_the_body(tmp_path):
    """X carries the workpiece in the chain of the small job: its body moves the other way."""
    machine = write_job(tmp_path).with_name("machine.toml")
    machine.write_text(MACHINE.replace('"relative"', '"body"'))
    one = imported(tmp_path, "x.csv", LASER, error="EXX", machine=machine)
    assert rows(one.files["errors/EXX.csv"])[3] == ["-100", "-3.2", "-2.2"]
    assert "difference RMS 0.00" in one.told[1]


def test_the_self_check_sees_what_is_wrong(tmp_path):
    """With all readings in one run, the mean of two runs is what the table says."""
    text = "Position (mm);Deviation (um);Direction\n0;0;+\n100;4;+\n0;2;+\n100;8;+\n"
    one = imported(tmp_path, "x.csv", text, error="EXX")
    assert "difference RMS 1.58, largest 2.00 um" in one.told[1]  # sqrt((1 + 1 + 4 + 4) / 4)


@pytest.mark.parametrize(
    "plane, answer, axes", [("XY", "more", (0, 1)), ("ZX", "less", (2, 0)), ("YZ", "more", (1, 2))]
)
def test_squareness_is_the_angle_between_the_axes(plane, answer, axes, tmp_path):
    """The directions of travel of both axes enclose more, or less, than 90 degrees."""
    report = BALLBAR_REPORT.replace('"XY"', f'"{plane}"')
    one = imported(tmp_path, "qc.b5r", report, angle=answer)
    machine = write_job(tmp_path).with_name("machine.toml")
    write_imported([one], Target(tmp_path, (machine,)))
    described = read_machine(machine)
    ends = -100.0 * np.eye(3)[list(axes)]
    nose = np.vstack([np.zeros(3), ends])
    moved = displacement(described, nose, np.zeros(3), Variant.ABBE).shift_mm
    along = [(nose[0] + moved[0]) - (nose[k] + moved[k]) for k in (1, 2)]
    cosine = along[0] @ along[1] / np.prod([np.linalg.norm(a) for a in along])
    beyond_urad = 1e6 * (np.arccos(cosine) - np.pi / 2)
    assert beyond_urad == pytest.approx(34.1 if answer == "more" else -34.1, rel=1e-4)


@pytest.mark.parametrize("sample", [s for s in SAMPLES if s.kind in ("ballbar", "drift")],
                         ids=lambda s: s.kind)  # fmt: skip
def test_readings_come_into_the_job(sample, tmp_path):
    job = write_job(tmp_path)
    job.write_text(job.read_text().replace('measured = "points.csv"\n', ""))
    one = imported(tmp_path, sample.file, sample.text, **sample.answers)
    write_imported([one], Target(tmp_path, (job,)))
    (found,) = read_instruments(read_job(job))
    assert found.instrument.name == sample.kind
    count = {"ballbar": 48, "drift": 60}
    assert len(found) == count[sample.kind]
    if sample.kind == "drift":
        last = found.measured_mm[found.sensing[:, 2] > 0.5][-1]
        assert last == pytest.approx(12e-3 * (1 - np.exp(-57 / 20)), abs=1e-6)


def test_a_ballbar_is_predicted_on_the_machine_of_the_job(tmp_path):
    """A squareness of 100 urad, r = 100 mm: -r EC0Y sin cos is -+5 um; nothing in another plane."""
    job = write_job(tmp_path, squareness="[squareness]\nEC0Y = 100\n")
    job.write_text(job.read_text().replace('measured = "points.csv"\n', ""))
    angle = np.arange(0.0, 360.0, 5.0)
    read = -10.0 * np.sin(np.radians(angle)) * np.cos(np.radians(angle))
    rows_ = "\n".join(f"CCW,{a},{v:.6f}" for a, v in zip(angle, read, strict=True))
    for name, plane, said in (("good", "XY", "RMS 0.00, largest 0.00 um"),
                              ("turned", "ZX", "largest 5.00 um")):  # fmt: skip
        answers = {"centre": "-200 -150 -150", "radius": "100", "tool_length": "100",
                   "feed": "1000", "plane": plane}  # fmt: skip
        one = imported(tmp_path, f"{name}.csv", f"Run;Angle;Deviation (um)\n{rows_}\n".replace(
            ",", ";"), **answers)  # fmt: skip
        write_imported([one], Target(tmp_path, (job,)))
        (line,) = check_readings(job, set(one.files))
        assert said in line


def test_a_point_of_qif_that_is_not_compensated_is_the_centre_of_a_ball(tmp_path):
    """Numbers of QIF_PTS_SAMPLE of the QIF community: its own characteristic has -0.086196 mm."""
    text = next(sample for sample in SAMPLES if sample.kind == "qif").text
    at = "-51.726518705386 54.198959479609 -1.276811288879"
    for old, new in (
        ("0.0254", "0.001"),
        ("<Location>1 2 0</Location><Normal>0 0 1</Normal>",
         "<Location>-50.175094015692 54.198959479609 -3.125725044257</Location>"
         "<Normal>-0.642788056925063 0 0.766044067841075</Normal>"),
        ("1.0 2.0 0.001", at),
        ("</MeasuredFeatures>",
         '</MeasuredFeatures><MeasuredPointSets n="1"><MeasuredPointSet id="10" '
         f'count="1"><Points>\n{at}\n</Points><Compensated>false</Compensated>'
         "<ProbeRadius>2.49978271104</ProbeRadius></MeasuredPointSet></MeasuredPointSets>"),
    ):  # fmt: skip
        assert old in text
        text = text.replace(old, new)
    for told, mm in (("false", -0.086196), ("true", 2.413587)):
        one = imported(tmp_path, "part.qif", text.replace(">false<", f">{told}<"))
        row = [float(cell) for cell in rows(one.files["part_points.csv"])[1][2:]]
        apart = np.dot(np.subtract(row[6:9], row[:3]), row[3:6])
        assert apart == pytest.approx(mm, abs=1e-6)
        assert any("probe's ball" in line for line in one.told) is (told == "false")


@pytest.mark.parametrize("digits", [1, 0], ids=["tenths", "whole degrees"])
def test_two_circles_are_two_runs_however_angles_are_rounded(digits, tmp_path):
    """Up to 360 degrees and back: 901 readings each way, every 0.4 degrees."""
    up = np.arange(901) * 0.4
    angle = np.round(np.concatenate([up, up[::-1]]), digits)
    text = "Angle (deg),Deviation (um)\n" + "\n".join(f"{a:.{digits}f},0.1" for a in angle)
    answers = {"centre": "0 0 0", "radius": "150", "tool_length": "100", "feed": "1000"}
    one = imported(tmp_path, "c.csv", text, **answers)
    found = [row[0] for row in rows(one.files["c_ballbar.csv"])[1:]]
    assert set(found) == {"CCW1", "CW1"} and found == sorted(found)
    # which of the readings at the turn were still on the way up, rounding does not tell
    assert abs(found.count("CW1") - 901) <= (0 if digits else 1)


def test_positions_as_a_display_shows_them_are_one_target(tmp_path):
    """ISO 230-2: each target from both sides; the last digits make neither targets nor turns."""
    text = "Position (mm),Deviation (um)\n0.0001,1\n99.9998,2\n200,3\n200.0003,4\n100.0002,5\n0,6\n"
    one = imported(tmp_path, "x.csv", text, error="EXX")
    table = rows(one.files["errors/EXX.csv"])
    assert [row[1:] for row in table[1:]] == [["1", "6"], ["2", "5"], ["3", "4"]]
    assert [float(row[0]) for row in table[1:]] == pytest.approx([0, 100, 200], abs=3e-4)


@pytest.mark.parametrize("name", [one.name for one in FORMATS.values() if one.errors])
def test_tables_of_controls_come_back(name, tmp_path):
    """What the control would take back is what the imported machine gets wrong."""
    from vmach.controller_tables import make_tables
    from vmach.controller_tables.table_task import task_of_machine

    curves = {f"E{a}{a}": (lambda q: 3.0 * np.sin(q / 60.0), None) for a in "XYZ"}
    if name in ("isg", "components"):
        curves |= {"EBX": (lambda q: 0.02 * q, None), "ECY": (lambda q: 0.03 * q, None)}
        curves = {n: (c, (0, 0, 0) if n[1] in "XYZ" else None) for n, (c, _) in curves.items()}
    machine = write_job(tmp_path, curves, squareness="[squareness]\nEC0Y = 20.0\n")
    machine = machine.with_name("machine.toml")
    machine.write_text(machine.read_text().replace("t (C) Z Y b X' w", "t (C) Z Y X b w"))
    task = task_of_machine(read_machine(machine), Variant.ABBE, tool_length_mm=80.0,
                           tolerance_mm=2e-4)  # fmt: skip
    (tmp_path / "tables").mkdir()
    make_tables(task, tmp_path / "tables", formats=[name])
    bare = machine.with_name("bare.toml")
    text = MACHINE.replace("t (C) Z Y b X' w", "t (C) Z Y X b w")
    bare.write_text(text + '[tables]\nextrapolation = "hold"\n')
    (one,) = import_files([tmp_path / "tables" / name], Questions(machine_file=bare))
    write_imported([one], Target(tmp_path / "back", (bare,)))
    random = np.random.default_rng(1)
    nose = random.uniform([-390, -290, -290], [-10, -10, -10], (50, 3))
    tool = np.array([0.0, 0.0, -80.0])
    still = np.zeros_like(nose)
    tables = FORMATS[name].read(tmp_path / "tables" / name, {})
    corrected = tables.applied_correction(nose, still, np.tile(tool, (50, 1)))
    moved = displacement(read_machine(bare), nose, tool, Variant.ABBE).shift_mm
    apart = moved + corrected
    if name not in ("isg", "components"):  # a constant of the tables is nobody's error
        apart = apart - apart.mean(axis=0)
    assert np.abs(apart).max() < 2e-6


def test_an_entry_of_a_control_that_is_no_number_is_named(tmp_path):
    (sample,) = [one for one in SAMPLES if one.file == "AX_EEC.INI"]
    path = sample.write(tmp_path, sample.text.replace("0.004", "0.1e400"))
    with pytest.raises(InputError, match=r"AX_EEC.INI:4: value '0.1e400'; accepted: a number"):
        import_files([path], Questions())


def test_points_of_a_scan_lie_on_the_nominal_surface(tmp_path):
    """A grown, moved plate: what a scan of it reads is known at every point."""
    job = write_plate_job(tmp_path)
    random = np.random.default_rng(2)
    plate = trimesh.creation.box((40.0, 30.0, 10.0))
    plate.apply_translation((0.0, 0.0, -5.0))
    seen, face = trimesh.sample.sample_surface(plate, 500, seed=3)
    out = plate.face_normals[face]
    size = random.uniform(-0.05, 0.05, len(seen))
    cloud = seen + size[:, None] * out
    np.savetxt(tmp_path / "scan.xyz", cloud)
    (one,) = import_files([tmp_path / "scan.xyz"], Questions(job_file=job))
    (name,) = one.files
    (tmp_path / name).write_text(one.files[name])
    points = read_points_csv(tmp_path / name)
    away = np.min(np.abs(np.abs(seen - [0, 0, -5]) - [20.0, 15.0, 5.0]) + 9 * np.abs(out), axis=1)
    clear = away > 0.2  # from every edge
    assert np.count_nonzero(clear) > 400
    assert np.abs(points.measured_deviation_mm - size)[clear].max() < 1e-6


@pytest.mark.parametrize("separator", [" ", "; ", "\t"])
def test_a_scan_with_decimal_commas(separator, tmp_path):
    """Commas between numbers stay what they are; commas in all of them are decimal ones."""
    job = write_plate_job(tmp_path)
    corners = [[-2.25, -2.5, 0.004], [5.125, 3.0, 0.005], [2.0, 4.75, -0.001], [6.5, -3.0, 0.0]]
    files = {}
    for name, mark, apart in (("a.xyz", ".", ","), ("b.xyz", ",", separator)):
        lines = [apart.join(f"{v:.3f}".replace(".", mark) for v in row) for row in corners]
        (tmp_path / name).write_text("\n".join(lines))
        (one,) = import_files([tmp_path / name], Questions(job_file=job))
        files[name] = list(one.files.values())
    assert files["a.xyz"] == files["b.xyz"]


def test_feet_on_exact_surfaces():
    """On a STEP part: sampled points moved along their normals come back."""
    part = read_nominal(Path(__file__).parents[2] / "samples/freecad_pocket/part.step")
    known = part.sample(7.0, edge_margin_mm=1.0)
    random = np.random.default_rng(4)
    size = random.uniform(-0.1, 0.1, len(known))
    feet = feet_on(part, known.point_mm + size[:, None] * known.normal)
    assert (feet.feature == known.feature).all()
    assert np.abs(feet.distance_mm - size).max() < 1e-7


def test_the_ball_of_a_probe_is_taken_off(tmp_path):
    job = write_plate_job(tmp_path)
    (tmp_path / "p.txt").write_text(PROBE_LOG)
    (one,) = import_files([tmp_path / "p.txt"], Questions({"ball_mm": "2"}, job_file=job))
    (text,) = one.files.values()
    z = [float(row[-1]) for row in rows(text)[1:]]
    assert z == pytest.approx([0.0, 0.001, -0.002, 0.0], abs=1e-9)


def test_a_scan_in_inches_is_asked_about(tmp_path):
    job = write_plate_job(tmp_path)
    corners = np.array([[-19, -14, 0], [19, -14, 0], [19, 14, 0], [-19, 14, 0]]) / 25.4
    np.savetxt(tmp_path / "scan.asc", corners)
    with pytest.raises(InputError, match="are they in inches"):
        import_files([tmp_path / "scan.asc"], Questions(job_file=job))
    questions = Questions({"unit": "inch"}, job_file=job)
    (one,) = import_files([tmp_path / "scan.asc"], questions)
    assert len(rows(next(iter(one.files.values())))) == 5


def test_qif_in_inches_and_dmis(tmp_path):
    by_kind = {sample.kind: sample for sample in SAMPLES}
    qif = imported(tmp_path, "part.qif", by_kind["qif"].text)
    assert rows(qif.files["part_points.csv"])[1] == (
        ["TOP", "TOP", "25.4", "50.8", "0", "0", "0", "1", "25.4", "50.8", "0.0254"]
    )
    assert [float(v) for v in rows(qif.files["part_holes.csv"])[1][1:]] == pytest.approx(
        [76.2, 25.4, 76.2254, 25.4, 12.7, 12.7254]
    )
    dmis = imported(tmp_path, "part.dmo", by_kind["dmis"].text)
    assert rows(dmis.files["part_holes.csv"])[1] == ["H1", "10", "20", "10.011", "19.995", "8",
                                                     "8.012"]  # fmt: skip


def test_dmis_in_inches(tmp_path):
    """Places and diameters are lengths, i j k are none."""
    text = {sample.kind: sample for sample in SAMPLES}["dmis"].text
    text = text.replace("UNITS/MM", "UNITS/INCH")
    dmis = imported(tmp_path, "part.dmo", text)
    point = [float(v) for v in rows(dmis.files["part_points.csv"])[1][2:]]
    assert point == pytest.approx([0, 0, 0, 0, 0, 1, 0.0254, 0.0508, -0.31242])
    hole = [float(v) for v in rows(dmis.files["part_holes.csv"])[1][1:]]
    assert hole == pytest.approx([254, 508, 254.2794, 507.873, 203.2, 203.5048])


def test_a_sensor_that_the_tool_carries_reads_the_reverse(tmp_path):
    """The spindle grows: its end goes along -Z, and comes nearer to whatever stands below."""
    text = "Time (min),dX (um),dZ (um)\n0,0,0\n10,2,-5\n"
    said = {"at": "-200 -150 -150", "tool_length": "150", "rpm": "6000"}
    for sensor, sign in (("workpiece", 1.0), ("tool", -1.0)):
        one = imported(tmp_path, "d.csv", text, sensor=sensor, **said)
        found = [[float(v) for v in row] for row in rows(one.files["d_drift.csv"])[1:]]
        assert found[1] == pytest.approx([600.0, 6000.0, 2.0 * sign, -5.0 * sign])


def test_a_circle_takes_its_time_across_zero_degrees(tmp_path):
    """A radius of 150 mm at 1000 mm/min; a deviation inwards may be written with plus."""
    angle = np.arange(200.0, 561.0, 20.0) % 360.0
    text = "Angle (deg),Deviation (um)\n" + "\n".join(f"{a:g},3" for a in angle)
    answers = {"centre": "0 0 0", "radius": "150", "tool_length": "100", "feed": "1000"}
    for outward, sign in (("yes", 1.0), ("no", -1.0)):
        one = imported(tmp_path, "c.csv", text, outward=outward, **answers)
        _, *found = rows(one.files["c_ballbar.csv"])
        time = [float(row[3]) for row in found]
        assert np.diff(time) == pytest.approx(np.full(18, np.pi * 300.0 / 18.0 * 0.06), abs=1e-4)
        assert {float(row[4]) for row in found} == {3.0 * sign}
        assert {row[0] for row in found} == {"CCW1"}


def test_a_volumetric_file_gives_tables_and_squareness(tmp_path):
    machine = write_job(tmp_path).with_name("machine.toml")
    text = {sample.file: sample for sample in SAMPLES}["etalon.txt"].text
    write_imported([imported(tmp_path, "etalon.txt", text)], Target(tmp_path, (machine,)))
    found = read_machine(machine)
    expected = np.zeros((3, 3))
    expected[1, 2] = 34.1e-6  # C0Y: the line of Y, turned about Z
    assert found.squareness_rad == pytest.approx(expected)
    at = np.array([-300.0, -200.0, 0.0])
    assert found.components["EXX"].evaluate(at) == pytest.approx([1e-3, 2e-3, 2e-3])
    assert found.components["EBX"].evaluate(at) == pytest.approx([10e-6, 40e-6 / 3, 20e-6])


def test_a_scan_is_thinned_evenly_and_a_short_row_is_refused(tmp_path):
    questions = Questions({"points": "9"}, job_file=write_plate_job(tmp_path))
    path = tmp_path / "s.xyz"
    path.write_text("".join(f"{x / 10:.1f} 1 0.001\n" for x in range(-20, 61)))
    (one,) = import_files([path], questions)
    kept = [float(row[2]) for row in rows(one.files["s_points.csv"])[1:]]
    assert kept == pytest.approx(np.linspace(-2.0, 6.0, 9))
    assert any("9 of 81 points are kept" in line for line in one.told)
    path.write_text("0 0 0\n1 2\n")
    with pytest.raises(InputError, match=r"s\.xyz:2: '1 2'"):
        import_files([path], questions)


def test_a_file_of_the_user_is_edited_once_and_kept(tmp_path):
    machine = write_job(tmp_path).with_name("machine.toml")
    before = machine.read_text()
    one = imported(tmp_path, "x.csv", LASER, error="EXX", zero="-5")
    write_imported([one], Target(tmp_path, (machine,)))
    assert machine.with_name("machine.toml.bak").read_text() == before
    assert before in machine.read_text().replace("\n[errors.EXX]", "")  # nothing else changed
    after = machine.read_text()
    with pytest.raises(InputError, match=r"errors.EXX.table is there already"):
        write_imported([one], Target(tmp_path, (machine,)))
    assert machine.read_text() == after


def test_nothing_is_written_where_anything_is_wrong(tmp_path):
    machine = write_job(tmp_path).with_name("machine.toml")
    (tmp_path / "errors").mkdir()
    (tmp_path / "errors" / "EXX.csv").write_text("mine")
    before = machine.read_text()
    one = imported(tmp_path, "x.csv", LASER, error="EXX")
    with pytest.raises(InputError, match="vmach did not write it"):
        write_imported([one], Target(tmp_path, (machine,)))
    assert machine.read_text() == before
    assert (tmp_path / "errors" / "EXX.csv").read_text() == "mine"


@pytest.mark.parametrize(
    "change, said",
    [
        (("3,2", "3,2,1"), r"x.csv:6: Abweichung \(µm\) is '3,2,1'"),
        (("-100,0;3,2;+;1", "-100,0;3,2"), r"x.csv:6: 2 cells; accepted: 4 as in line 3"),
        (("0,4;-;1", "0,4;sideways;1"), r"x.csv:8: direction 'sideways'"),
        ((" (µm)", ""), r"x.csv:3: the heading 'Abweichung' names no unit"),
        (("-200,0;1,5", ";1,5"), r"x.csv:5: no position in this row"),
    ],
)
def test_a_bad_row_is_named(change, said, tmp_path):
    with pytest.raises(InputError, match=said):
        imported(tmp_path, "x.csv", LASER.replace(*change), error="EXX")


def test_what_only_the_user_knows_is_asked_or_said(tmp_path):
    with pytest.raises(InputError, match=r"which error does x.csv hold.*--set error="):
        imported(tmp_path, "x.csv", LASER)
    with pytest.raises(InputError, match="error = 'EXQ'; accepted: EXX, EYX"):
        imported(tmp_path, "x.csv", LASER, error="EXQ")
    with pytest.raises(InputError, match="--set radius: no file asks for it"):
        imported(tmp_path, "x.csv", LASER, error="EXX", radius="5")
    asked = []

    def person(question, default):
        asked.append(question)
        return {"which": "EXX", "when ": "down", "machi": "-7"}.get(question[:5], default)

    (tmp_path / "x.csv").write_text(LASER)
    (one,) = import_files([tmp_path / "x.csv"], Questions(ask=person))
    values = one.sections[0].values
    assert values["position_zero_mm"] == -7 and values["reverse"] is True
    assert len(asked) == 4  # which error, and the three questions


SOUND = '''\
"""A dial gauge of our own."""

from vmach.importers import Imported, Importer, Section


class Gauge(Importer):
    """Two numbers a line."""

    name = "gauge"
    title = "Our gauge"
    reads = ".gau: two numbers a line"
    rank = 1

    def recognises(self, source):
        return source.suffix == ".gau"

    def read(self, source, questions):
        section = Section("machine", "squareness", {"EC0Y": float(source.lines[0])})
        return Imported(sections=(section,), told=("read",))
'''


def plugged_in(folder, monkeypatch, text):
    """A package with an importer, as an installation leaves it."""
    about = folder / "our_gauge-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: our-gauge\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text("[vmach.importers]\ngauge = our_gauge:Gauge\n")
    (folder / "our_gauge.py").write_text(text)
    monkeypatch.syspath_prepend(folder)
    monkeypatch.delitem(sys.modules, "our_gauge", raising=False)
    invalidate_caches()


@pytest.fixture
def fresh():
    catalogue.cache_clear()
    yield
    catalogue.cache_clear()


@pytest.mark.usefixtures("fresh")
def test_an_importer_of_another_package(tmp_path, monkeypatch):
    plugged_in(tmp_path, monkeypatch, SOUND)
    one = imported(tmp_path, "today.gau", "12.5\n")
    assert one.sections[0].values == {"EC0Y": 12.5}


@pytest.mark.parametrize(
    "old, new, said",
    [
        (
            '    title = "Our gauge"\n',
            "",
            r"our_gauge.py:6: importer class Gauge: 'title' is missing",
        ),
        ("rank = 1", 'rank = "first"', r"our_gauge.py:12: importer class Gauge: rank = 'first'"),
        ("reads =", "raeds =", r"our_gauge.py:11: .*unknown attribute 'raeds'.*'reads'"),
        ("def recognises", "def recognizes", r"our_gauge.py:14: .*'recognizes'.*'recognises'"),
        (
            'name = "gauge"',
            'name = "laser"',
            "name = 'laser' is that of vmach.importers.kinds.laser",
        ),
        ("import Imported", "import Imporded", "our_gauge.py:3: .*cannot be loaded"),
    ],
)
@pytest.mark.usefixtures("fresh")
def test_an_importer_that_says_something_wrong(old, new, said, tmp_path, monkeypatch):
    assert old in SOUND
    plugged_in(tmp_path, monkeypatch, SOUND.replace(old, new, 1))
    with pytest.raises(InputError, match=said) as caught:
        catalogue()
    assert "entry point" in str(caught.value) or caught.value.line or "is that of" in said


def command(*words):
    return CliRunner().invoke(app, ["import", *map(str, words)])


@pytest.mark.parametrize(
    "words, said",
    [
        ([], "nothing to import"),
        (["--squareness", "XY 34"], "--squareness 'XY 34'; accepted: plane, size, unit"),
        (["--squareness", "XY 1.2.3 more"], "--squareness 'XY 1.2.3 more'"),
        (["--square", "XY 424.18 424.35 300", "--set", "u_mm=0"], "u_mm = 0; accepted: a standard"),
        (["--square", "XY 1 2"], "--square 'XY 1 2'; accepted: plane, diagonals AC and BD"),
        (["--square", ""], "--square ''"),
        (["--set", "error", "x.csv"], "--set 'error'; accepted: --set NAME=VALUE"),
        (["--kind", "laserr", "x.csv"], "--kind laserr; accepted: controller_tables"),
        (["nowhere.csv"], "nowhere.csv: file to import not found"),
        (["x.csv", "--into", "nowhere.toml"], "nowhere.toml: --into: no such file"),
        (["odd.bin"], "odd.bin:1: no importer knows this file"),
        (["."], "no importer knows this file"),
    ],
)
def test_what_was_typed_wrong_is_said(words, said, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "x.csv").write_text(LASER)
    (tmp_path / "odd.bin").write_bytes(b"\x00\x01\x02")
    run = command(*words)
    assert run.exit_code == 1 and isinstance(run.exception, InputError)
    assert said in str(run.exception)


@pytest.mark.parametrize("value", ["-inf", "", "0x"])
def test_a_table_of_a_control_out_of_form_is_told_in_plain_words(value, tmp_path):
    sample = next(s for s in SAMPLES if s.file == "joints.ini")
    path = sample.write(tmp_path, f"[JOINT_0]\nCOMP_FILE = x.comp\nCOMP_FILE_TYPE = {value}\n")
    run = command(path, "--yes")
    assert isinstance(run.exception, InputError)
    assert f"joints.ini:3: COMP_FILE_TYPE is '{value}'" in str(run.exception)


def test_lines_to_paste_are_printed_where_no_file_is_named(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "EYX.csv").write_text(LASER)
    run = command("EYX.csv", "--yes", "--square", "XY 140.4 142.8 99.8")
    assert run.exit_code == 0, run.exception
    assert "lines for machine.toml" in run.output
    assert '[errors.EYX]\ntable = "errors/EYX.csv"' in run.output
    assert (
        "EC0Y = 16950.7" in run.output
    )  # 0.0169507 of the firmware's formula, as an angle above 90
    assert (tmp_path / "errors" / "EYX.csv").is_file()


@pytest.mark.parametrize("is_known", [False, True])
def test_lines_to_paste_name_files_that_are_there(tmp_path, monkeypatch, is_known):
    """As seen from the job and its machine file, or from where the command is typed."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "jobs").mkdir()
    job = write_plate_job(tmp_path / "jobs")
    (tmp_path / "EYX.csv").write_text(LASER)
    (tmp_path / "p.txt").write_text(PROBE_LOG)
    words = ["EYX.csv", "--yes", "-o", "jobs/out"]
    words += ["p.txt", "--set", "ball_mm=2", "--job", job.parent] if is_known else []
    run = command(*words)
    assert run.exit_code == 0, run.exception
    named = re.findall('(?:table|measured) = "(.*)"', run.output)
    assert len(named) == 1 + is_known
    place = job.parent if is_known else tmp_path
    assert all((place / name).is_file() and not Path(name).is_absolute() for name in named)


def test_lines_that_went_into_a_file_of_another_name_are_not_printed(tmp_path):
    machine = write_job(tmp_path).with_name("machine.toml").rename(tmp_path / "mill.toml")
    (tmp_path / "EYX.csv").write_text(LASER)
    run = command(tmp_path / "EYX.csv", "--yes", "--into", machine)
    assert run.exit_code == 0, run.exception
    assert "lines for" not in run.output


def test_corrections_instead_of_errors_are_told(tmp_path):
    one = imported(tmp_path, "x.csv", LASER, error="EXX", deviation="target-measured")
    assert rows(one.files["errors/EXX.csv"])[3] == ["-100", "-3.2", "-2.2"]
    with pytest.raises(InputError, match="deviation = 'both'; accepted: measured-target"):
        imported(tmp_path, "x.csv", LASER, error="EXX", deviation="both")


def test_faults_of_a_file_that_gets_nothing_do_not_matter(tmp_path):
    job = write_job(tmp_path)
    job.write_text("nonsense = 1\n")
    one = imported(tmp_path, "x.csv", LASER, error="EXX")
    written = write_imported([one], Target(tmp_path, (job.with_name("machine.toml"), job)))
    assert [path.name for path in written] == ["EXX.csv", "machine.toml"]


def test_a_machine_file_with_faults_is_not_edited(tmp_path):
    machine = write_job(tmp_path).with_name("machine.toml")
    machine.write_text(MACHINE.replace("rapid_mm_min", "rapid"))
    one = imported(tmp_path, "x.csv", LASER, error="EXX")
    with pytest.raises(InputError, match=r"has faults, the first: .*motion\.rapid"):
        write_imported([one], Target(tmp_path, (machine,)))
    assert not (tmp_path / "errors").exists() or not any((tmp_path / "errors").iterdir())


@pytest.mark.parametrize("unit", ["um", "mm"])
def test_a_unit_that_is_told_needs_no_kind(tmp_path, unit):
    """The heading names none: the file is known by its columns all the same."""
    (tmp_path / "x.csv").write_text("position_mm,forward_1,backward_1\n0,0,0.1\n100,0.5,0.4\n")
    words = ["import", str(tmp_path / "x.csv"), "--error", "EXX", "-o", str(tmp_path), "--yes"]
    refused = CliRunner().invoke(app, words)
    assert refused.exit_code == 1 and "'forward_1' names no unit" in str(refused.exception)
    made = CliRunner().invoke(app, [*words, "--set", f"unit={unit}"], catch_exceptions=False)
    assert made.exit_code == 0, made.output
    size = {"um": 1.0, "mm": 1000.0}[unit]
    table = read_error_table(tmp_path / "errors" / "EXX.csv", MM_PER, "um")
    assert table.forward == pytest.approx([0.0, 0.5e-3 * size])


def test_a_report_without_normals_takes_them_from_the_cad(tmp_path):
    """Points on top and side of a block: the normals are those of its planes."""
    trimesh.creation.box((40.0, 30.0, 10.0)).export(tmp_path / "part.stl")
    job = write_job(tmp_path)
    job.write_text(job.read_text().replace("measured =", 'nominal = "part.stl"\nmeasured =', 1))
    rows = "id;nominal x;nominal y;nominal z;measured x;measured y;measured z\n"
    good = rows + "1;1,5;2;5;1,5;2;5,004\n2;20;3;1;20,003;3;1\n"
    report = tmp_path / "report.csv"
    report.write_text(good)
    (found,) = import_files([report], Questions(job_file=job))
    (text,) = found.files.values()
    assert [row.split(",")[5:8] for row in text.splitlines()[1:]] == [
        ["0", "0", "1"], ["1", "0", "0"]]  # fmt: skip
    report.write_text(good + "3;200;3;1;200;3;1\n")
    with pytest.raises(InputError, match=r"1 of 3 nominal points are more than 0\.1 mm") as caught:
        import_files([report], Questions(job_file=job))
    assert caught.value.line == 4
    with pytest.raises(InputError, match="need the CAD"):
        import_files([report], Questions())


def test_answers_that_nobody_gave_are_said_and_marked(tmp_path):
    machine = write_job(tmp_path).with_name("machine.toml")
    (tmp_path / "X.csv").write_text(LASER)
    run = command(tmp_path / "X.csv", "--error", "EXX", "--into", machine, "--yes")
    assert (
        "assumed, as nobody has said it: deviation=measured-target, counts=up, zero=0 (--set"
        in (run.output)
    )
    assert "EXX: measured_at_mm, where the reflector stood, is not said" in run.output
    said = "# mend: nobody has said counts=up, zero=0, deviation=measured-target"
    assert f'table = "errors/EXX.csv"  {said}\n' in machine.read_text()


def test_answers_that_were_given_are_no_assumptions(tmp_path):
    machine = write_job(tmp_path).with_name("machine.toml")
    (tmp_path / "X.csv").write_text(LASER)
    answers = ("counts=up", "zero=0", "deviation=measured-target", "measured_at=-300 -200 -250")
    given = [word for answer in answers for word in ("--set", answer)]
    run = command(tmp_path / "X.csv", "--error", "EXX", "--into", machine, "--yes", *given)
    assert run.exit_code == 0, run.exception
    assert "assumed" not in run.output and "is not said" not in run.output
    assert "# mend" not in machine.read_text()
    assert "measured_at_mm = [-300, -200, -250]" in machine.read_text()


@pytest.mark.parametrize("answer, is_there", [("-300 -200 -250", True), ("unknown", False)])
def test_the_place_of_the_reflector_is_asked(answer, is_there, tmp_path):
    (tmp_path / "x.csv").write_text(LASER)
    asked = []

    def ask(question, default):
        asked.append(question)
        return answer if "reflector" in question else default

    questions = Questions({"error": "EXX"}, ask)
    (one,) = import_files([tmp_path / "x.csv"], questions)
    assert sum("where did the reflector stand" in text for text in asked) == 1
    assert ("measured_at_mm" in one.sections[0].values) is is_there
    assert any("is not said" in text for text in one.told) is not is_there
    (tmp_path / "b.csv").write_text(LASER.replace("(µm)", "(arcsec)"))
    import_files([tmp_path / "b.csv"], Questions({"error": "EBX"}, ask))
    assert sum("where did the reflector stand" in text for text in asked) == 1


def test_a_square_by_callipers_is_as_sure_as_the_page_says(tmp_path, monkeypatch):
    """u / a for a square; a rectangle by differences of the formula itself."""
    monkeypatch.chdir(tmp_path)
    page = (Path(__file__).parents[2] / "docs" / "how-to" / "signs-and-zeros.md").read_text()
    run = command("--square", "XY 424.18 424.35 300", "--yes")
    said = run.output.partition("\n\n")[0]
    assert said.count("--square") == 3 and said in page
    finer = command("--square", "XY 424.18 424.35 300", "--yes", "--set", "u_mm=0.005")
    assert "standard uncertainty 17 urad" in finer.output
    lengths, step_mm = (250.0, 250.1, 200.0), 1e-3
    slopes = [
        (skew_of_square(*(v + step_mm * (i == k) for i, v in enumerate(lengths)))
         - skew_of_square(*lengths)) / step_mm
        for k in range(2)
    ]  # fmt: skip
    assert skew_u(*lengths, u_mm=0.02) == pytest.approx(0.02 * np.hypot(*slopes), rel=1e-3)


def test_what_exchanged_diagonals_of_a_square_would_make_is_said():
    """A parallelogram of 300 mm and 200 mm that encloses 90 degrees less 2 mrad, and its mirror."""
    ac, bd = (np.hypot(300 + side * 200 * np.sin(2e-3), 200 * np.cos(2e-3)) for side in (1, -1))
    for first, second, is_, would_be in ((ac, bd, "less", "more"), (bd, ac, "more", "less")):
        said = command("--square", f"ZX {first} {second} 300", "--yes").output
        assert f"+Z and +X enclose {is_} than 90 degrees by 2000 um/m" in said
        assert "is taken to go up along both Z and X; with AC and BD exchanged the angle is" in said
        assert f"exchanged the angle is {would_be} than 90 degrees by as much" in said


def test_imported_tables_hold_no_negative_zero(tmp_path, monkeypatch):
    """Entries of zero, whose correction is minus zero, and a place of minus zero."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "x.comp").write_text("-100 0 0.001\n-0 0 -0.002\n")
    (tmp_path / "joints.ini").write_text("[JOINT_0]\nCOMP_FILE = x.comp\nCOMP_FILE_TYPE = 1\n")
    run = command("joints.ini", "--yes")
    assert run.exit_code == 0, run.exception
    rows = (tmp_path / "errors" / "EXX.csv").read_text().splitlines()
    assert rows[1:] == ["-100,0,-1", "0,0,2"]


def test_a_square_that_leans_too_much_is_asked_about():
    assert "is a length misread?" in command("--square", "XY 140.4 142.8 99.8", "--yes").output
    assert "misread" not in command("--square", "XY 424.18 424.35 300", "--yes").output


def test_the_line_ends_of_an_edited_file_and_its_first_state_stay(tmp_path):
    machine = write_job(tmp_path).with_name("machine.toml")
    first = b"\xef\xbb\xbf" + machine.read_bytes().replace(b"\n", b"\r\n")
    machine.write_bytes(first)
    for error in ("EXX", "EYY"):
        one = imported(tmp_path, f"{error}.csv", LASER, error=error, zero="-5")
        write_imported([one], Target(tmp_path, (machine,)))
    assert machine.with_name("machine.toml.bak").read_bytes() == first
    assert b"errors.EXX" in machine.with_name("machine.toml.2.bak").read_bytes()
    after = machine.read_bytes()
    assert after.startswith(first[:40]) and after.count(b"\n") == after.count(b"\r\n")
    assert b"[errors.EYY]" in after


def test_an_inline_table_cannot_grow_and_is_told_with_its_line(tmp_path):
    machine = write_job(tmp_path).with_name("machine.toml")
    (tmp_path / "e.csv").write_text("position_mm,forward,backward\n-400,0,0\n0,0,0\n")
    machine.write_text('errors = {ECX = {table = "e.csv"}}\n' + machine.read_text())
    before = machine.read_text()
    one = imported(tmp_path, "x.csv", LASER, error="EXX", zero="-5")
    with pytest.raises(InputError, match=r"machine\.toml:1: 'errors' is written in one line"):
        write_imported([one], Target(tmp_path, (machine,)))
    assert machine.read_text() == before


def test_a_file_that_is_none_to_edit_is_refused(tmp_path):
    points = write_job(tmp_path).with_name("points.csv")
    one = imported(tmp_path, "x.csv", LASER, error="EXX", zero="-5")
    with pytest.raises(InputError, match=r"points\.csv: --into: is neither"):
        write_imported([one], Target(tmp_path, (points,)))


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({"foo": "bar"}, "--column foo=bar: no file has a column of this name; accepted: "),
        ({"position": "no such heading"}, "no importer|columns such as"),
    ],
)
def test_a_column_that_nothing_asks_for_is_refused(tmp_path, columns, message):
    (tmp_path / "x.csv").write_text(LASER)
    questions = Questions({"error": "EXX", "zero": "-5"}, columns=columns)
    with pytest.raises(InputError, match=message):
        import_files([tmp_path / "x.csv"], questions)
