"""Time, memory and growth of the exact engine on wavy finishing rasters, beside brute force.

Run as ``python tests/benchmarks/bench_edge.py [moves ...]``. The surface is a wave on which a
raster of short lines is milled with a displaced tool. The peer is brute force over all moves,
compiled too, on few points: it finds the nearest ball centre line to each point, the least
that any program without a tree has to do.
"""

from __future__ import annotations

import resource
import sys
import time

import numpy as np
from numba import njit

from stock import EdgeStatus, Sweeps, find_edges, make_tool

POINTS = 100_000
TOOLS = {
    "ball": make_tool("ball", diameter_mm=6.0, length_mm=30.0),
    "bull": make_tool("bull", diameter_mm=6.0, length_mm=30.0, corner_radius_mm=1.0),
    "flat": make_tool("flat", diameter_mm=6.0, length_mm=30.0),
}
SIZE_MM = (200.0, 100.0)


def wave(x, y):
    """Height of the surface and its outward normal."""
    a, b = 2 * np.pi / 60.0, 2 * np.pi / 45.0
    z = 1.5 * np.sin(a * x) * np.cos(b * y)
    normal = np.stack(
        [
            -1.5 * a * np.cos(a * x) * np.cos(b * y),
            1.5 * b * np.sin(a * x) * np.sin(b * y),
            np.ones_like(x),
        ],
        axis=-1,
    )
    return z, normal / np.linalg.norm(normal, axis=-1, keepdims=True)


def offset_tip(x, y, tool):
    """Tip of the tool that touches the wave at x, y."""
    z, normal = wave(x, y)
    rounding = tool.corners[0].radius_mm
    flat = tool.corners[0].r_mm
    level = np.hypot(normal[..., 0], normal[..., 1])[..., None]
    side = np.concatenate(
        [normal[..., :2] / np.maximum(level, 1e-12), np.zeros_like(level)], axis=-1
    )
    centre = np.stack([x, y, z], axis=-1) + rounding * normal + flat * side
    return centre - np.array([0.0, 0.0, rounding])


def raster(moves, tool):
    """About `moves` short lines, three times as long as wide, with a smooth displacement."""
    width, height = SIZE_MM
    step = np.sqrt(width * height / (3.0 * moves))
    rows, columns = round(height / step), round(width / (3.0 * step))
    y = np.linspace(0.0, height, rows)
    x = np.linspace(0.0, width, columns + 1)
    grid_x, grid_y = np.meshgrid(x, y)
    grid_x[1::2] = grid_x[1::2, ::-1]
    tips = offset_tip(grid_x, grid_y, tool)
    start, end = tips[:, :-1].reshape(-1, 3), tips[:, 1:].reshape(-1, 3)
    count = len(start)
    ends = np.stack([start, end], axis=1)
    waves = np.array([[0.11, 0.07, 0.13], [0.05, 0.12, 0.09], [0.0, 0.0, 0.0]])  # rad/mm
    phase = ends @ waves
    way = (end - start) @ waves
    zeros, pairs = np.zeros((count, 3)), np.zeros((count, 2, 3))
    return Sweeps(
        start_mm=start,
        end_mm=end,
        centre_mm=zeros,
        axis=zeros,
        sweep_rad=np.zeros(count),
        tool=np.zeros(count),
        move=np.arange(count),
        shift_mm=0.01 * np.sin(phase),
        shift_slope_mm=0.01 * np.cos(phase) * way[:, None, :],
        tilt_rad=pairs,
        tilt_slope_rad=pairs,
    )


def inspected(count, seed=1):
    """Points of the wave, away from its border, with normals."""
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(5.0, SIZE_MM[0] - 5.0, count), rng.uniform(5.0, SIZE_MM[1] - 5.0, count)
    z, normal = wave(x, y)
    return np.stack([x, y, z], axis=-1), normal


@njit(cache=True)
def nearest_lines(points, start, end):
    """Least distance from each point to any of the lines, over all of them."""
    found = np.empty(len(points))
    for i in range(len(points)):
        best = np.inf
        for k in range(len(start)):
            square, along, length = 0.0, 0.0, 0.0
            for j in range(3):
                v, w = end[k, j] - start[k, j], points[i, j] - start[k, j]
                along += v * w
                length += v * v
                square += w * w
            t = min(max(along / length, 0.0), 1.0)
            best = min(best, square - 2.0 * t * along + t * t * length)
        found[i] = np.sqrt(best)
    return found


def measure(name, moves, points, normals):
    """Seconds and processor seconds for all points, tree included; lines, points cut, sweeps."""
    sweeps = raster(moves, TOOLS[name])
    began, worked = time.perf_counter(), time.process_time()
    edges = find_edges(points, normals, sweeps=sweeps, tools=[TOOLS[name]], blank_mm=None)
    seconds, busy = time.perf_counter() - began, time.process_time() - worked
    return seconds, busy, np.count_nonzero(edges.status == EdgeStatus.CUT), sweeps


def main():
    sizes = [int(a) for a in sys.argv[1:]] or [1_000, 10_000, 100_000, 1_000_000]
    points, normals = inspected(POINTS)
    for name in TOOLS:  # compile
        sweeps = measure(name, 100, points[:1000], normals[:1000])[-1]
    nearest_lines(points[:1], sweeps.start_mm, sweeps.end_mm)
    print(f"{POINTS} points, tree included; peer: brute force on 100 points, scaled up")
    print("busy s: processor seconds of all cores; growth: exponent of busy s in the moves")
    print("tool      moves   seconds   busy s  points/busy s  growth  brute force s  peak MB")
    for name in TOOLS:
        last = None
        for moves in sizes:
            seconds, busy, _, sweeps = measure(name, moves, points, normals)
            count = len(sweeps)
            began = time.process_time()
            nearest_lines(points[:100], sweeps.start_mm, sweeps.end_mm)
            peer = (time.process_time() - began) * POINTS / 100
            growth = np.log(busy / last[0]) / np.log(count / last[1]) if last else np.nan
            peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
            print(
                f"{name:5} {count:9d} {seconds:9.3f} {busy:8.3f} {POINTS / busy:14.0f}"
                f" {growth:7.2f} {peer:14.1f} {peak:8.0f}",
                flush=True,
            )
            last = busy, count
    for share in (10, 1):
        count = POINTS // share
        busy = measure("ball", sizes[-1], points[:count], normals[:count])[1]
        print(f"ball, {sizes[-1]} moves, {count} points: {busy:.3f} busy s")


if __name__ == "__main__":
    main()
