"""Flags with leader lines on a picture: what the drawing asks for, and what was found there."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from vmach.features.result import FeatureResult, Place
from vmach.features.verdict import Verdict
from vmach.report.figures.features import flag_text, flagged
from vmach.report.pictures.camera import Camera
from vmach.report.pictures.rasterise import Visible

__all__ = ["draw_flags", "seen_place"]

#: edge of a flag by its verdict; the text says it too
_COLOURS = {
    Verdict.CONFORMS: "#2f7d4f",
    Verdict.FAILS: "#b3261e",
    Verdict.OPEN: "#9a6700",
}
#: a surface is seen where its normal points so much towards the viewer
_SEEN = 0.05
#: height of a flag as a share of the picture, and its distance from the sides
_PITCH, _SIDE = 0.085, 0.01


def draw_flags(
    panel: Axes,
    features: Sequence[FeatureResult],
    camera: Camera,
    visible: Visible,
    size: tuple[int, int],
) -> None:
    """Draw the flags of the features that are seen, on both sides of a picture of some pixels."""
    pairs = [(result, seen_place(result, camera, visible, size)) for result in flagged(features)]
    seen = [result for result, place in pairs if place is not None]
    if not seen:
        return
    places = camera.pixels(np.array([p.at_mm for _, p in pairs if p is not None]), size)
    for is_left in (True, False):
        side = [k for k in range(len(seen)) if (places[k, 0] < size[0] / 2) == is_left]
        side.sort(key=lambda k: places[k, 1])
        for height, k in zip(_heights(places[side, 1] / size[1]), side, strict=True):
            _draw(panel, seen[k], places[k, :2], (_SIDE if is_left else 1.0 - _SIDE, 1.0 - height))


def seen_place(
    result: FeatureResult, camera: Camera, visible: Visible, size: tuple[int, int]
) -> Place | None:
    """The first point of a feature that faces the viewer and that no other surface hides."""
    facing = [p for p in result.places if float(camera.axes[2] @ np.array(p.normal)) > _SEEN]
    if not facing:
        return None
    shown = visible.shows(camera.pixels(np.array([p.at_mm for p in facing]), size))
    return next((place for place, is_shown in zip(facing, shown, strict=True) if is_shown), None)


def _heights(wanted: np.ndarray) -> np.ndarray:
    """Heights of flags, (K,), from the top as shares, moved apart so that none covers another."""
    heights = np.array(wanted)
    for k in range(1, len(heights)):
        heights[k] = max(heights[k], heights[k - 1] + _PITCH)
    if len(heights):
        heights -= max(heights[-1] - (1.0 - _PITCH / 2.0), 0.0)
    return heights


def _draw(panel: Axes, result: FeatureResult, at: np.ndarray, place: tuple[float, float]) -> None:
    colour = _COLOURS[(result.measured or result.predicted).verdict]
    panel.annotate(
        flag_text(result).replace("$", r"\$"),
        xy=tuple(at),
        xycoords="data",
        xytext=place,
        textcoords="axes fraction",
        ha="left" if place[0] < 0.5 else "right",
        va="center",
        size=7,
        color="#1d2125",
        bbox={"boxstyle": "round,pad=0.3", "fc": "white", "ec": colour, "lw": 1.2, "alpha": 0.92},
        arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 0.9, "shrinkA": 0, "shrinkB": 0},
    )
