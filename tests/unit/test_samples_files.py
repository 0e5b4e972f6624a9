"""The samples as files: every job, machine and CAD model reads and fits together."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import numpy as np
import pytest

from vmach.base.note import Kind
from vmach.job import read_job
from vmach.machine import Variant, read_machine
from vmach.nominal import read_nominal
from vmach.path.preparation import prepare
from vmach.run.inspection import check_nominal_in_blank

SAMPLES = Path(__file__).resolve().parents[2] / "samples"
JOBS = [
    "iso10791_7/job.toml",
    "freecad_pocket/job.toml",
    "iso230_4/job.toml",
    "nas979/job.toml",
    "spline_slot/centre.toml",
    "spline_slot/corner.toml",
    "missing_effect/job.toml",
    "mazak_ajv25/toolpath1.toml",
    "mazak_ajv25/toolpath2.toml",
]


def test_no_job_is_forgotten():
    found = {
        path.relative_to(SAMPLES).as_posix()
        for path in SAMPLES.glob("*/*.toml")
        if not path.name.startswith("machine")
    }
    assert found == {*JOBS, "huddersfield/job.toml"}  # which makes no part


@pytest.mark.parametrize("name", JOBS)
def test_job_reads_and_its_parts_fit(name):
    job = read_job(SAMPLES / name)
    preparation = prepare(job)
    assert [note for note in preparation.notes if note.kind is not Kind.CONTROL] == []
    job.machine.check_covers(preparation.path.nodes.nose_mm)
    step, stl = read_nominal(job.nominal), read_nominal(job.nominal.with_suffix(".stl"))
    check_nominal_in_blank(job, step)
    assert np.allclose(step.bounds_mm, stl.bounds_mm, atol=1e-3)


@pytest.mark.parametrize("name", JOBS)
def test_every_linear_table_says_where_its_reflector_stood(name):
    machine = read_job(SAMPLES / name).machine
    straight = [error for error in machine.components.values() if not error.is_angle]
    assert len(straight) == 9
    assert all(error.measured_at_mm is not None for error in straight)


def test_measuring_points_of_the_mazak():
    points = read_machine(SAMPLES / "mazak_ajv25" / "machine.toml").measuring_points_mm()
    assert (points[:, 0] == [-800, -256, -478]).all()
    assert (points[:, 1] == [0, 0, -500]).all()
    assert (points[:, 2] == [0, 0, -130]).all()


def test_both_readings_of_the_mazak_squareness():
    meant = read_machine(SAMPLES / "mazak_ajv25" / "machine.toml").squareness_rad
    printed = read_machine(SAMPLES / "mazak_ajv25" / "machine_ea0z_as_printed.toml").squareness_rad
    assert 1e6 * meant[1, 0] == pytest.approx(-66.697)
    assert 1e6 * printed[1, 0] == pytest.approx(-13.757)
    for squareness in (meant, printed):
        assert 1e6 * squareness[0, 1:] == pytest.approx([-24.362, -14.569])
        assert (squareness[2] == 0).all()


def test_table_10_is_within_what_the_printed_sizes_allow():
    file = SAMPLES / "mazak_ajv25" / "table10.py"
    spec = importlib.util.spec_from_file_location("sample_table10", file)
    table10 = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(table10)
    for name, printed_um in table10.PRINTED_UM.items():
        nodes = prepare(read_job(SAMPLES / "mazak_ajv25" / f"{name}.toml")).path.nodes
        for machine_file in table10.MACHINES.values():
            machine = read_machine(SAMPLES / "mazak_ajv25" / machine_file)
            bound = table10.bound_um(machine, nodes, Variant.ABBE)
            assert (bound >= printed_um).all()
            assert (table10.largest_um(machine, nodes, Variant.ABBE) <= bound).all()
