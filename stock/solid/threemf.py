"""The 3MF file format: a zip archive with one model in XML, units and colours included."""

from __future__ import annotations

import io
import zipfile

import numpy as np

__all__ = ["threemf_bytes"]

_CONTENT_TYPES = """<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
</Types>
"""

_RELATIONSHIPS = """<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Id="model" Target="/3D/3dmodel.model"
 Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
</Relationships>
"""

_MODEL = """<?xml version="1.0" encoding="UTF-8"?>
<model unit="millimeter" xml:lang="en-US"
 xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
 xmlns:m="http://schemas.microsoft.com/3dmanufacturing/material/2015/02">
<resources>
{colours}<object id="1" type="model"><mesh><vertices>
{vertices}
</vertices><triangles>
{triangles}
</triangles></mesh></object>
</resources>
<build><item objectid="1"/></build>
</model>
"""

#: zip entries carry a date; a fixed one keeps equal parts equal byte for byte
_DATE = (1980, 1, 1, 0, 0, 0)


def threemf_bytes(
    vertices_mm: np.ndarray, triangles: np.ndarray, colours: np.ndarray | None
) -> bytes:
    """A 3MF file of one mesh.

    Source: 3MF Core Specification 1.3 and Materials and Properties Extension 1.2 (colour
    groups, one colour a corner).

    Parameters
    ----------
    vertices_mm : (V, 3) float64
    triangles : (T, 3) int64
    colours : (V, 4) uint8 or None
        Red, green, blue and opacity of each vertex.
    """
    group, corners = "", ""
    rows = triangles
    if colours is not None:
        palette, number = np.unique(colours, axis=0, return_inverse=True)
        entries = "".join(f'<m:color color="#{bytes(c).hex().upper()}"/>' for c in palette)
        group = f'<m:colorgroup id="2">{entries}</m:colorgroup>\n'
        corners = ' pid="2" p1="%d" p2="%d" p3="%d"'
        rows = np.hstack([triangles, number.reshape(-1)[triangles]])
    model = _MODEL.format(
        colours=group,
        vertices=_lines('<vertex x="%.9g" y="%.9g" z="%.9g"/>', vertices_mm),
        triangles=_lines(f'<triangle v1="%d" v2="%d" v3="%d"{corners}/>', rows),
    )
    files = {
        "[Content_Types].xml": _CONTENT_TYPES,
        "_rels/.rels": _RELATIONSHIPS,
        "3D/3dmodel.model": model,
    }
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as package:
        for name, text in files.items():
            entry = zipfile.ZipInfo(name, _DATE)
            entry.compress_type = zipfile.ZIP_DEFLATED
            package.writestr(entry, text)
    return archive.getvalue()


def _lines(template: str, rows: np.ndarray) -> str:
    return "\n".join(template % tuple(row) for row in rows.tolist())
