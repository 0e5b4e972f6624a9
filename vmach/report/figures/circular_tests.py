"""Circular tests for the terminal, summary.json and the page.

Source: ISO 230-4, presentation of results: plane, radius, feed, and the figures in um.
"""

from __future__ import annotations

from rich.table import Table
from rich.text import Text

from vmach.base.units import um_from_mm
from vmach.features.circular_test import CircularTest
from vmach.report.result import RunRecord

__all__ = ["FIGURES", "circular_exceeded", "circular_limits", "circular_summary", "circular_table",
           "circular_values", "circular_verdict"]  # fmt: skip

#: headings of the figures, in the order of `circular_values`
FIGURES = ("G ccw", "G cw", "G(b)", "D", "F")


def circular_values(test: CircularTest) -> list[str]:
    """The figures in um as text, in the order of `FIGURES`, with U = 2 u where it is known."""
    f = test.figures
    spread = {} if test.u is None else {n: um_from_mm(2.0 * u) for n, u in vars(test.u).items()}
    half = {name: f" ± {size:.2f}" for name, size in spread.items()}
    plain = [f"{um_from_mm(getattr(f, n)):.2f}{half.get(n, '')}" for n in ("G_ccw", "G_cw", "G_b")]
    low, high = um_from_mm(f.F_min), um_from_mm(f.F_max)
    ends = f"{low:+.2f}{half.get('F_min', '')} to {high:+.2f}{half.get('F_max', '')}"
    return [*plain, f"{um_from_mm(f.D):+.2f}{half.get('D', '')}", ends]


def circular_exceeded(test: CircularTest) -> list[str]:
    """Figures that are larger than accepted."""
    f, limits = test.figures, test.limits
    reached = {
        "G": (max(f.G_ccw, f.G_cw), limits.G),
        "G(b)": (f.G_b, limits.G_b),
        "D": (abs(f.D), limits.D),
        "F": (max(-f.F_min, f.F_max), limits.F),
    }
    return [name for name, (value, limit) in reached.items() if limit is not None and value > limit]


def circular_limits(test: CircularTest) -> str:
    """What is accepted, in words; empty where nothing is stated."""
    told = {"G": test.limits.G, "G(b)": test.limits.G_b, "|D|": test.limits.D, "|F|": test.limits.F}
    stated = [f"{name} {um_from_mm(x):g}" for name, x in told.items() if x is not None]
    return ", ".join(stated)


def circular_verdict(test: CircularTest) -> str:
    """``within``, or which figures are not; nothing where no limit is stated."""
    if not circular_limits(test):
        return ""
    return ", ".join(f"{name} too large" for name in circular_exceeded(test)) or "within"


def circular_table(run: RunRecord) -> Table | None:
    """A rich table, a row a pair of circles; None where there is none."""
    if not run.circular_tests:
        return None
    table = Table(title=Text("Circular tests, ISO 230-4, um"), title_justify="left",
                  caption_justify="left")  # fmt: skip
    accepted = circular_limits(run.circular_tests[0])
    said = "predicted ± U (k = 2)"
    table.caption = f"accepted: {accepted}; {said}" if accepted else said
    for heading in ("circle", *FIGURES, "limits"):
        table.add_column(heading, justify="left" if heading in ("circle", "limits") else "right")
    for test in run.circular_tests:
        circle = f"{test.plane} R{test.radius_mm:g}, {test.feed_mm_min:g} mm/min"
        table.add_row(circle, *circular_values(test), circular_verdict(test))
    return table


def circular_summary(run: RunRecord) -> list[dict]:
    """The value of ``circular_tests`` in summary.json."""
    return [
        {
            "plane": test.plane,
            "centre_mm": test.centre_mm.tolist(),
            "radius_mm": test.radius_mm,
            "feed_mm_min": test.feed_mm_min,
            "line_ccw": test.lines[0],
            "line_cw": test.lines[1],
            "G_ccw_um": um_from_mm(test.figures.G_ccw),
            "G_cw_um": um_from_mm(test.figures.G_cw),
            "G_b_um": um_from_mm(test.figures.G_b),
            "D_um": um_from_mm(test.figures.D),
            "F_min_um": um_from_mm(test.figures.F_min),
            "F_max_um": um_from_mm(test.figures.F_max),
            "u_um": test.u and {name: um_from_mm(u) for name, u in vars(test.u).items()},
            "too_large": circular_exceeded(test),
        }
        for test in run.circular_tests
    ]
