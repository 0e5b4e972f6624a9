"""Brute force for the engine: every sweep, dense in s, with textbook line-quadric formulas.

Nothing here is shared with the package: the tool is a union of cylinders, cones, spheres and
tori; the line meets each in an interval from its polynomial; the ends of the intervals are
minimised over s by zooming into a grid.
"""

import numpy as np

GRID = 161
ZOOMS = 9


def hermite(values, slopes, s):
    """Cubic Hermite curve (K, 3) from end values and end slopes (2, 3)."""
    s = s[:, None]
    return (
        (2 * s**3 - 3 * s**2 + 1) * values[0]
        + (3 * s**2 - 2 * s**3) * values[1]
        + (s**3 - 2 * s**2 + s) * slopes[0]
        + (s**3 - s**2) * slopes[1]
    )


def nominal_tip(sweeps, i, s):
    """Tip (K, 3) on the line or arc of sweep i at s."""
    start, end = sweeps.start_mm[i], sweeps.end_mm[i]
    if sweeps.sweep_rad[i] == 0:
        return start + s[:, None] * (end - start)
    axis, centre, angle = sweeps.axis[i], sweeps.centre_mm[i], sweeps.sweep_rad[i] * s
    rise = (end - start) @ axis
    radial = start - centre
    radius = np.linalg.norm(radial)
    grown = np.linalg.norm(end - centre - rise * axis)
    size = (radius + s * (grown - radius))[:, None] / radius
    turned = np.cos(angle)[:, None] * radial + np.sin(angle)[:, None] * np.cross(axis, radial)
    return centre + size * turned + (s * rise)[:, None] * axis


def line_in_tool_frame(sweeps, i, s, p, n):
    """Origin and direction (K, 3) of the line seen from the displaced tool."""
    tip = nominal_tip(sweeps, i, s) + hermite(sweeps.shift_mm[i], sweeps.shift_slope_mm[i], s)
    t = hermite(sweeps.tilt_rad[i], sweeps.tilt_slope_rad[i], s)
    frame = np.zeros((len(s), 3, 3))
    frame[:, [0, 1, 2], [0, 1, 2]] = 1.0
    frame[:, 2, 1], frame[:, 0, 2], frame[:, 1, 0] = t[:, 0], t[:, 1], t[:, 2]
    frame[:, 1, 2], frame[:, 2, 0], frame[:, 0, 1] = -t[:, 0], -t[:, 1], -t[:, 2]
    origin = np.linalg.solve(frame, (p - tip)[:, :, None])[:, :, 0]
    return origin, np.linalg.solve(frame, np.broadcast_to(n, origin.shape)[:, :, None])[:, :, 0]


def slab(o, d, z0, z1):
    """Interval of the line between two heights, empty as (inf, -inf)."""
    flat = np.abs(d[:, 2]) < 1e-300
    dz = np.where(flat, 1.0, d[:, 2])
    a, b = (z0 - o[:, 2]) / dz, (z1 - o[:, 2]) / dz
    inside = (z0 <= o[:, 2]) & (o[:, 2] <= z1)
    low = np.where(flat, np.where(inside, -np.inf, np.inf), np.minimum(a, b))
    return low, np.where(flat, np.where(inside, np.inf, -np.inf), np.maximum(a, b))


def roots(a, b, c):
    """Interval where a h^2 + 2 b h + c <= 0 with a > 0."""
    disc = b * b - a * c
    root = np.sqrt(np.maximum(disc, 0.0))
    miss = disc < 0
    return np.where(miss, np.inf, (-b - root) / a), np.where(miss, -np.inf, (-b + root) / a)


def cylinder(o, d, radius):
    a = d[:, 0] ** 2 + d[:, 1] ** 2
    b = o[:, 0] * d[:, 0] + o[:, 1] * d[:, 1]
    c = o[:, 0] ** 2 + o[:, 1] ** 2 - radius**2
    upright = a < 1e-24
    low, high = roots(np.where(upright, 1.0, a), b, c)
    low = np.where(upright, np.where(c <= 0, -np.inf, np.inf), low)
    return low, np.where(upright, np.where(c <= 0, np.inf, -np.inf), high)


def ball(o, d, z, radius):
    o = o - np.array([0, 0, z])
    return roots((d * d).sum(1), (o * d).sum(1), (o * o).sum(1) - radius**2)


def torus(o, d, big, z, small):
    """Hull of the line's points on a torus lying at height z: from the quartic's roots."""
    o = o - np.array([0, 0, z])
    dd, od, oo = (d * d).sum(1), (o * d).sum(1), (o * o).sum(1) + big**2 - small**2
    e, f, g = (d[:, :2] ** 2).sum(1), (o[:, :2] * d[:, :2]).sum(1), (o[:, :2] ** 2).sum(1)
    quartic = [
        dd**2,
        4 * dd * od,
        2 * dd * oo + 4 * od**2 - 4 * big**2 * e,
        4 * od * oo - 8 * big**2 * f,
        oo**2 - 4 * big**2 * g,
    ]
    companion = np.zeros((len(o), 4, 4))
    companion[:, [1, 2, 3], [0, 1, 2]] = 1.0
    for k in range(4):
        companion[:, 0, k] = -quartic[k + 1] / quartic[0]
    h = np.linalg.eigvals(companion)
    real = np.abs(h.imag) < 1e-5
    h = h.real
    for _ in range(4):  # polish
        x = o[:, None, :] + h[:, :, None] * d[:, None, :]
        rho = np.hypot(x[..., 0], x[..., 1])
        out = np.hypot(rho - big, x[..., 2])
        radial = (x[..., 0] * d[:, None, 0] + x[..., 1] * d[:, None, 1]) / rho
        slope = ((rho - big) * radial + x[..., 2] * d[:, None, 2]) / out
        h = h - np.where(real & (np.abs(slope) > 1e-9), (out - small) / slope, 0.0)
    return np.where(real, h, np.inf).min(1), np.where(real, h, -np.inf).max(1)


