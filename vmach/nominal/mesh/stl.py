"""STL files: binary or ASCII triangles to vertices and indices.

Source: 3D Systems, StereoLithography Interface Specification.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from vmach.errors import InputError
from vmach.files.text_file import read_bytes

__all__ = ["read_stl"]

_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_HEADER_BYTES = 84
#: characters of a line that a message shows
_SHOWN = 40


def read_stl(path: Path) -> np.ndarray:
    """Corners of the triangles of an STL file, (T, 3, 3) float64, in the file's unit.

    The normals in the file are ignored: the order of the corners says what is outside.

    Raises
    ------
    InputError
        The file cannot be read, is cut short, holds no triangle or a coordinate that is not a
        finite number.
    """
    data = read_bytes(path, what="nominal CAD")
    corners = _ascii(path, data) if _is_ascii(data) else _binary(path, data)
    if not len(corners):
        raise InputError("no triangle in the file", file=path, accepted="an STL file of a solid")
    bad = ~np.isfinite(corners).all(axis=(1, 2))
    if bad.any():
        raise InputError(
            f"{int(bad.sum())} triangles have coordinates that are not finite, "
            f"the first is triangle {int(np.argmax(bad)) + 1}",
            file=path,
        )
    return corners


def _is_ascii(data: bytes) -> bool:
    """ASCII begins with ``solid``; but so do some binary files, whose length gives them away."""
    if not data[:512].lstrip().lower().startswith(b"solid"):
        return False
    return len(data) < _HEADER_BYTES or len(data) != _expected_length(data)


def _expected_length(data: bytes) -> int:
    return _HEADER_BYTES + _RECORD.itemsize * int(np.frombuffer(data, "<u4", 1, 80)[0])


def _binary(path: Path, data: bytes) -> np.ndarray:
    if len(data) < _HEADER_BYTES or len(data) < _expected_length(data):
        raise InputError(
            f"the file is cut short: {len(data)} bytes",
            file=path,
            accepted=f"{_expected_length(data)} bytes, as its header says"
            if len(data) >= _HEADER_BYTES
            else "binary or ASCII STL",
        )
    count = (_expected_length(data) - _HEADER_BYTES) // _RECORD.itemsize
    records = np.frombuffer(data, _RECORD, count, _HEADER_BYTES)
    with np.errstate(invalid="ignore"):  # what is no number is refused by the caller
        return records["corners"].astype(np.float64)


def _ascii(path: Path, data: bytes) -> np.ndarray:
    text = data.decode("ascii", errors="replace").lower()
    if "endsolid" not in text:
        last = text.rstrip().rpartition("\n")[2][:_SHOWN]
        raise InputError(
            f"the ASCII STL is cut short: it ends with {last!r}", file=path, accepted="endsolid"
        )
    lines = text.splitlines()
    numbered = [(n, line.split()) for n, line in enumerate(lines, 1) if "vertex" in line]
    vertices = np.empty((len(numbered), 3))
    for row, (line, words) in enumerate(numbered):
        try:
            vertices[row] = [float(word) for word in words[1:4]]
        except ValueError:
            raise InputError(
                f"vertex {' '.join(words[1:])!r}", file=path, line=line, accepted="three numbers"
            ) from None
    facets = sum(line.lstrip().startswith("facet") for line in lines)
    if len(vertices) != 3 * facets:
        raise InputError(f"{len(vertices)} vertices for {facets} facets", file=path)
    return vertices.reshape(-1, 3, 3)
