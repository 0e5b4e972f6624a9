"""STL, 3MF and glTF files of the virtual part."""

from __future__ import annotations

import struct
import zipfile
from xml.etree import ElementTree

import numpy as np
import pytest
import trimesh

from stock import StockError, cut_part, make_tool, write_part
from tests.stock_solid_cases import polyline

CORE = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
MATERIAL = "{http://schemas.microsoft.com/3dmanufacturing/material/2015/02}"


@pytest.fixture(scope="module")
def part():
    tool = make_tool("flat", diameter_mm=10.0, length_mm=30.0)
    path = [[0, 0, 5], [0, 0, -3], [20, 0, -3], [20, 20, -3.5]]
    return cut_part(polyline(path), [tool], ((-20.0, -20.0, -10.0), (40.0, 40.0, 0.0)))


@pytest.fixture(scope="module")
def colours(part):
    return np.random.default_rng(1).integers(0, 256, (len(part.vertices_mm), 4)).astype(np.uint8)


def test_stl(part, tmp_path):
    write_part(part, tmp_path / "part.STL")
    data = (tmp_path / "part.STL").read_bytes()
    assert struct.unpack("<I", data[80:84]) == (len(part.triangles),)
    assert len(data) == 84 + 50 * len(part.triangles)
    read = trimesh.load(tmp_path / "part.STL", file_type="stl")
    assert read.is_watertight
    assert read.volume == pytest.approx(part.volume_mm3, rel=1e-6)


def test_glb_is_in_metres_with_y_up(part, colours, tmp_path):
    write_part(part, tmp_path / "part.glb", colours=colours)
    read = trimesh.load(tmp_path / "part.glb", force="mesh", process=False)
    np.testing.assert_allclose(read.bounds, [[-0.02, -0.01, -0.04], [0.04, 0.0, 0.02]], atol=1e-8)
    assert read.volume == pytest.approx(part.volume_mm3 * 1e-9, rel=1e-5)
    assert np.array_equal(read.visual.vertex_colors, colours)


def test_3mf_keeps_micrometres_and_colours(part, colours, tmp_path):
    write_part(part, tmp_path / "part.3mf", colours=colours)
    with zipfile.ZipFile(tmp_path / "part.3mf") as package:
        assert {"[Content_Types].xml", "_rels/.rels"} < set(package.namelist())
        relations = ElementTree.fromstring(package.read("_rels/.rels"))
        model = ElementTree.fromstring(package.read(relations[0].get("Target")[1:]))
    assert model.get("unit") == "millimeter"
    vertices = [[float(v.get(k)) for k in "xyz"] for v in model.iter(f"{CORE}vertex")]
    rows = list(model.iter(f"{CORE}triangle"))
    triangles = [[int(t.get(k)) for k in ("v1", "v2", "v3")] for t in rows]
    np.testing.assert_allclose(vertices, part.vertices_mm, atol=5e-8)
    assert np.array_equal(triangles, part.triangles)
    palette = [c.get("color") for c in model.iter(f"{MATERIAL}color")]
    named = [[palette[int(t.get(k))] for k in ("p1", "p2", "p3")] for t in rows]
    expected = [["#" + bytes(colours[v]).hex().upper() for v in t] for t in part.triangles]
    assert named == expected


@pytest.mark.parametrize("suffix", [".stl", ".3mf", ".glb"])
def test_same_part_same_bytes(part, suffix, tmp_path):
    for name in ("a", "b"):
        write_part(part, tmp_path / (name + suffix))
    assert (tmp_path / ("a" + suffix)).read_bytes() == (tmp_path / ("b" + suffix)).read_bytes()


def test_unknown_suffix_and_wrong_colours(part, tmp_path):
    with pytest.raises(StockError, match=r"part\.obj.*accepted: \.stl, \.3mf, \.glb"):
        write_part(part, tmp_path / "part.obj")
    with pytest.raises(StockError, match=r"colours of shape \(3, 3\)"):
        write_part(part, tmp_path / "part.glb", colours=np.zeros((3, 3), np.uint8))
    with pytest.raises(StockError, match="type float64"):
        write_part(part, tmp_path / "part.glb", colours=np.zeros((len(part.vertices_mm), 3)))
    assert list(tmp_path.iterdir()) == []


def test_an_interrupt_leaves_the_old_file(part, tmp_path, monkeypatch):
    target = tmp_path / "part.stl"
    target.write_bytes(b"old")

    def interrupted(source, destination):
        raise KeyboardInterrupt

    monkeypatch.setattr("stock.solid.export.os.replace", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write_part(part, target)
    assert [path.name for path in tmp_path.iterdir()] == ["part.stl"]
    assert target.read_bytes() == b"old"
