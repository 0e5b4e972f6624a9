"""HTM against Abbe: figures by hand, and the interval by theory."""

from __future__ import annotations

import numpy as np
import pytest

from vmach.report import Column, InspectedPoints, RunRecord, arms_text
from vmach.report.figures.arms import arms_summary, compare_arms

RUN = RunRecord(
    "job", "vmach compare", "abbe", 0.01, program_lines=tuple(f"G1 X{n}" for n in range(99))
)


def case(htm, abbe, *, left=None, status=None) -> InspectedPoints:
    """Points with two predictions, mm; `left` are measured minus predicted of both."""
    count = len(htm)
    status = np.full(count, "cut") if status is None else status
    left = left or (None, None)
    names = (("htm", "HTM", htm, left[0]), ("abbe", "Abbe", abbe, left[1]))
    columns = tuple(Column(n, label, v, status, r) for n, label, v, r in names)
    whole = np.arange(count)
    return InspectedPoints(
        id=whole.astype(str), feature=np.full(count, "wall"), point_mm=np.eye(3)[whole % 3] * 10,
        normal=np.eye(3)[whole % 3], line=whole % 50 + 1, tool=whole * 0 + 1, move=whole,
        time_s=whole * 1.0, columns=columns,
    )  # fmt: skip


def test_the_largest_difference_has_its_line():
    points = case(np.array([0.001, 0.020, 0.0]), np.array([0.001, 0.0037, 0.002]))
    told = arms_summary(points, RUN)
    assert told["largest_um"] == pytest.approx(16.3)
    assert told["rms_um"] == pytest.approx(np.sqrt((16.3**2 + 2.0**2) / 3))
    assert (told["line"], told["nc"], told["nearer"]) == (2, "G1 X1", None)
    assert arms_text(points, RUN)[0].startswith("HTM and Abbe differ by up to 16.3 um")


def test_points_that_one_did_not_cut_do_not_count():
    status = np.array(["cut", "uncut", "cut"])
    points = case(np.array([0.001, 9.0, 0.0]), np.zeros(3), status=status)
    assert compare_arms(points).largest_mm == pytest.approx(0.001)


def test_the_nearer_one_is_named_where_the_interval_is_clear_of_zero():
    rng = np.random.default_rng(4)
    small, large = rng.normal(0, 1e-3, 2000), rng.normal(0, 2e-3, 2000)
    for left, nearer in (((large, small), "abbe"), ((small, large), "htm")):
        assert compare_arms(case(large, small, left=left)).nearer == nearer
    same = rng.normal(0, 1e-3, (2, 2000))
    found = compare_arms(case(same[0], same[1], left=(same[0], same[1])))
    assert found.nearer == "cannot be told"
    assert "cannot be told" in arms_text(case(same[0], same[1], left=tuple(same)), RUN)[1]


def test_the_interval_is_as_wide_as_theory_says():
    """Of independent normal residuals the RMS has the standard deviation s / sqrt(2 n)."""
    left = np.random.default_rng(5).normal(0, [[2e-3], [1e-3]], (2, 5000))
    found = compare_arms(case(left[0], left[1], left=tuple(left)))
    theory = 2 * 1.96 * np.hypot(2e-3, 1e-3) / np.sqrt(2 * 5000)
    assert found.high_mm - found.low_mm == pytest.approx(theory, rel=0.15)
    assert found.low_mm < 1e-3 < found.high_mm


def test_one_prediction_alone_has_no_comparison():
    points = case(np.zeros(3), np.zeros(3))
    alone = InspectedPoints(**{**vars(points), "columns": points.columns[:1]})
    assert compare_arms(alone) is None and arms_text(alone, RUN) == []
