"""Pictures of a run are drawn while the solid is being cut, where the CAD is what they show."""

import hashlib
from dataclasses import replace

import pytest

from tests.unit.test_run_solid_comparison import shoulder_job
from vmach.job import read_job
from vmach.machine import Variant
from vmach.run import pipeline
from vmach.run.part_pictures import PartPictures
from vmach.run.pipeline import machine_part
from vmach.run.results import write_results


@pytest.fixture(name="job")
def _job(tmp_path):
    return read_job(shoulder_job(tmp_path, 1.9))


def test_they_are_drawn_before_the_solid_is_waited_for(job, monkeypatch):
    order, pictures = [], PartPictures()
    own_part = pipeline.CutAside.part

    def part(self, progress=None):
        order.append("solid")
        return own_part(self, progress)

    def draw(found):
        order.append("pictures")
        pictures.draw(found)
        assert pictures.mesh is not None

    monkeypatch.setattr(pipeline.CutAside, "part", part)
    made = machine_part(job, variants=(Variant.ABBE,), meanwhile=draw)
    assert order == ["pictures", "solid"]
    assert list(made.stages_s).index("draw") < list(made.stages_s).index("cut")


def test_drawn_early_or_late_they_are_the_same(job, tmp_path):
    pictures = PartPictures()
    made = machine_part(job, variants=(Variant.ABBE,), meanwhile=pictures.draw)
    seen = []
    for name, drawn in {"early": pictures, "late": None}.items():
        write_results(made, tmp_path / name, command="vmach run", pictures=drawn)
        seen.append(hashlib.sha256((tmp_path / name / "heatmap.png").read_bytes()).digest())
    assert seen[0] == seen[1]


def test_a_part_without_cad_waits_for_its_solid(job):
    early, pictures = [], PartPictures()
    made = machine_part(job, variants=(Variant.ABBE,), meanwhile=early.append)
    pictures.draw(replace(early[0], nominal=None))
    assert pictures.mesh is None
    pictures.draw(replace(made, nominal=None))
    assert pictures.mesh is not None
