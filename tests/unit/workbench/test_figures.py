"""Figures are those of the reports; what has no sign, or was not measured, shows none."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest

from tests.small_job import pocket_points, write_job_with_nominal
from tests.unit.workbench.conftest import Page
from vmach.report import Column
from vmach.report.figures.statistics import column_statistics
from vmach.workbench.model.part_model import load_part
from vmach.workbench.model.quantities import figures_of

TOLERANCE_MM = 1e-3
VIEW = {"azimuth_rad": 0.3, "elevation_rad": 0.5, "zoom": 2, "target_mm": [1, 2, 3],
        "section": [0, 0, 0, 0], "range_um": 5}  # fmt: skip


def test_points_count_by_their_weight_as_in_the_reports(measured_folder):
    part = load_part(measured_folder / "job.toml")
    weight = np.random.default_rng(5).uniform(0.1, 1.0, len(part.surface))
    points, value = replace(part.surface, weight=weight), part.surface.predicted_mm
    column = Column("x", "x", value, np.full(len(value), "cut"), weight=weight)
    found = figures_of(points, value, TOLERANCE_MM)
    for one in [found, *found["features"]]:
        among = points.feature == one["name"] if "name" in one else None
        wanted = column_statistics(column, TOLERANCE_MM, among=among)
        assert one["count"] == wanted.count
        assert one["rms_um"] == pytest.approx(1e3 * wanted.rms_mm)
        assert one["mean_um"] == pytest.approx(1e3 * wanted.mean_mm)
        assert one["outside"] == pytest.approx(wanted.outside_share)


def test_an_uncertainty_has_no_sign_in_its_report(page):
    about = page.get("/api/about").json()
    assert [q["name"] for q in about["quantities"] if not q["is_signed"]] == ["uncertainty"]
    asked = {"shown": {"quantity": "uncertainty"}, "tolerance_um": 3, "view": VIEW}
    text = page.get("/show/" + page.post("/api/report", asked).json()["page"]).text
    assert "material left" not in text and "Outside ±" not in text and "removed" not in text
    data = json.loads(re.search(r'id="page-data"[^>]*>(.*?)</script>', text, re.DOTALL)[1])
    assert data["variants"]["shown"]["is_signed"] is False
    figures = re.search(r'<dl class="figures".*?</dl>', text, re.DOTALL)[0]
    assert "+" not in figures
    asked["shown"] = {"quantity": "difference"}
    text = page.get("/show/" + page.post("/api/report", asked).json()["page"]).text
    assert "material left" in text and "Outside ±" in text


def test_nominal_points_alone_are_nothing_measured(tmp_path):
    job = write_job_with_nominal(tmp_path)
    names, points, normals = pocket_points()
    rows = [
        ",".join([str(k), names[k], *map(repr, row.tolist())])
        for k, row in enumerate(np.hstack([points, normals]))
    ]
    (tmp_path / "points.csv").write_text("\n".join(["id,feature,x,y,z,i,j,k", *rows]) + "\n")
    made = Page(job)
    with made.client:
        about = made.get("/api/about").json()
        assert not about["is_measured"] and not about["has_measured_part"]
        assert "residual" not in [q["name"] for q in about["quantities"]]
        assert made.get("/api/measured").json() == {"readings": 0}
        change = {"effect": "backlash", "target": "Y", "parameters": {"reversal_um": 3.0}}
        figures, _ = made.framed(made.post("/api/what-if", {"changes": [change], "shown": {}}))
        assert figures["residual_rms_um"] is None and figures["rms_um"] > 0
