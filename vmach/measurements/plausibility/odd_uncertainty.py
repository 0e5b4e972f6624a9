"""Rows whose standard uncertainty is far from that of the other rows of their file.

A row with a tenth of the uncertainty weighs as much as a hundred others: the alignment of a part
may rest on it, and an effect may be told for its noise.

Source: closed form derived here: readings weigh by the inverse of their variance.
"""

from __future__ import annotations

import numpy as np

from vmach.base.note import Kind, Level, Note

__all__ = ["odd_uncertainty_notes"]

#: times by which the uncertainty of a row may differ from the median; chosen: features, depths and
#: styli of one part differ by less
_OTHERWISE = 10.0


def odd_uncertainty_notes(u_um: np.ndarray, lines: np.ndarray | None) -> tuple[Note, ...]:
    """A doubt about rows far below the median uncertainty, and one about those far above.

    Parameters
    ----------
    u_um : (P,) float64
        Standard uncertainty of each row, um.
    lines : (P,) int or None
        Line of each in its file.
    """
    usual = float(np.median(u_um))
    low, high = usual / _OTHERWISE, usual * _OTHERWISE
    found = []
    for odd, worst in ((u_um < low, np.argmin(u_um)), (u_um > high, np.argmax(u_um))):
        if not odd.any():
            continue
        value, count = float(u_um[worst]), int(np.count_nonzero(odd))
        said = f"u_um is {value:g} um where the median is {usual:g} um"
        said += f", the worst of {count} rows" if count > 1 else ""
        weighs = max(usual / value, value / usual) ** 2
        then = f"This row weighs as much as {weighs:.3g} others"
        if value > usual:
            then = f"{weighs:.3g} such rows weigh as much as one other"
        found.append(
            Note(
                Level.DOUBT,
                Kind.UNCERTAINTY,
                "",
                said,
                value,
                "um",
                accepted=f"{low:g} .. {high:g} um in this file",
                hint=f"is it in um? {then}",
                place="u_um",
                line=None if lines is None else int(lines[worst]),
            )
        )
    return tuple(found)
