"""report.html: one file, no network, within its size, and safe with any name in it."""

import base64
import gzip
import json
import struct
from dataclasses import replace

import numpy as np
import pytest

from tests.report_case import HOSTILE, block, large_mesh, points, run
from tests.report_page import Page, assert_asks_for_nothing
from vmach.report import (
    Column,
    InputFile,
    build_display_mesh,
    write_report_html,
)
from vmach.report.pictures.heatmap import draw_heatmap


def written(path, case, record, **options):
    mesh = options.pop("mesh", None) or build_display_mesh(*block(), case)
    write_report_html(path, mesh, case, record, **options)
    return path.read_text(encoding="utf-8")


def unpack(payload):
    """A reader of the payload written from the description of its layout."""
    raw = gzip.decompress(base64.b64decode(payload))
    (length,) = struct.unpack_from("<I", raw)
    header = json.loads(raw[4 : 4 + length])
    at, columns = 4 + length, {}
    for name, width, count in header["columns"]:
        planes = np.frombuffer(raw, np.uint8, width * count, at).reshape(width, count)
        steps = sum(planes[k].astype(np.int64) << (8 * k) for k in range(width))
        columns[name] = np.cumsum(steps) % (1 << (8 * width))
        at += width * count
    assert at == len(raw)
    return header, columns


def signed(column):
    return np.where(column >= 32768, column - 65536, column)


def test_page_asks_the_network_for_nothing(tmp_path):
    text = written(tmp_path / "r.html", points(), run())
    page = Page(text)
    assert_asks_for_nothing(page)


def test_sliders_have_names(tmp_path):
    """The first of a label's outputs and inputs has its name: the output, where none is told."""
    page = Page(written(tmp_path / "r.html", points(), run()))
    sliders = {a["id"] for tag, a in page.elements if a.get("type") == "range"}
    labels = {a.get("for") for tag, a in page.elements if tag == "label"}
    assert sliders == {"tolerance", "range"} and sliders <= labels


def test_names_cannot_break_out_of_the_page(tmp_path):
    record = run(
        title=HOSTILE, command=HOSTILE, warnings=[HOSTILE], facts={HOSTILE: HOSTILE},
        program_lines=[HOSTILE] * 50, versions={HOSTILE: HOSTILE},
        files=[InputFile(HOSTILE, HOSTILE, "0" * 64, 1)],
    )  # fmt: skip
    case = points(name=HOSTILE)
    relabelled = tuple(replace(v, label=HOSTILE) for v in case.columns)
    case = replace(case, columns=relabelled, id=[HOSTILE] * len(case))
    page = Page(written(tmp_path / "r.html", case, record))
    assert not any("onerror" in attributes for _, attributes in page.elements)
    assert [tag for tag, _ in page.elements].count("script") == 6
    assert page.text.count(HOSTILE) > 30
    assert "49" not in page.text.split("What was run")[1].split("Duration")[0]
    data = json.loads(page.scripts[0])
    assert data["variants"]["abbe"]["label"] == HOSTILE


def test_size_at_a_hundred_thousand_triangles(tmp_path):
    case = points(60_000)
    mesh = large_mesh(100_000, ("none", "abbe", "measured", "abbe_remainder"))
    assert len(mesh.triangles) > 99_000
    draw_heatmap(tmp_path / "h.png", mesh, case, run())
    write_report_html(tmp_path / "r.html", mesh, case, run(), stills=[tmp_path / "h.png"])
    assert (tmp_path / "r.html").stat().st_size < 4e6