def cone(o, d, tip_z, slope):
    """Interval inside the upper nappe rho <= slope (z - tip_z), above the tip."""
    o = o - np.array([0, 0, tip_z])
    a = d[:, 0] ** 2 + d[:, 1] ** 2 - (slope * d[:, 2]) ** 2
    b = o[:, 0] * d[:, 0] + o[:, 1] * d[:, 1] - slope**2 * o[:, 2] * d[:, 2]
    c = o[:, 0] ** 2 + o[:, 1] ** 2 - (slope * o[:, 2]) ** 2
    disc = np.sqrt(np.maximum(b * b - a * c, 0.0))
    h1, h2 = (-b - disc) / a, (-b + disc) / a
    h1, h2 = np.minimum(h1, h2), np.maximum(h1, h2)
    z1, z2 = o[:, 2] + h1 * d[:, 2], o[:, 2] + h2 * d[:, 2]
    miss = b * b - a * c < 0
    low = np.where((a > 0) & (z1 >= 0), h1, np.inf)
    high = np.where((a > 0) & (z2 >= 0), h2, -np.inf)
    # steeper than the cone: a half line from the root on the upper nappe
    up = d[:, 2] > 0
    low = np.where(a < 0, np.where(up, np.where(z2 >= 0, h2, h1), -np.inf), low)
    high = np.where(a < 0, np.where(up, np.inf, np.where(z1 >= 0, h1, h2)), high)
    return np.where(miss & (a > 0), np.inf, low), np.where(miss & (a > 0), -np.inf, high)


def both(x, y):
    """Intersection of two families of intervals."""
    low, high = np.maximum(x[0], y[0]), np.minimum(x[1], y[1])
    empty = low > high
    return np.where(empty, np.inf, low), np.where(empty, -np.inf, high)


def hull(*parts):
    return np.min([p[0] for p in parts], axis=0), np.max([p[1] for p in parts], axis=0)


def tool_interval(tool, o, d):
    """Interval of each line in the tool: dict with the dimensions, not the package's Tool."""
    r, length = tool["diameter_mm"] / 2, tool["length_mm"]
    shape = tool["shape"]
    if shape == "flat":
        return both(cylinder(o, d, r), slab(o, d, 0.0, length))
    if shape == "ball":
        return hull(ball(o, d, r, r), both(cylinder(o, d, r), slab(o, d, r, length)))
    if shape == "bull":
        c = tool["corner_radius_mm"]
        return hull(
            both(cylinder(o, d, r - c), slab(o, d, 0.0, length)),
            both(cylinder(o, d, r), slab(o, d, c, length)),
            both(torus(o, d, r - c, c, c), slab(o, d, 0.0, length)),
        )
    tip = tool.get("tip_diameter_mm", 0.0) / 2
    slope = np.tan(np.radians(tool["angle_deg"]) / 2)
    shoulder = (r - tip) / slope
    return hull(
        both(cone(o, d, -tip / slope, slope), slab(o, d, 0.0, shoulder)),
        both(cylinder(o, d, r), slab(o, d, shoulder, length)),
    )


def intervals(sweeps, tools, i, s, p, n):
    """Intervals of the line in the tool standing at each s of sweep i."""
    return tool_interval(tools[sweeps.tool[i]], *line_in_tool_frame(sweeps, i, s, p, n))


def lowest(sweeps, tools, i, k, p, n):
    """Least beginning of the intervals of sweep i around grid value k."""
    step = 1.0 / (GRID - 1)
    centre, best = k * step, np.inf
    for _ in range(ZOOMS):
        s = np.clip(np.linspace(centre - step, centre + step, 41), 0.0, 1.0)
        low, _ = intervals(sweeps, tools, i, s, p, n)
        centre, best = s[np.argmin(low)], min(best, low.min())
        step /= 10.0
    return best


def pieces(sweeps, tools, i, p, n, reach):
    """What the line has in common with sweep i: one interval for each run of s that hits.

    The tool's interval moves continuously with s, so over a run its union has no gap.
    """
    low, high = intervals(sweeps, tools, i, np.linspace(0.0, 1.0, GRID), p, n)
    hits = np.flatnonzero(np.isfinite(low))
    for run in np.split(hits, np.flatnonzero(np.diff(hits) > 1) + 1):
        if len(run) and low[run].min() < reach + 0.3 and high[run].max() > -reach - 0.3:
            inside = np.where(np.isin(np.arange(GRID), run), low, np.inf)
            starts = local_minima(inside, inside.min() + 0.3)
            yield min(lowest(sweeps, tools, i, k, p, n) for k in starts), high[run].max()


def edge(sweeps, tools, p, n, reach):
    """(state, h) of one line: 0 cut, 1 uncut, 2 gouged."""
    found = [x for i in range(len(sweeps)) for x in pieces(sweeps, tools, i, p, n, reach)]
    if not any(low < 0 < high for low, high in found):
        h = min((low for low, _ in found if low > 0), default=np.inf)
        return (0, h) if h <= reach else (1, 0.0)
    h = 0.0
    while h > -reach:
        below = min((low for low, high in found if low < h <= high), default=h)
        if below == h:
            return 0, h
        h = below
    return 2, 0.0


def local_minima(values, below):
    """Indices of the local minima (ends included) at or below a bound."""
    padded = np.concatenate([[np.inf], values, [np.inf]])
    least = (padded[1:-1] <= padded[:-2]) & (padded[1:-1] <= padded[2:]) & np.isfinite(values)
    return np.flatnonzero(least & (values <= below))
