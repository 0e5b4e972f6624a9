"""The heights that a raster of `bench_commands` leaves, by OpenCAMLib and by the exact engine.

    python tests/benchmarks/peer_opencamlib.py FOLDER [--compare]

FOLDER holds ``part.nc`` and ``points.csv``. OpenCAMLib answers for a perfect machine, a ball and
straight moves; it reads no program, so the lines are picked out here. ``--compare`` says how far
both differ at the points, and what each took without reading.
"""

from __future__ import annotations

import argparse
import re
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from tests.opencamlib_heights import heights_left

DIAMETER_MM = 8.0
_FEED = re.compile(r"^G1 X(\S+) Y(\S+) Z(\S+)$", re.MULTILINE)


def by_engine(path_mm: np.ndarray, places_mm: np.ndarray) -> np.ndarray:
    """The same by vmach's engine; NaN where nothing is cut."""
    from stock import EdgeStatus, find_edges, make_tool
    from tests.oracle.stock_edge_cases import polyline

    points = np.column_stack([places_mm, np.full(len(places_mm), -3.0)])
    found = find_edges(
        points, np.tile([0.0, 0.0, 1.0], (len(points), 1)), sweeps=polyline(path_mm),
        tools=[make_tool("ball", diameter_mm=DIAMETER_MM, length_mm=100)],
        blank_mm=([-60, -60, -12], [60, 60, 0]), reach_mm=4.0,
    )  # fmt: skip
    height = points[:, 2] + found.deviation_mm
    return np.where(found.status == EdgeStatus.CUT, height, np.nan)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--compare", action="store_true")
    options = parser.parse_args()
    words = _FEED.findall((options.folder / "part.nc").read_text())
    path_mm = np.array(words, np.float64)
    points = options.folder / "points.csv"
    places_mm = np.loadtxt(points, delimiter=",", skiprows=1, usecols=(2, 3))
    begun = time.process_time()
    theirs = heights_left(path_mm, places_mm, DIAMETER_MM)
    print(f"OpenCAMLib: {time.process_time() - begun:.1f} s of the processor")
    if options.compare:
        by_engine(path_mm[:1000], places_mm[:1000])  # compiled before anything is timed
        begun = time.process_time()
        own = by_engine(path_mm, places_mm)
        print(f"vmach's engine: {time.process_time() - begun:.1f} s of the processor")
        known = np.isfinite(own) & np.isfinite(theirs)
        largest_mm = np.abs(own - theirs)[known].max()
        print(f"{known.sum()} of {len(own)} points, differ by {1e6 * largest_mm:.3g} nm at most")


if __name__ == "__main__":
    main()