def test_payload_carries_mesh_and_points_within_its_rounding(tmp_path):
    case = points()
    mesh = build_display_mesh(*block(), case)
    header, columns = unpack(Page(written(tmp_path / "r.html", case, run(), mesh=mesh)).scripts[1])
    place = np.stack([columns[f"vertex_{axis}"] for axis in "xyz"], axis=1)
    place = header["origin_mm"] + place * header["step_mm"]
    assert np.abs(place - mesh.vertices_mm).max() <= 0.51 * max(header["step_mm"])
    corners = np.stack([columns[f"corner_{i}"] for i in range(3)], axis=1)
    np.testing.assert_array_equal(corners, mesh.triangles)
    quantised = signed(columns["point:abbe"])
    cut = case["abbe"].is_cut
    np.testing.assert_array_equal(quantised == header["unknown"], ~cut)
    deviation_um = quantised[cut] * header["value_step_um"]
    largest_um = 1e3 * np.abs(case["measured"].deviation_mm).max()
    assert np.abs(deviation_um - 1e3 * case["abbe"].deviation_mm[cut]).max() < largest_um / 60_000
    status = [header["statuses"][i] for i in columns["status:abbe"]]
    assert status == case["abbe"].status.tolist()
    features = [header["features"][i] for i in columns["point_feature"]]
    assert features == case.feature.tolist()
    assert header["nc"]["7"] == "N7 G1 X7"


def test_slider_counts_agree_with_a_direct_count(tmp_path):
    case = points()
    data = json.loads(Page(written(tmp_path / "r.html", case, run())).scripts[0])
    assert data["thresholds_um"][data["tolerance_index"]] == pytest.approx(3.0)
    size_um = 1e3 * np.abs(case["measured"].deviation_mm)
    for threshold, outside in zip(
        data["thresholds_um"], data["variants"]["measured"]["outside"], strict=True
    ):
        assert outside in ((size_um > t).sum() for t in (threshold - 1e-9, threshold + 1e-9))


def test_figures_and_worst_points_are_in_the_text(tmp_path):
    case = points()
    text = Page(written(tmp_path / "r.html", case, run())).text
    largest = 1e3 * case["abbe"].deviation_mm[case["abbe"].is_cut].max()
    assert f"+{largest:.2f}" in text
    assert "positive: material left, negative: too much removed" in text
    worst = np.nanargmax(np.abs(case["abbe"].deviation_mm))
    assert case.id[worst] in text
    assert f"N{case.line[worst]} G1 X{case.line[worst]}" in text
    assert "ab" * 32 in text


@pytest.mark.parametrize("scale", [0.0, 1e-9, 1e6])
def test_any_size_of_deviation_makes_a_page(tmp_path, scale):
    case = points(50)
    column = Column("abbe", "a", scale * case["measured"].deviation_mm, np.full(50, "cut"))
    text = written(tmp_path / "r.html", replace(case, columns=(column,)), run())
    page = Page(text)
    numbers = [v for tag, a in page.elements if tag in {"rect", "line"} for v in a.values()]
    assert "nan" not in " ".join([page.text, *filter(None, numbers)]).lower()


def test_a_part_that_no_tool_reached_makes_a_page(tmp_path):
    case = points(50)
    column = Column("abbe", "a", np.full(50, np.nan), np.full(50, "uncut"))
    text = written(tmp_path / "r.html", replace(case, columns=(column,)), run())
    assert "no cut points" in text


def test_same_input_gives_the_same_page(tmp_path):
    pages = [written(tmp_path / f"{i}.html", points(), run()) for i in range(2)]
    assert pages[0] == pages[1]


def test_measured_minus_predicted_has_its_own_map_scale_and_table(tmp_path):
    case = points()
    left = 1e-3 * np.where(case["abbe"].is_cut, np.sin(np.arange(len(case))), np.nan)
    abbe = replace(case["abbe"], remainder_mm=left)
    case = replace(case, columns=(case["none"], abbe, case["measured"]))
    page = Page(written(tmp_path / "r.html", case, run()))
    header, columns = unpack(page.scripts[1])
    cut = case["abbe"].is_cut
    shown_um = signed(columns["point:abbe_remainder"])[cut] * header["value_step_um"]
    np.testing.assert_allclose(shown_um, 1e3 * left[cut], atol=1e-3)
    data = json.loads(page.scripts[0])["variants"]
    assert data["abbe_remainder"]["range_um"] == pytest.approx(1.0)
    assert data["abbe"]["range_um"] > 2
    rms_um = 1e3 * np.sqrt(np.mean(left[cut] ** 2))
    assert f"{rms_um:.2f}" in page.text.split("Measured minus predicted")[1].split("Each after")[0]
    assert "Measured − Abbe-consistent" in page.text
    assert "none_remainder" not in data
