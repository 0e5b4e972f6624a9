"""A text with many of its spans replaced, in one pass."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numba import njit

__all__ = ["Edits", "spliced"]


@dataclass(frozen=True)
class Edits:
    """Replacements of spans.

    Attributes
    ----------
    start, stop : (E,) int64
        Spans in bytes.
    text : (E, L) uint8
        What takes their place, from the left.
    length : (E,) int64
        How many bytes of it.
    """

    start: np.ndarray
    stop: np.ndarray
    text: np.ndarray
    length: np.ndarray


@njit(cache=True)
def _copied(data, order, start, stop, first, length, blob, out):  # pragma: no cover - compiled
    """Write the pieces of `data` between the spans and the texts into `out`."""
    at, position = 0, 0
    for k in order:
        for byte in range(position, start[k]):
            out[at] = data[byte]
            at += 1
        for byte in range(first[k], first[k] + length[k]):
            out[at] = blob[byte]
            at += 1
        position = stop[k]
    for byte in range(position, data.shape[0]):
        out[at] = data[byte]
        at += 1


def spliced(data: bytes, edits: Edits, changes: Mapping[tuple[int, int], str]) -> bytes:
    """The text with the spans of both replaced, everything else byte for byte.

    Parameters
    ----------
    data : bytes
    edits : Edits
    changes : mapping
        From a span (start, stop) in bytes to the text that takes its place, as
        `gcode.Source.rewritten` has them.

    Raises
    ------
    ValueError
        Two spans overlap.
    """
    edits, blob, first = _with_changes(edits, changes)
    start, stop = edits.start, edits.stop
    order = np.arange(len(start))
    if (start[1:] < stop[:-1]).any():
        order = np.lexsort((stop, start))
        over = np.flatnonzero(start[order][1:] < stop[order][:-1])
        if len(over):
            raise ValueError(f"replacements overlap at byte {start[order][over[0] + 1]}")
    source = np.frombuffer(data, np.uint8)
    added = int(edits.length.sum()) - int(stop.sum() - start.sum())
    out = np.empty(len(source) + added, np.uint8)
    _copied(source, order, start, stop, first, edits.length, blob, out)
    return out.tobytes()


def _with_changes(
    edits: Edits, changes: Mapping[tuple[int, int], str]
) -> tuple[Edits, np.ndarray, np.ndarray]:
    """Spans of both, all texts one after the other, and where that of every span begins."""
    blob = edits.text.reshape(-1)
    first = np.arange(len(edits.start)) * edits.text.shape[1]
    if not changes:  # the texts of a long program are not copied
        return edits, blob, first
    texts = [text.encode("latin-1") for text in changes.values()]
    spans = np.array(list(changes), np.int64)
    sizes = np.array([len(text) for text in texts], np.int64)
    both = Edits(
        np.concatenate([edits.start, spans[:, 0]]),
        np.concatenate([edits.stop, spans[:, 1]]),
        edits.text,
        np.concatenate([edits.length, sizes]),
    )
    places = len(blob) + np.cumsum(sizes) - sizes
    blob = np.concatenate([blob, np.frombuffer(b"".join(texts), np.uint8)])
    return both, blob, np.concatenate([first, places])
