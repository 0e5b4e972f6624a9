"""Sweeps for the engine's tests, from positions and displacement functions."""

import numpy as np

from stock import Sweeps


def sweeps_of(start, end, *, arc=None, tool=0, shift=None, tilt=None):
    """Sweeps from ends; `arc` is (centre, axis, angle); shift and tilt are (values, slopes)."""
    start, end = np.atleast_2d(start).astype(float), np.atleast_2d(end).astype(float)
    count = len(start)
    none = (np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(count))
    centre, axis, angle = none if arc is None else arc
    still = (np.zeros((count, 2, 3)), np.zeros((count, 2, 3)))
    shift, tilt = shift or still, tilt or still
    return Sweeps(
        start_mm=start,
        end_mm=end,
        centre_mm=np.broadcast_to(centre, (count, 3)),
        axis=np.broadcast_to(axis, (count, 3)),
        sweep_rad=np.broadcast_to(angle, count),
        tool=np.broadcast_to(tool, count),
        move=np.arange(count),
        shift_mm=shift[0],
        shift_slope_mm=shift[1],
        tilt_rad=tilt[0],
        tilt_slope_rad=tilt[1],
    )


def joined(*parts):
    """One record from several."""
    names = parts[0].__dataclass_fields__
    return Sweeps(**{k: np.concatenate([getattr(part, k) for part in parts]) for k in names})


def polyline(corners, **more):
    """Straight sweeps from corner to corner."""
    corners = np.asarray(corners, dtype=float)
    return sweeps_of(corners[:-1], corners[1:], **more)


def circle(radius, pieces, *, rise=0.0, turns=1.0, growth=0.0, error=None):
    """A circle, helix or spiral about Z in pieces, with a displacement along the radius.

    `error` maps the angle to (displacement, its derivative by the angle), mm.
    """
    angle = np.linspace(0.0, 2 * np.pi * turns, pieces + 1)
    share = np.linspace(0.0, 1.0, pieces + 1)
    ring = np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=1)
    side = np.stack([-np.sin(angle), np.cos(angle), np.zeros_like(angle)], axis=1)
    nodes = (radius + growth * share)[:, None] * ring
    nodes[:, 2] = rise * share
    step = angle[1] - angle[0]
    shift = None
    if error is not None:
        value, slope = (x[:, None] for x in error(angle))
        moved, rate = value * ring, (slope * ring + value * side) * step
        shift = (
            np.stack([moved[:-1], moved[1:]], axis=1),
            np.stack([rate[:-1], rate[1:]], axis=1),
        )
    centre = np.zeros((pieces, 3))
    centre[:, 2] = nodes[:-1, 2]
    arc = (centre, np.array([0.0, 0.0, 1.0]), step)
    return sweeps_of(nodes[:-1], nodes[1:], arc=arc, shift=shift)
