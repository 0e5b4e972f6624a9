"""Pp and Ppk of drawn parts against closed forms of distributions, and values of a drawing."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from scipy.stats import norm
from typer.testing import CliRunner

from tests.small_job import write_job
from vmach.cli import app
from vmach.errors import InputError
from vmach.run.pipeline import inspect_part
from vmach.schemas import SCHEMAS
from vmach.study.capability import performance
from vmach.study.study import read_study

#: plotting positions of a large sample that lies exactly on its distribution
PLACES = (np.arange(200_000) + 0.5) / 200_000


@pytest.mark.parametrize(("mean", "sigma"), [(20.0, 0.01), (20.012, 0.004)])
def test_a_normal_distribution_has_six_sigma(mean, sigma):
    """Pp = (U - L) / 6 sigma, Ppk = the nearer limit over 3 sigma (ISO 22514-2)."""
    lower, upper = 19.97, 20.03
    found = performance(mean + sigma * norm.ppf(PLACES), lower, upper)
    assert found.Pp == pytest.approx((upper - lower) / (6.0 * sigma), rel=1e-3)
    assert found.Ppk == pytest.approx(min(upper - mean, mean - lower) / (3.0 * sigma), rel=1e-3)


def test_a_skewed_distribution_by_its_quantiles():
    """Exponential with mean 1: the quantile of p is -ln(1 - p); a zone has an upper limit alone."""
    found = performance(-np.log1p(-PLACES), None, 4.0)
    middle, high = math.log(2.0), -math.log(0.00135)
    assert found.Pp is None
    assert found.Ppk == pytest.approx((4.0 - middle) / (high - middle), rel=1e-3)


def test_no_index_without_scatter_or_with_few_draws():
    few = performance(np.linspace(0.0, 1.0, 999), -1.0, 2.0)
    still = performance(np.full(2000, 0.5), -1.0, 2.0)
    assert (few.Pp, few.Ppk, still.Pp, still.Ppk) == (None, None, None, None)
    assert performance(np.linspace(0.0, 1.0, 1000), -1.0, 2.0).Pp > 0.0


def test_a_value_beyond_its_limit_has_a_negative_index():
    assert performance(norm.ppf(PLACES), -9.0, -3.0).Ppk == pytest.approx(-1.0, rel=1e-3)


DRAWING = """
[[features]]
name = "width"
faces = ["wall +X", "wall -X"]

[tolerances]
width = "40 ±0.01"
bore = "roundness 0.01"
"""
STUDY = 'schema = 1\n{draws}[cases]\njob = "job.toml"\npoints = "points.csv"\ndrawing = true\n'


@pytest.fixture(scope="module")
def job(tmp_path_factory):
    """X moves 100 ppm too far, read with u = 3 um."""
    errors = {"EXX": (lambda x: 0.1 * x, (0, 0, -100))}
    said = "\n[uncertainty]\nreading_um = 3.0\n"
    return write_job(tmp_path_factory.mktemp("job"), errors, squareness=said, more=DRAWING)


def batch(job, draws, out):
    path = job.parent / f"study_{draws}.toml"
    path.write_text(STUDY.format(draws=f"draws = {draws}\n" if draws else ""))
    words = ["batch", str(path), "--out", str(out), "--processes", "1"]
    result = CliRunner().invoke(app, [*words, "--json"])
    assert result.exit_code == 0, result.stderr
    return json.loads(result.stdout), CliRunner().invoke(app, words).stdout


def test_without_draws_the_values_are_those_of_a_run(job, tmp_path):
    told, _ = batch(job, 0, tmp_path / "out")
    assert told["performance"] == []
    (file,) = (tmp_path / "out" / "cases").iterdir()
    result = json.loads(file.read_text())["result"]
    found = {(r.feature, r.title): r.values["abbe"].value_mm for r in inspect_part(job).features}
    values = {(f, c): v for f, of in result["value_mm"].items() for c, v in of.items()}
    assert values == pytest.approx(found, abs=1e-12)
    assert len(result["deviation_um"]) == 69  # points of the file


def test_drawn_values_scatter_as_first_order_says(job, tmp_path):
    told, printed = batch(job, 150, tmp_path / "out")
    SCHEMAS["batch"].model_validate(told)
    rows = {(row["feature"], row["callout"]): row for row in told["performance"]}
    row = rows["width", "40 ±0.01, largest"]
    assert (row["lower_mm"], row["upper_mm"], row["draws"]) == (39.99, 40.01, 150)
    assert row["Pp"] is None and "Pp and Ppk need 1000 draws" in printed
    assert rows["bore", "roundness 0.01"]["lower_mm"] is None
    values = [json.loads(path.read_text())["result"]["value_mm"]["width"]["40 ±0.01, largest"]
              for path in (tmp_path / "out" / "cases").iterdir()]  # fmt: skip
    (known,) = (r.values["abbe"] for r in inspect_part(job).features if r.label == "largest")
    assert np.std(values, ddof=1) == pytest.approx(known.u_mm, rel=3.5 / math.sqrt(2 * 150))


def test_a_drawing_is_asked_of_jobs_that_have_one(tmp_path):
    write_job(tmp_path)
    (tmp_path / "study.toml").write_text(STUDY.format(draws=""))
    words = ["batch", str(tmp_path / "study.toml"), "--out", str(tmp_path / "out")]
    result = CliRunner().invoke(app, [*words, "--processes", "1"])
    assert result.exit_code == 1 and "the job asks for no feature" in result.stderr
    (tmp_path / "study.toml").write_text(STUDY.format(draws="").replace("true", '"yes"'))
    with pytest.raises(
        InputError, match=r"study.toml:5: .*drawing = 'yes'; accepted: true or false"
    ):
        read_study(tmp_path / "study.toml")
    (tmp_path / "drawn.csv").write_text("drawing\ntrue\n")
    (tmp_path / "study.toml").write_text('schema = 1\ntable = "drawn.csv"\ncases.job = "job.toml"')
    with pytest.raises(
        InputError, match=r"drawing = 'true'; .* in .cases.: a cell of a table is text"
    ):
        read_study(tmp_path / "study.toml")
