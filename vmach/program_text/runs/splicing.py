"""A text with many of its spans replaced, in one pass."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from stock.compiled import njit_inlined, njit_kernel

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
    edits, (others, blob) = _in_order(edits), _spans_of(changes)
    is_other, one = np.empty(len(edits.start) + len(changes), bool), (edits.start, edits.stop)
    overlap = _interleave(one, others[:2], is_other)
    if overlap >= 0:
        raise ValueError(f"replacements overlap at byte {overlap}")
    source, size = np.frombuffer(data, np.uint8), len(data)
    for start, stop, length in (*one, edits.length), others:
        size += int(length.sum()) - int(stop.sum() - start.sum())
    out = np.empty(size, np.uint8)
    _copy(source, is_other, ((*one, edits.length), edits.text), (others, blob), out)
    return out.tobytes()


def _in_order(edits: Edits) -> Edits:
    """The same along the text; a program's moves nearly always are."""
    if not (edits.start[1:] < edits.stop[:-1]).any():
        return edits
    order = np.lexsort((edits.stop, edits.start))
    return Edits(*(column[order] for column in vars(edits).values()))


def _spans_of(
    changes: Mapping[tuple[int, int], str],
) -> tuple[tuple[np.ndarray, np.ndarray, np.ndarray], np.ndarray]:
    """Starts, stops and lengths along the text, (C,) each, and all texts one behind the other."""
    found = sorted(changes.items(), key=lambda change: change[0])
    texts = [text.encode("latin-1") for _, text in found]
    spans = np.array([span for span, _ in found], np.int64).reshape(-1, 2)
    length = np.array([len(text) for text in texts], np.int64)
    columns = spans[:, 0].copy(), spans[:, 1].copy(), length
    return columns, np.frombuffer(b"".join(texts), np.uint8)


@njit_kernel()
def _interleave(one, other, is_other):
    """Which of two lists of spans has the next one; where two overlap, -1 for nowhere."""
    a, b, position = 0, 0, 0
    for k in range(len(is_other)):
        ahead = b < len(other[0]) and (
            a == len(one[0])
            or other[0][b] < one[0][a]
            or (other[0][b] == one[0][a] and other[1][b] < one[1][a])
        )
        is_other[k] = ahead
        start, stop = (other[0][b], other[1][b]) if ahead else (one[0][a], one[1][a])
        if start < position:
            return start
        position = stop
        if ahead:
            b += 1
        else:
            a += 1
    return -1


@njit_kernel()
def _copy(data, is_other, edits, others, out):
    """Write what is between the spans, and the texts, into `out`."""
    ((starts, stops, lengths), text), ((other_starts, other_stops, sizes), blob) = edits, others
    a, b, first, at, position = 0, 0, 0, 0, 0
    for ahead in is_other:
        at = _put(data, position, other_starts[b] if ahead else starts[a], out, at)
        if ahead:
            position = other_stops[b]
            at = _put(blob, first, first + sizes[b], out, at)
            first, b = first + sizes[b], b + 1
        else:
            position = stops[a]
            at = _put(text[a], 0, lengths[a], out, at)
            a += 1
    _put(data, position, len(data), out, at)


@njit_inlined()
def _put(text, begin, stop, out, at):
    """Write a part of a text into `out` from a place on; where it ends."""
    for byte in range(begin, stop):
        out[at] = text[byte]
        at += 1
    return at
