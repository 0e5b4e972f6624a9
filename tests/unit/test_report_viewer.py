"""vmach view: what it loads, and what it says where it cannot."""

import numpy as np
import pytest
import trimesh

from tests.report_case import block, points
from vmach.errors import InputError
from vmach.report import open_viewer, write_deviations_csv
from vmach.report.pictures.viewer import _coloured_surface


def test_without_a_display_the_message_points_to_the_report(tmp_path, monkeypatch):
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    write_deviations_csv(tmp_path / "deviations.csv", points(20))
    with pytest.raises(InputError, match=r"no display .*report\.html"):
        open_viewer(tmp_path)


def test_a_folder_without_a_result_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"deviations\.csv: no such file"):
        open_viewer(tmp_path)
    with pytest.raises(InputError, match="no such folder"):
        open_viewer(tmp_path / "nowhere")


def test_the_part_is_coloured_in_um_and_uncut_faces_are_not(tmp_path):
    case = points(2000)
    trimesh.Trimesh(*block()).export(tmp_path / "part.stl")
    surface = _coloured_surface(tmp_path / "part.stl", case)
    assert surface.volume == pytest.approx(24_000, rel=1e-6)
    height = surface.points[:, 2]
    top = surface["measured"][np.isclose(height, 20) & np.isfinite(surface["measured"])]
    assert top.max() == pytest.approx(1e3 * case["measured"].deviation_mm.max(), rel=0.05)
    assert np.isnan(surface["abbe"]).mean() > 0.1


def test_points_alone_are_shown_where_there_is_no_part(tmp_path):
    case = points(50)
    surface = _coloured_surface(tmp_path / "part.stl", case)
    assert surface.n_points == 50
    np.testing.assert_allclose(surface["measured"], 1e3 * case["measured"].deviation_mm)
