"""The colours of a deviation, the same in every picture.

Blue (too much removed) over near-white to red (material left): the two ends differ in hue and in
no shade of red against green, so that the common colour-vision deficiencies keep them apart.
Lightness falls evenly to both ends, so a grey print still shows the size of a deviation.
"""

from __future__ import annotations

__all__ = ["COLOUR_STOPS", "UNKNOWN_COLOUR"]

#: sRGB at equal steps from -range to +range
COLOUR_STOPS = (
    "#0a2f6b", "#1a56a8", "#4a8bd0", "#9cc3e8", "#f4f2ee",
    "#f7c59f", "#e88a52", "#c24a1e", "#7a1a0c",
)  # fmt: skip

#: a vertex that no inspected point speaks for
UNKNOWN_COLOUR = "#9aa0a6"
